"""Fixtures and hooks of all tests: clean settings, loopback only, no remaining threads and processes, scheduling."""

from __future__ import annotations

import os
import re
import signal
import sys
import threading
import time
from collections.abc import Generator, Iterator
from pathlib import Path

import pytest
from file_locks import lock
from hypothesis import settings
from late_tests import Excuses
from robots import IDLE, IDLE_THREAD, Stage, children, end_idle_routers
from stall_monitor import Witness
from xdist.remote import Producer  # type: ignore[import-untyped]
from xdist.scheduler import LoadScopeScheduling  # type: ignore[import-untyped]
from xdist.workermanage import WorkerController  # type: ignore[import-untyped]

# Hypothesis has no deadline, because tests of correct code may be slow on a busy machine; pytest's timeout applies.
# Each run draws new examples.
settings.register_profile("beatrix", deadline=None, max_examples=25)
settings.load_profile("beatrix")

LOOPBACK = ("127.0.0.1", "127.0.0.2", "::1", "localhost")
SECONDS_TO_GO = 10.0
"""How long (s) threads and processes may take to end after their test."""
COMPUTING = ("tests/unit/", "tests/firmware/", "tests/avr/")
"""Folders whose tests keep a processor busy; the other tests often wait for robots."""
LESSONS = 4
"""Lessons in a row whose programs one process checks."""
RUNNING, BEGINS = Path(__file__), Path(__file__).with_name("README.md")
"""Files that the processes of `make test` lock, so that a test can have the computer for itself."""
LONG_LIVED = (
    "tests/support/stall_monitor.py",
    "multiprocessing.resource_tracker",
    "multiprocessing.forkserver",
)
"""Processes that outlive a test: the witness, and those of Python's multiprocessing."""
EXCUSES = pytest.StashKey[Excuses]()


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


class Scopes(LoadScopeScheduling):  # type: ignore[misc]
    """`--dist loadscope`, which keeps the tests of a file in one process, with two changes.

    A simulation, or a simulated Mega, is shared by the contract tests of all files; the checks of lessons, which mostly
    wait, are spread. (The mark `xdist_group` has no effect: pytest-xdist 3.8 writes its group where pytest 9.2 no longer
    reads it.) And the first process begins at the end, with tests that compute: they run while those of the other
    processes wait for robots.
    """

    def _split_scope(self, nodeid: str) -> str:
        if body := re.search(r"^tests/contract/.*[\[-](sim|mega|shared)[\]-]", nodeid):
            return body[1]
        file, _, test = nodeid.partition("::")
        if file.startswith("tests/lessons/") and (lesson := re.search(r"(\w+)\[(\d\d)-", test)):
            return f"{lesson[1]} {(int(lesson[2]) - 1) // LESSONS}"
        return file

    def _assign_work_unit(self, node: WorkerController) -> None:
        if node is self.nodes[0]:
            self.workqueue.move_to_end(next(reversed(self.workqueue)), last=False)
        super()._assign_work_unit(node)


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: Producer) -> Scopes:
    """Return the scheduler of all runs with several processes."""
    return Scopes(config, log)


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Begin with the files that wait for others, end with short ones: a long file, begun last, would run by itself."""
    first = {item.path for item in items if item.get_closest_marker("alone")}
    items.sort(key=lambda item: (item.path not in first, item.nodeid.startswith(COMPUTING)))


def pytest_configure(config: pytest.Config) -> None:
    """Register the rule for excuses."""
    config.stash[EXCUSES] = Excuses(counts=not hasattr(config, "workerinput"))
    config.pluginmanager.register(config.stash[EXCUSES])


def pytest_sessionstart(session: pytest.Session) -> None:
    """Start a witness in each process that runs tests."""
    if "PYTEST_XDIST_WORKER" in os.environ or session.config.getoption("numprocesses", None) is None:
        session.config.stash[EXCUSES].witness = Witness()


def pytest_sessionfinish() -> None:
    """End the routers that stages have left for the next one."""
    end_idle_routers()


@pytest.hookimpl(wrapper=True, tryfirst=True)
def pytest_runtest_protocol(item: pytest.Item) -> Generator[None, object, object]:
    """Let a test that is marked `alone` run while no test runs in another process; wait before its time limit begins."""
    alone = item.get_closest_marker("alone") is not None
    with RUNNING.open("rb") as running:
        with BEGINS.open("rb") as begins:
            lock(begins)  # without it, new tests could delay one that runs alone indefinitely
            lock(running, shared=not alone)
        return (yield)


def own_user_folder(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """Hide the folder of the developer: accounts are read there, and nodes keep the teacher's decisions there."""
    with pytest.MonkeyPatch.context() as patch:
        name = {"win32": "APPDATA", "darwin": "HOME"}.get(sys.platform, "XDG_CONFIG_HOME")
        patch.setenv(name, str(tmp_path_factory.mktemp("config")))
        yield


