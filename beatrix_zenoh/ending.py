"""How a process that serves is told to end."""

from __future__ import annotations

import queue
import signal
from collections.abc import Callable
from types import FrameType

SIGNALS = [
    getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP", "SIGBREAK") if hasattr(signal, name)
]
"""Ask to end: Ctrl-C, kill, a terminal's window that is closed, Windows's Ctrl-Break."""
TURN_S = 0.5
"""Windows delivers Ctrl-C only between waits, Linux a signal that another thread received, as after SIGCONT."""


class Ending:
    """Asked for by a signal, or by a thread that cannot go on.

    Not a threading.Event: setting one takes a lock, which the thread a signal interrupts may hold already.
    """

    def __init__(self) -> None:
        self._asked: queue.SimpleQueue[None] = queue.SimpleQueue()

    def heed_signals(self) -> None:
        """From now on signals ask for it; of a window that is closed only if nobody (nohup) wants it to go on."""
        for number in SIGNALS:
            if number in (signal.SIGINT, signal.SIGTERM) or signal.getsignal(number) is not signal.SIG_IGN:
                signal.signal(number, self._on_signal)

    def _on_signal(self, _signal: int, _frame: FrameType | None) -> None:
        self.ask()

    def ask(self) -> None:
        """End, please; from any thread or signal handler."""
        self._asked.put(None)

    def asked(self, within_s: float) -> bool:
        """Somebody has asked, or does within this time."""
        try:
            self._asked.get(timeout=within_s)
        except queue.Empty:
            return False
        self._asked.put(None)  # for whoever looks next
        return True

    def wait(self, meanwhile: Callable[[], None] = lambda: None) -> None:
        """Return when somebody has asked; `meanwhile` is called twice a second."""
        while not self.asked(TURN_S):
            meanwhile()


def over() -> None:
    """All is done and said: while Python leaves, signals have nothing to add."""
    for number in SIGNALS:
        signal.signal(number, signal.SIG_IGN)
