"""After STOP: whoever was stopped must pause, or a stream of targets would undo it at once."""

from __future__ import annotations

import threading
from dataclasses import dataclass

from beatrix_zenoh._generated.messages import Reason
from beatrix_zenoh.errors import Refused

PAUSE_S = 1.0
"""How long the stopped seat must send no motion before it may move again."""


@dataclass
class Pause:
    """A stopped seat: since when it has been quiet, its session, and the session that pressed STOP."""

    since_s: float
    session: str
    presser: str


class Halt:
    """Who was stopped and must pause. All times in seconds of one monotonic clock.

    STOP is pressed on Zenoh's thread (`press`) and asked for on the driver's (`check`, `sent`).
    """

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._pauses: dict[str, Pause] = {}
        self._coming_to_rest = False
        self._under_way = False

    def press(self, driving: str, session: str, presser: str, now_s: float) -> None:
        """STOP: by a session (empty if unknown), while a seat was driving from a session (empty if nobody).

        Seats that pause already go on pausing: to press STOP twice must not set them free, nor must a program that
        presses it itself before every motion undo that of somebody else.
        """
        with self._lock:
            self._coming_to_rest = self._under_way = True
            if driving:
                pause = self._pauses.setdefault(driving, Pause(now_s, session, presser))
                pause.since_s, pause.session = now_s, session
            for pause in self._pauses.values():
                if presser != pause.session:
                    pause.presser = presser

    def sent(self) -> None:
        """The board has been told."""
        with self._lock:
            self._under_way = False

    def tried(self, who: str, now_s: float) -> None:
        """A seat has asked for a motion that is refused anyway: if it pauses, it has not paused yet."""
        with self._lock:
            if (pause := self._pauses.get(who)) is None:
                return
            if now_s - pause.since_s < PAUSE_S:
                pause.since_s = now_s
            else:
                del self._pauses[who]

    def check(self, who: str, session: str, now_s: float, *, resting: bool) -> None:
        """Raise unless a motion may begin.

        Raises:
            Refused: STOPPED, saying when it may.
        """
        with self._lock:
            if self._coming_to_rest and (self._under_way or not resting):
                raise Refused(
                    Reason.STOPPED, "STOP was pressed and the arms are coming to rest: ask again then."
                )
            self._coming_to_rest = False
            pause = self._pauses.get(who)
            if pause is None:
                return
            knows = bool(session) and session == pause.presser
            if not knows and now_s - pause.since_s < PAUSE_S:
                pause.since_s = now_s
                raise Refused(
                    Reason.STOPPED,
                    f"STOP was pressed while {who} was driving: send no motion for {PAUSE_S:.0f} s, then ask again "
                    "(each try before that begins the wait anew).",
                )
            del self._pauses[who]