user_folder_of_run = pytest.fixture(scope="session", autouse=True)(own_user_folder)
user_folder_of_file = pytest.fixture(scope="module", autouse=True)(own_user_folder)
"""A robot that the tests of one file leave frozen is not frozen in another file."""


@pytest.fixture(scope="session")
def bea() -> Iterator[Stage]:
    """Simulation and virtual robot `bea` in processes of their own, for all tests that leave them running."""
    with Stage() as made:
        made.simulation("bea")
        made.hardware("bea")
        yield made


@pytest.fixture(autouse=True)
def no_settings_from_outside(monkeypatch: pytest.MonkeyPatch) -> None:
    """Hide the settings of the developer, so that no test reaches their robot or class."""
    for name in os.environ:
        if name.startswith(("BEATRIX_", "ZENOH_")):
            monkeypatch.delenv(name)


@pytest.fixture
def hangup() -> Iterator[None]:
    """Handle SIGHUP in this test and in its processes; under `nohup make test` all processes ignore it."""
    before = signal.signal(signal.SIGHUP, signal.SIG_DFL)
    yield
    signal.signal(signal.SIGHUP, before)


def running_threads() -> set[threading.Thread]:
    """Return Python's threads without the dummy objects of Zenoh threads that have called into Python."""
    return {
        thread
        for thread in threading.enumerate()
        if not isinstance(thread, threading._DummyThread) and thread.name != IDLE_THREAD
    }


def running_children() -> dict[int, str]:
    """Return the command lines of this process's children by process number, without those that outlive a test."""
    try:
        os.waitid(os.P_ALL, 0, os.WEXITED | os.WNOHANG | os.WNOWAIT)
    except ChildProcessError:
        return {}  # the usual case: `children` reads a file for each of a hundred threads
    kept = {router.pid for router in IDLE.values()}
    return {
        number: command
        for number, command in children(os.getpid()).items()
        if number not in kept and not any(name in command for name in LONG_LIVED)
    }


@pytest.fixture(autouse=True)
def nothing_left_behind() -> Iterator[None]:
    """Fail a test that leaves a thread, a child process, which is killed, or a handler of SIGINT."""
    threads_before, children_before = running_threads(), running_children()
    yield
    deadline = time.monotonic() + SECONDS_TO_GO
    pause = threading.Event()
    while left := [
        *(f"thread {thread.name}" for thread in running_threads() - threads_before),
        *(
            f"process {number}: {command}"
            for number, command in running_children().items()
            if number not in children_before
        ),
    ]:
        if time.monotonic() > deadline:
            break
        pause.wait(0.01)
    for number in running_children().keys() - children_before.keys():
        os.kill(number, signal.SIGKILL)  # it would take time from the tests that follow
    left += ["a handler of Ctrl-C"] * (signal.getsignal(signal.SIGINT) is not signal.default_int_handler)
    assert not left, f"left {SECONDS_TO_GO} s after the test: {left}"
