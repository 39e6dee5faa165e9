"""What every test gets: a clean environment, loopback only, and a look at what it left behind."""

from __future__ import annotations

import os
import re
import signal
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from hypothesis import settings
from xdist.remote import Producer  # type: ignore[import-untyped]
from xdist.scheduler import LoadScopeScheduling  # type: ignore[import-untyped]

# No deadline: a busy machine is no fault of the code, and pytest's timeout holds. Other examples are drawn in each run.
settings.register_profile("house", deadline=None, max_examples=50)
settings.load_profile("house")

LOOPBACK = ("127.0.0.1", "127.0.0.2", "::1", "localhost")
SECONDS_TO_GO = 3.0
"""How long threads and processes may take to end after their test."""
LONG_LIVED = ("multiprocessing.resource_tracker", "multiprocessing.forkserver")
"""Processes that Python keeps for itself."""


def refuse_other_networks(event: str, args: tuple[object, ...]) -> None:
    """Audit hook: Python's sockets stay on this machine."""
    if event in {"socket.bind", "socket.connect", "socket.sendto"}:
        address = args[1]
        if isinstance(address, tuple) and address[0] not in LOOPBACK:
            raise PermissionError(f"{event} {address}: tests stay on loopback ({', '.join(LOOPBACK)})")


sys.addaudithook(refuse_other_networks)
if (
    signal.getsignal(signal.SIGINT) is signal.SIG_IGN
):  # begun with `&` in a script: our programs would be deaf too
    signal.signal(signal.SIGINT, signal.default_int_handler)


class Sharing(LoadScopeScheduling):  # type: ignore[misc]
    """Keeps tests that share robots, or a build, in one process; else each process would start its own.

    Marks do not do it: pytest-xdist 3.8 writes the group of `xdist_group` where pytest 9.2 no longer reads it.
    """

    def _split_scope(self, nodeid: str) -> str:
        file = nodeid.partition("::")[0]
        if body := re.search(r"^tests/contract/.*[\[-](sim|mega)[\]-]", nodeid):
            return body[1]
        return nodeid if file.startswith("tests/unit/") else file


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: Producer) -> Sharing | None:
    """Return the order of `make test`."""
    return Sharing(config, log) if config.getoption("dist") == "loadgroup" else None


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Let tools/mutate.py, which asks for contexts, see what all tests execute."""
    if config.getoption("cov_context", None):
        for node in {node for item in items for node in item.listchain()}:
            node.own_markers[:] = [mark for mark in node.own_markers if mark.name != "no_cover"]


@pytest.fixture(autouse=True)
def no_settings_from_outside(
    monkeypatch: pytest.MonkeyPatch, tmp_path_factory: pytest.TempPathFactory
) -> None:
    """No test reaches the developer's own robot, or class."""
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path_factory.getbasetemp() / "config"))
    for name in os.environ:
        if name.startswith(("BEATRIX_", "ZENOH_")):
            monkeypatch.delenv(name)


def running_threads() -> set[threading.Thread]:
    """Python's threads, without the stand-ins for Zenoh's own that once called into Python."""
    return {thread for thread in threading.enumerate() if not isinstance(thread, threading._DummyThread)}


def running_children() -> dict[int, str]:
    """Command lines of this process's living children by process number; empty where /proc is missing."""
    found = {}
    for listing in Path(f"/proc/{os.getpid()}/task").glob("*/children"):
        try:
            numbers = listing.read_text().split()
        except OSError:
            continue  # that thread has just ended
        for number in numbers:
            try:
                state = Path(f"/proc/{number}/stat").read_text().rpartition(")")[2].split()[0]
                words = Path(f"/proc/{number}/cmdline").read_bytes().split(b"\0")
            except OSError:
                continue  # it has just ended
            command = b" ".join(words).decode(errors="replace").strip()
            if state != "Z" and not any(name in command for name in LONG_LIVED):
                found[int(number)] = command
    return found


@pytest.fixture(autouse=True)
def nothing_left_behind() -> Iterator[None]:
    """Fail a test that leaves a thread or a process running."""
    threads_before, children_before = running_threads(), running_children()
    yield
    deadline = time.monotonic() + SECONDS_TO_GO
    for thread in running_threads() - threads_before:
        thread.join(max(0.0, deadline - time.monotonic()))
    pause = threading.Event()
    while (running_children().keys() - children_before) and time.monotonic() < deadline:
        pause.wait(0.02)
    left = [f"thread {thread.name}" for thread in running_threads() - threads_before]
    left += [
        f"process {number}: {command}"
        for number, command in running_children().items()
        if number not in children_before
    ]
    assert not left, f"left running {SECONDS_TO_GO} s after the test: {left}"
