"""Callers and their requests for tests of the access rules, and a function that returns the reason of a refusal."""

from __future__ import annotations

from typing import Final

from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.errors import Refused
from beatrix_zenoh.contract.names import OLD_PROGRAMS, TEACHER
from beatrix_zenoh.node.access import TEXT_SESSION, Access, Operation
from beatrix_zenoh.node.callers import Caller

ANA: Final = Caller("ana", "a1")
ANA_AGAIN: Final = Caller("ana", "a2")
BEN: Final = Caller("ben", "b1")
BEN_AGAIN: Final = Caller("ben", "b2")
CLEO: Final = Caller("cleo", "c1")
BOSS: Final = Caller(TEACHER, "t1")
OLD: Final = Caller(OLD_PROGRAMS, TEXT_SESSION)
NO_SESSION: Final = Caller("me", "")


def refusal(
    access: Access,
    caller: Caller,
    now_s: float,
    action: Operation = Operation.MOVE,
    *,
    resting: bool = True,
    lease: int = 0,
) -> Reason:
    """Return the reason of a refused action; OK if it is allowed."""
    try:
        access.authorize(action, caller, now_s, resting=resting, lease=lease)
    except Refused as refused:
        return refused.reason
    return Reason.OK


def begin_motion(access: Access, caller: Caller, now_s: float) -> Access:
    """Begin a motion of the caller."""
    access.authorize(Operation.MOVE, caller, now_s)
    access.take(caller)
    return access


def stop(access: Access, presser: Caller, now_s: float) -> Access:
    """Press STOP, let the board acknowledge it, and end the motion."""
    access.stop_pressed(presser, now_s)
    access.stop_sent(now_s)
    access.rested(now_s)
    return access
