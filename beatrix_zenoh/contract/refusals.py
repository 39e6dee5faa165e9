"""Refusals, built from their data; `sentences` renders their sentences."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from beatrix_zenoh.contract._generated.messages import Command, Detail, Limit, Reason
from beatrix_zenoh.contract.errors import Refused
from beatrix_zenoh.contract.names import ARMS, TEACHER

LINGER_S = 2.0
"""Time (s) for which the seat of a motion keeps the robot after the motion."""
COMMANDS = [f"{command.value} {command.name}" for command in Command]
"""Number and name of every command."""


def not_enabled() -> Refused:
    """Return a NOT_ENABLED refusal: the motors are off."""
    return Refused(Reason.NOT_ENABLED, detail=Detail(needs=["ENABLE", "CALIBRATE"]))


def not_calibrated() -> Refused:
    """Return a NOT_CALIBRATED refusal: home is not known."""
    return Refused(Reason.NOT_CALIBRATED, detail=Detail(needs=["CALIBRATE"]))


def emergency_latched(teacher: str = "") -> Refused:
    """Return an EMERGENCY refusal: EMERGENCY_STOP is latched until RESET, which only the seat `teacher` (if any) sends."""
    return Refused(Reason.EMERGENCY, detail=Detail(holder=teacher, needs=["RESET", "ENABLE", "CALIBRATE"]))


def driven_by(holder: str, wait_s: float | None = None) -> Refused:
    """Return a NOT_HOLDER refusal: another seat holds the robot for `wait_s` (s) more; None: while its motion runs."""
    return Refused(Reason.NOT_HOLDER, detail=Detail(holder=holder, wait_s=wait_s))


def taken_by(holder: str) -> Refused:
    """Return a NOT_HOLDER refusal: another seat has taken the robot."""
    return Refused(Reason.NOT_HOLDER, detail=Detail(holder=holder, field="lease"))


def lease_ended(number: int, holder: str, *, by_teacher: bool) -> Refused:
    """Return a NOT_HOLDER refusal: the lease of the request has ended; `holder`: seat that holds the robot now."""
    presser = TEACHER if by_teacher else ""
    return Refused(
        Reason.NOT_HOLDER, detail=Detail(holder=holder, field="lease", value=float(number), presser=presser)
    )


def muted(seat: str, *, stop: bool = False) -> Refused:
    """Return a MUTED refusal: the teacher has muted the seat; `stop`: of a STOP while no motion of the seat runs."""
    return Refused(Reason.MUTED, detail=Detail(holder=seat, field="stop" if stop else ""))


def stopped_pause(seat: str, wait_s: float, *, again: bool = False, presser: str = "") -> Refused:
    """Return a STOPPED refusal: the seat was stopped and must not send a motion for `wait_s` (s).

    `again`: this also holds for programs that start now; `presser`: seat that pressed STOP, empty if unknown.
    """
    field = "again" if again else ""
    return Refused(Reason.STOPPED, detail=Detail(holder=seat, wait_s=wait_s, field=field, presser=presser))


def coming_to_rest(presser: str = "") -> Refused:
    """Return a STOPPED refusal: the arms are still decelerating after STOP of the seat `presser` (empty: unknown)."""
    return Refused(Reason.STOPPED, detail=Detail(presser=presser))


def queue_full(limit: int) -> Refused:
    """Return a BUSY refusal: `limit` requests are waiting."""
    return Refused(Reason.BUSY, detail=Detail(limit=Limit.QUEUE, high=float(limit)))


def home_known(arms: Iterable[float], limit: float) -> Refused:
    """Return a HOME_KNOWN refusal: home is known, and an arm (rad from home) is more than `limit` (rad) away."""
    name, angle = _furthest(arms)
    detail = Detail(limit=Limit.HOME, value=abs(angle), high=limit, unit="rad", arms=[name])
    return Refused(Reason.HOME_KNOWN, detail=detail)


def bad_field(field: str, what: str = "", known: Sequence[str] = ()) -> Refused:
    """Return a BAD_VALUE refusal: a field, or a word of the request, is wrong.

    `field`: its name or the word; `what`: a sentence with the cause, if field and known values do not show it;
    `known`: values or fields that are allowed instead.
    """
    return Refused(Reason.BAD_VALUE, what, Detail(field=field, known=list(known)))


def too_far(arms: Iterable[float], high: float) -> Refused:
    """Return a BAD_VALUE refusal: the goal of an arm (rad from home) exceeds `high` (rad), the largest in a frame."""
    name, angle = _furthest(arms)
    detail = Detail(limit=Limit.TRAVEL, value=abs(angle), high=high, unit="rad", arms=[name], at_goal=True)
    return Refused(Reason.BAD_VALUE, detail=detail)


def too_far_for_any_pose(arms: Iterable[float], high: float) -> Refused:
    """Return a YAW_LIMIT refusal: the goal of an arm (rad) exceeds `high` (rad), the largest within the yaw limit."""
    name, angle = _furthest(arms)
    return Refused(
        Reason.YAW_LIMIT,
        detail=Detail(
            limit=Limit.TRAVEL, value=angle, low=-high, high=high, unit="rad", arms=[name], at_goal=True
        ),
    )


def _furthest(arms: Iterable[float]) -> tuple[str, float]:
    """Return name and value of the arm with the largest absolute value."""
    return max(zip(ARMS, arms, strict=True), key=lambda pair: abs(pair[1]))


def check_ready(*, emergency: bool, enabled: bool, calibrated: bool) -> None:
    """Check that a robot is ready to move; nodes, and clients that check before sending, use this function.

    Raises:
        Refused: EMERGENCY, NOT_ENABLED or NOT_CALIBRATED, in this order.
    """
    if emergency:
        raise emergency_latched()
    if not enabled:
        raise not_enabled()
    if not calibrated:
        raise not_calibrated()
