"""After STOP: whoever was stopped must pause, or a stream of targets would undo it at once."""

from __future__ import annotations

from beatrix_zenoh._generated.messages import Reason
from beatrix_zenoh.errors import Refused

PAUSE_S = 1.0
"""How long the stopped seat must send no motion before it may move again."""


class Halt:
    """The latest STOP of one robot; the session that pressed it need not pause. All times in seconds of one monotonic clock.

    Set from the stop desk's thread, asked on the driver's: each call reads or writes one reference.
    """

    def __init__(self) -> None:
        self._stop: tuple[str, str] | None = None
        self._quiet_since_s = 0.0

    def begin(self, stopped_seat: str, by_session: str, now_s: float) -> None:
        """STOP was pressed: by a session, empty if unknown, while a seat was driving."""
        self._quiet_since_s = now_s
        self._stop = (stopped_seat, by_session)

    def check(self, who: str, session: str, now_s: float, *, resting: bool) -> None:
        """Raise unless a motion may begin.

        Raises:
            Refused: STOPPED, saying when it may.
        """
        stop = self._stop
        if stop is None:
            return
        if not resting:
            raise Refused(Reason.STOPPED, "STOP was pressed and the arms are coming to rest: ask again then.")
        knows = bool(session) and session == stop[1]
        if who == stop[0] and not knows and now_s - self._quiet_since_s < PAUSE_S:
            self._quiet_since_s = now_s
            raise Refused(
                Reason.STOPPED,
                f"STOP was pressed while {who} was driving: send no motion for {PAUSE_S:.0f} s, then ask again "
                "(each try before that begins the wait anew).",
            )
        self._stop = None
