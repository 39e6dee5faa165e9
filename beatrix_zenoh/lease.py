"""Who drives: the first who moves a free robot, until a while after it rests. No I/O, no clock."""

from __future__ import annotations

from beatrix_zenoh._generated.messages import Reason
from beatrix_zenoh.errors import Refused

LINGER_S = 2.0
"""How long the driver keeps a robot that rests."""
TEACHER = "teacher"
"""The seat that outranks all others."""


def driven(holder: str, when: str) -> Refused:
    """What to tell who may not move a robot because a seat drives it until `when`."""
    return Refused(
        Reason.NOT_HOLDER,
        f"{holder} drives this robot, {when}. Ask again then; STOP is always open to everybody.",
    )


class Lease:
    """The implicit lease of one robot; all times in seconds of one monotonic clock."""

    def __init__(self) -> None:
        self._holder = ""
        self._rests_since_s: float | None = None
        self._before: tuple[str, float | None] = "", None

    def holder(self, now_s: float) -> str:
        """Seat that drives, empty if the robot is free."""
        if self._rests_since_s is not None and now_s - self._rests_since_s >= LINGER_S:
            return ""
        return self._holder

    def check(self, who: str, now_s: float) -> None:
        """Raise unless `who` may act on the robot.

        Raises:
            Refused: NOT_HOLDER, naming the driver and when the robot will be free.
        """
        holder = self.holder(now_s)
        if holder in ("", who) or who == TEACHER:
            return
        if self._rests_since_s is None:
            when = f"until {LINGER_S:.0f} s after the running motion has ended"
        else:
            when = f"for {LINGER_S - (now_s - self._rests_since_s):.1f} s more unless it moves again"
        raise driven(holder, when)

    def take(self, who: str, now_s: float) -> None:
        """`who` moves the robot: it drives from now on; raises as `check`."""
        self.check(who, now_s)
        self._before = self._holder, self._rests_since_s
        self._holder, self._rests_since_s = who, None

    def give_back(self, now_s: float) -> None:
        """What the robot was taken for came to nothing: it is whose it was, and if that is somebody, it rests."""
        self._holder, self._rests_since_s = self._before
        if self._rests_since_s is None:
            self.rest(now_s)

    def rest(self, now_s: float) -> None:
        """The robot has come to rest: the lease runs out from here."""
        if self._holder:
            self._rests_since_s = now_s

    def free(self) -> None:
        """The driver has gone."""
        self._holder, self._rests_since_s = "", None
