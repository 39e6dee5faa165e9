"""Requests to shut down: by a signal at any time, by a thread, more than once."""

from __future__ import annotations

import gc
import signal
import subprocess
import sys
import threading
import weakref
from collections.abc import Iterator

import pytest
from shell import settings_of_this_process

from beatrix_zenoh.bus import at_exit
from beatrix_zenoh.processes import Supervisor, watch
from beatrix_zenoh.shutdown import Shutdown, signals_interrupt

EVERY_S = 20e-6


@pytest.fixture
def signals_as_before() -> Iterator[None]:
    with settings_of_this_process():
        yield
        signal.setitimer(signal.ITIMER_REAL, 0)
        # Keep a handler for SIGALRM: an alarm that is already pending would end Python without one.
        signal.signal(signal.SIGALRM, lambda _signal, _frame: None)


@pytest.mark.usefixtures("hangup")
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_a_signal_requests_a_shutdown(signals_as_before: None, number: signal.Signals) -> None:
    shutdown = Shutdown()
    shutdown.handle_signals()
    signal.raise_signal(number)
    assert shutdown.requested(0)


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_a_signal_while_python_exits_does_not_change_the_exit_code(number: signal.Signals) -> None:
    code = "import atexit, signal; from beatrix_zenoh.shutdown import process\n"
    code += f"atexit.register(signal.raise_signal, {number:d}); process(lambda: 7)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 7


@pytest.mark.timeout(30)  # if a request took a lock, this would block within milliseconds
def test_a_signal_may_arrive_at_any_point_of_the_program(signals_as_before: None) -> None:
    shutdown = Shutdown()
    received = 0

    def receive(_signal: int, _frame: object) -> None:
        nonlocal received
        received += 1
        shutdown.request()

    signal.signal(signal.SIGALRM, receive)
    signal.setitimer(signal.ITIMER_REAL, EVERY_S, EVERY_S)
    while received < 2000:
        shutdown.requested(EVERY_S)
    assert shutdown.requested(0)


class Interrupts:
    """An object of a library: a signal arrives while it is deleted."""

    def __del__(self) -> None:
        signal.raise_signal(signal.SIGTERM)


@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
def test_an_interrupt_that_python_ignores_still_ends_the_loop_of_up() -> None:
    with signals_interrupt() as shutdown, Supervisor() as supervisor:
        Interrupts()
        with pytest.raises(KeyboardInterrupt):
            watch(supervisor, shutdown)


# -- the sessions that a program leaves open: closed at its exit, or kept if there is no time to c--


class Native:
    """Stands for an object of Zenoh, whose deletion closes a session."""


class Session:
    """A session that is closed or not."""

    def __init__(self, native: Native) -> None:
        self._native = native
        self.closed = False

    def close(self) -> None:
        self.closed = True

    def objects(self) -> object:
        return (self._native,)


@pytest.mark.parametrize(("close_s", "closed"), [(2.0, True), (-1.0, False)])
def test_a_session_is_closed_or_its_native_objects_outlive_it(
    monkeypatch: pytest.MonkeyPatch, close_s: float, closed: bool
) -> None:
    monkeypatch.setattr(at_exit, "CLOSE_S", close_s)
    native = Native()
    remains, session, sessions = weakref.ref(native), Session(native), at_exit.OpenSessions()
    del native
    sessions.add(session)
    sessions.close()
    assert session.closed is closed
    del session
    gc.collect()
    assert (remains() is None) is closed


def test_the_exit_waits_for_threads_that_receive() -> None:
    closing, sessions = threading.Event(), at_exit.OpenSessions()
    ended: list[int] = []

    class Receiving(Session):
        def close(self) -> None:
            closing.set()

    def receive() -> None:
        with sessions.call():
            inside.set()
            closing.wait(5.0)
            for number in range(100_000):  # long enough that an exit which does not wait is earlier
                ended[:] = [number]

    inside, session = threading.Event(), Receiving(Native())
    sessions.add(session)
    thread = threading.Thread(target=receive)
    thread.start()
    assert inside.wait(5.0)
    sessions.close()
    assert ended == [99_999]
    thread.join(5.0)
