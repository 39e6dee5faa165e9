"""What every test gets: a clean environment, loopback only, and a look at what it left behind."""

from __future__ import annotations

import os
import signal
import socket
import sys
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from hypothesis import settings

settings.register_profile(
    "house", deadline=None
)  # a busy machine is no fault of the code: pytest's timeout holds
settings.load_profile("house")

LOOPBACK = ("127.0.0.1", "::1", "localhost")
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


@pytest.fixture(autouse=True)
def no_settings_from_outside(monkeypatch: pytest.MonkeyPatch) -> None:
    """No test reaches the developer's own robot."""
    for name in os.environ:
        if name.startswith(("BEATRIX_", "ZENOH_")):
            monkeypatch.delenv(name)


@pytest.fixture
def free_port() -> Callable[[], int]:
    """Make TCP port numbers on 127.0.0.1 that nobody listens on."""

    def make() -> int:
        with socket.socket() as probe:
            probe.bind(("127.0.0.1", 0))
            port: int = probe.getsockname()[1]
            return port

    return make


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
