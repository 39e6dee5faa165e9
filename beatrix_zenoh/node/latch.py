"""After EMERGENCY_STOP: a program that enables as a matter of course must not undo it before somebody has looked."""

from __future__ import annotations

import threading

from beatrix_zenoh._generated.messages import Reason
from beatrix_zenoh.errors import Refused
from beatrix_zenoh.node.halt import PAUSE_S

REMEMBERED = 256
"""Sessions that have asked for something and are remembered."""


class Latch:
    """Sessions that were at work when EMERGENCY_STOP was pressed; all times in seconds of one monotonic clock.

    Pressed on Zenoh's thread (`press`) and asked for on the driver's.
    """

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._pressed_s = float("-inf")
        self._at_work: dict[str, None] = {}
        self._told_s: dict[str, float | None] = {}
        """Sessions that must look first, and when they were told, if they were."""

    def works(self, session: str) -> None:
        """A session (empty: unknown) has asked for a motion or a command."""
        with self._lock:
            if session and session not in self._at_work:
                self._at_work[session] = None
                if len(self._at_work) > REMEMBERED:
                    del self._at_work[next(iter(self._at_work))]

    def gone(self, session: str) -> None:
        """A session has ended."""
        with self._lock:
            self._at_work.pop(session, None)
            self._told_s.pop(session, None)

    def press(self, presser: str, now_s: float) -> None:
        """EMERGENCY_STOP, by a session that knows of it (empty: none of ours)."""
        with self._lock:
            self._pressed_s = now_s
            self._told_s = dict.fromkeys(self._at_work)
            self._told_s.pop(presser, None)

    def check(self, session: str, asked_s: float, now_s: float) -> None:
        """Raise unless a session that asked at `asked_s` may switch the motors on.

        Raises:
            Refused: STOPPED, whoever asked before it was pressed; once for each session that was at work, and again if
                it does not pause.
        """
        with self._lock:
            if asked_s <= self._pressed_s:
                raise Refused(
                    Reason.STOPPED, "EMERGENCY_STOP was pressed after this was asked: look, then enable."
                )
            if session not in self._told_s:
                return
            told_s = self._told_s[session]
            if told_s is not None and now_s - told_s >= PAUSE_S:
                del self._told_s[session]
                return
            self._told_s[session] = now_s
        raise Refused(
            Reason.STOPPED,
            f"EMERGENCY_STOP was pressed while this program was at work: look at the robot, wait for {PAUSE_S:.0f} s, then "
            "enable again (each try before that begins the wait anew).",
        )
