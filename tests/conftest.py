"""Fixtures and hooks of all tests: clean settings, loopback only, no remaining threads and processes, scheduling."""

from __future__ import annotations

import contextlib
import os
import re
import signal
import sys
import threading
import time
from collections.abc import Generator, Iterator
from pathlib import Path

import pytest
from file_locks import Turns
from hypothesis import settings
from late_tests import Excuses
from stall_monitor import Witness
from xdist.remote import Producer  # type: ignore[import-untyped]
from xdist.scheduler import LoadScopeScheduling  # type: ignore[import-untyped]
from xdist.workermanage import WorkerController  # type: ignore[import-untyped]

# Hypothesis has no deadline, because tests of correct code may be slow on a busy machine; pytest's timeout applies.
# Each run draws new examples.
settings.register_profile("beatrix", deadline=None, max_examples=50)
settings.load_profile("beatrix")

LOOPBACK = ("127.0.0.1", "127.0.0.2", "::1", "localhost")
SECONDS_TO_GO = 10.0
"""How long (s) threads and processes may take to end after their test."""
COMPUTING_WORKER = "gw0"
"""Process of `make test` that executes the tests that keep a processor busy; see `computes`."""
FEWEST_WORKERS = 3
"""With fewer processes, each executes tests that keep a processor busy, and others."""
NICE = 5
"""Added to the niceness of COMPUTING_WORKER. With 19 its tests would get so little time that they exceed `timeout`."""
LONGEST = (
    "sim",
    "mega",
    "tests/nodes/test_demo.py",
    "tests/nodes/test_legacy.py",
    "tests/nodes/test_cli_verbs.py",
    "tests/docs/test_code_in_docs.py",
)
"""The scopes that take longest, 45 to 105 s on two cores."""
LONG_LIVED = (
    "tests/support/stall_monitor.py",
    "multiprocessing.resource_tracker",
    "multiprocessing.forkserver",
)
"""Processes that outlive a test: the witness, and those of Python's multiprocessing."""
EXCUSES = pytest.StashKey[Excuses]()
TURNS = pytest.StashKey[Turns]()


def refuse_other_networks(event: str, args: tuple[object, ...]) -> None:
    """Audit hook that raises PermissionError if a Python socket would reach another machine."""
    if event in {"socket.bind", "socket.connect", "socket.sendto"}:
        address = args[1]
        if isinstance(address, tuple) and address[0] not in LOOPBACK:
            raise PermissionError(f"{event} {address}: tests stay on loopback ({', '.join(LOOPBACK)})")


sys.addaudithook(refuse_other_networks)
# A script that starts pytest with `&` makes it ignore SIGINT. Handle it again, because child processes inherit that.
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)


def computes(nodeid: str) -> bool:
    """Return whether a test keeps a processor busy all the time; the other tests have robots that move in real time."""
    return nodeid.startswith(("tests/unit/", "tests/firmware/", "tests/avr/"))


class Sharing(LoadScopeScheduling):  # type: ignore[misc]
    """Keeps tests that share robots, or a build, in one process; else each process would start its own.

    The mark `xdist_group` has no effect: pytest-xdist 3.8 writes its group where pytest 9.2 no longer reads it.

    The first process executes the tests that compute, at low priority, so that they do not delay robots in the other
    processes.
    """

    def _split_scope(self, nodeid: str) -> str:
        file = nodeid.partition("::")[0]
        if body := re.search(r"^tests/contract/.*[\[-](sim|mega)[\]-]", nodeid):
            return body[1]
        return nodeid if file.startswith("tests/unit/") else file

    def _assign_work_unit(self, node: WorkerController) -> None:
        """Assign the next scope of the process's kind; at the end, the others also get scopes of the first process.

        LONGEST go first: begun last, they would leave the other processes idle at the end.
        """
        first = node.gateway.id == COMPUTING_WORKER and self.numnodes >= FEWEST_WORKERS
        own = [scope for scope, tests in self.workqueue.items() if computes(next(iter(tests))) == first]
        scope = min(own, key=lambda scope: scope not in LONGEST, default=None)
        if scope is not None:
            self.workqueue.move_to_end(scope, last=False)
        elif first:
            node.shutdown()
            return
        super()._assign_work_unit(node)


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: Producer) -> Sharing | None:
    """Return the scheduler of `make test`."""
    return Sharing(config, log) if config.getoption("dist") == "loadgroup" else None


def pytest_sessionstart(session: pytest.Session) -> None:
    """Lower the priority of the process whose tests compute; start a witness in the others."""
    worker = os.environ.get("PYTEST_XDIST_WORKER")
    workers = int(os.environ.get("PYTEST_XDIST_WORKER_COUNT", "1"))
    if worker == COMPUTING_WORKER and workers >= FEWEST_WORKERS:
        os.nice(NICE)
    elif worker or session.config.getoption("numprocesses", None) is None:
        session.config.stash[EXCUSES].witness = Witness()


def pytest_configure(config: pytest.Config) -> None:
    """Let tests that are marked `alone` run while no test runs in another process; register the rule for excuses."""
    config.stash[EXCUSES] = Excuses(counts=not hasattr(config, "workerinput"))
    config.pluginmanager.register(config.stash[EXCUSES])
    if cache := getattr(config, "cache", None):  # missing with `-p no:cacheprovider`
        config.stash[TURNS] = Turns(cache.mkdir("turns"))


@pytest.hookimpl(wrapper=True, tryfirst=True)
def pytest_runtest_protocol(item: pytest.Item) -> Generator[None, object, object]:
    """Wait for the turn of the test, before its time limit begins."""
    turns = item.config.stash.get(TURNS, None)
    alone = item.get_closest_marker("alone") is not None
    with contextlib.nullcontext() if turns is None else turns.turn(alone=alone):
        return (yield)


def own_user_folder(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """Hide the folder of the developer: accounts are read there, and nodes keep the teacher's decisions there."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_CONFIG_HOME", str(tmp_path_factory.mktemp("config")))
        yield


user_folder_of_run = pytest.fixture(scope="session", autouse=True)(own_user_folder)
user_folder_of_file = pytest.fixture(scope="module", autouse=True)(own_user_folder)
"""A robot that the tests of one file leave frozen is not frozen in another file."""


@pytest.fixture(autouse=True)
def no_settings_from_outside(monkeypatch: pytest.MonkeyPatch) -> None:
    """Hide the settings of the developer, so that no test reaches their robot or class."""
    for name in os.environ:
        if name.startswith(("BEATRIX_", "ZENOH_")):
            monkeypatch.delenv(name)


def running_threads() -> set[threading.Thread]:
    """Return Python's threads without the dummy objects of Zenoh threads that have called into Python."""
    return {thread for thread in threading.enumerate() if not isinstance(thread, threading._DummyThread)}


def running_children() -> dict[int, str]:
    """Return the command lines of this process's living children by process number; none if /proc is missing."""
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
    """Fail a test that leaves a thread, a child process or a handler of SIGINT."""
    threads_before, children_before = running_threads(), running_children()
    yield
    deadline = time.monotonic() + SECONDS_TO_GO
    pause = threading.Event()
    while time.monotonic() < deadline and (
        running_threads() - threads_before or running_children().keys() - children_before
    ):
        pause.wait(0.01)
    left = [f"thread {thread.name}" for thread in running_threads() - threads_before]
    left += [
        f"process {number}: {command}"
        for number, command in running_children().items()
        if number not in children_before
    ]
    left += ["a handler of Ctrl-C"] * (signal.getsignal(signal.SIGINT) is not signal.default_int_handler)
    assert not left, f"left {SECONDS_TO_GO} s after the test: {left}"
