"""Why a robot may not move, in the same words for who asks it and who looks before."""

from __future__ import annotations

from beatrix_zenoh._generated.messages import Reason
from beatrix_zenoh.errors import Refused


def check(*, emergency: bool, enabled: bool, calibrated: bool) -> None:
    """Raise unless a robot may move.

    Raises:
        Refused: NOT_ENABLED or NOT_CALIBRATED, and what to do.
    """
    if emergency:
        raise Refused(
            Reason.NOT_ENABLED, "The emergency stop is latched: set the head upright, enable, calibrate."
        )
    if not enabled:
        raise Refused(Reason.NOT_ENABLED, "The motors are off: set the head upright, enable, calibrate.")
    if not calibrated:
        raise Refused(
            Reason.NOT_CALIBRATED,
            "Home is not known: if the head is upright, calibrate; else disable, set it upright, enable, calibrate.",
        )
