"""The pauses of seats after STOP. No I/O; callers pass the time."""

from __future__ import annotations

import math
from dataclasses import dataclass

from beatrix_zenoh.contract import refusals
from beatrix_zenoh.contract.errors import Refused
from beatrix_zenoh.contract.names import OLD_PROGRAMS
from beatrix_zenoh.node.callers import Caller, is_same

QUIET_S = 3.0
"""Time without motion requests after which a stopped seat may move again. It is longer than a program usually pauses
between motions."""
QUIET_OLD_PROGRAM_S = 5.0
"""Used instead of QUIET_S for programs of 2023; longer, because they cannot read the reason of a refusal."""

LOOP_S = 10.0
"""If another seat stops a second program of a seat this soon (s) after the first, new programs must pause, too."""


@dataclass
class _Pause:
    """The pause of a stopped seat."""

    stopped_s: float
    """time of STOP"""

    requested_s: float
    """time of STOP, or of the last motion request of the seat since then"""
    stopped: Caller
    """caller whose motion was stopped"""
    presser: Caller
    """caller that need not pause: it sent STOP"""
    others_s: float = -math.inf
    """time of the last STOP by another seat"""
    again: bool = False
    """whether other seats have stopped two programs of this seat, one after the other: perhaps a loop of programs"""


class Pauses:
    """Pauses of stopped seats.

    A pause ends after QUIET_S without a motion request of the seat, for programs of 2023 after QUIET_OLD_PROGRAM_S. It
    is for streams of motions that go on: a session that has begun after STOP need not pause, because a person has
    started a program again. If another seat stops this program too, sessions that begin later must pause.
    """

    def __init__(self) -> None:
        self._pauses: dict[str, _Pause] = {}

    def begin(
        self, mover: Caller | None, presser: Caller, now_s: float, presser_began_s: float | None
    ) -> None:
        """Begin the pause of `mover` (None: no seat drove), whose motion `presser` has stopped.

        A second STOP never shortens a pause. A seat that was stopped by another seat frees itself with a STOP of its own
        only from a session that began after that (`presser_began_s`; None: unknown), because a program may have two.
        """
        if mover is not None:
            pause = self._pauses.get(mover.seat)
            if pause is None or now_s - pause.requested_s >= LOOP_S:
                pause = self._pauses[mover.seat] = _Pause(now_s, now_s, mover, presser)
            elif pause.stopped.session != mover.session and _is_other(presser, mover):
                pause.again = pause.others_s > -math.inf
            pause.stopped_s = pause.requested_s = now_s
            pause.stopped = mover
        for pause in self._pauses.values():
            if _is_other(presser, pause.stopped):
                pause.presser, pause.others_s = presser, now_s
            elif presser_began_s is not None and presser_began_s > pause.others_s:
                pause.presser = presser

    def restart(self, caller: Caller, now_s: float, began_s: float | None) -> Refused | None:
        """If this caller must pause, restart the pause of its seat and return the refusal; otherwise return None.

        The caller that sent STOP need not pause, nor a session that has begun after it (`began_s`; None: unknown).
        Their seat keeps the pause, because another session of the seat may still send the stream that was stopped.
        """
        pause = self._pauses.get(caller.seat)
        if pause is None or is_same(pause.presser, caller):
            return None
        if began_s is not None and began_s > pause.stopped_s and not pause.again:
            return None
        quiet_s = QUIET_OLD_PROGRAM_S if caller.seat == OLD_PROGRAMS else QUIET_S
        if now_s - pause.requested_s >= quiet_s:
            del self._pauses[caller.seat]
            return None
        pause.requested_s = now_s
        return refusals.stopped_pause(caller.seat, quiet_s, again=pause.again, presser=pause.presser.seat)

    def end(self, seat: str) -> None:
        """End the pause of a seat."""
        self._pauses.pop(seat, None)


def _is_other(presser: Caller, mover: Caller) -> bool:
    return presser.seat != mover.seat and not is_same(presser, mover)
