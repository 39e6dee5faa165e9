"""Requests to shut down: by a signal at any time, by a thread, more than once."""

from __future__ import annotations

import signal
import subprocess
import sys
from collections.abc import Iterator

import pytest
from shell import settings_of_this_process

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
