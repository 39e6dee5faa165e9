"""Told to end: by a signal that strikes anywhere, by a thread, more than once."""

from __future__ import annotations

import signal
import subprocess
import sys
import threading
from collections.abc import Iterator

import pytest

from beatrix_zenoh.ending import SIGNALS, Ending

EVERY_S = 20e-6


@pytest.fixture
def signals_as_before() -> Iterator[None]:
    before = [(number, signal.getsignal(number)) for number in SIGNALS]
    yield
    signal.setitimer(signal.ITIMER_REAL, 0)
    # Not as before: an alarm that has struck already and finds no handler is an error wherever Python is by then.
    signal.signal(signal.SIGALRM, lambda _signal, _frame: None)
    for number, handler in before:
        signal.signal(number, handler)


def test_it_stays_asked() -> None:
    ending = Ending()
    assert not ending.asked(0)
    ending.ask()
    ending.ask()
    assert ending.asked(0)
    assert ending.asked(0)
    ending.wait()


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_a_signal_asks(signals_as_before: None, number: signal.Signals) -> None:
    ending = Ending()
    ending.heed_signals()
    signal.raise_signal(number)
    assert ending.asked(0)


def test_a_closed_window_does_not_end_what_was_started_with_nohup(signals_as_before: None) -> None:
    signal.signal(signal.SIGHUP, signal.SIG_IGN)
    ending = Ending()
    ending.heed_signals()
    signal.raise_signal(signal.SIGHUP)
    assert not ending.asked(0)


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_a_signal_while_python_leaves_changes_nothing(number: signal.Signals) -> None:
    code = "import atexit, signal; from beatrix_zenoh.cli.app import process\n"
    code += f"atexit.register(signal.raise_signal, {number:d}); process(lambda: 7)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 7


def test_another_thread_asks() -> None:
    ending = Ending()
    threading.Timer(0.01, ending.ask).start()
    ending.wait()


@pytest.mark.timeout(30)  # with a lock inside, this stands still within milliseconds
def test_a_signal_may_strike_anywhere(signals_as_before: None) -> None:
    ending = Ending()
    struck = 0

    def strike(_signal: int, _frame: object) -> None:
        nonlocal struck
        struck += 1
        ending.ask()

    signal.signal(signal.SIGALRM, strike)
    signal.setitimer(signal.ITIMER_REAL, EVERY_S, EVERY_S)
    while struck < 2000:
        ending.asked(EVERY_S)
    assert ending.asked(0)
