"""What to tell whose motion has ended, and what to do then."""

from __future__ import annotations

from beatrix_zenoh._generated.messages import Reason
from beatrix_zenoh._generated.serial import OUTCOME_REASON, OUTCOME_TEXT, Outcome
from beatrix_zenoh.drive import Arms
from beatrix_zenoh.node.course import degrees

STOPPED_BY = {
    Reason.STOPPED: OUTCOME_TEXT[Outcome.STOPPED],
    Reason.SHUTDOWN: "by its node, which is closing",
    Reason.CLIENT_LOST: "by its node: nobody who asked for it is heard any more",
}
"""Who sent the STOP that the board has obeyed."""
POWERLESS = (Outcome.DISABLED, Outcome.EMERGENCY)
RESET = (
    "The board was reset: its motors are off, and home is not known. Set the head upright, enable, calibrate."
)
SILENT = (
    "The board does not answer any more. If it has power, it stops the arms by itself, half a second after it last heard "
    "its node; if they still move, switch the motor power off."
)
UNTOLD = "The board took a newer motion without saying so."
NEVER_MADE = "The board took the motion and does not make it."


def ended(code: int, cause: Reason, arms: Arms) -> tuple[Reason, str]:
    """Reason and sentence for an outcome other than NONE; `cause` is that of a STOP, arms in rad."""
    where = degrees(arms)
    if code not in OUTCOME_TEXT:
        return Reason.CONTRACT_MISMATCH, f"Ended in a way unknown here ({code}); the arms rest at {where}."
    outcome = Outcome(code)
    if outcome is Outcome.DONE:
        return Reason.OK, f"There: arms at {where}."
    if outcome in POWERLESS:
        return OUTCOME_REASON[outcome], (
            f"Ended {OUTCOME_TEXT[outcome]}. The arms were at {where}; without power the head may have sunk: set it "
            "upright, enable, calibrate."
        )
    if outcome is Outcome.STOPPED:
        return cause, f"Ended {STOPPED_BY[cause]}; the arms rest at {where}."
    return OUTCOME_REASON[outcome], f"Ended {OUTCOME_TEXT[outcome]}; the arms rest at {where}."


def lost(*, reset: bool) -> str:
    """The board has gone in mid-move, or has come back from a reset."""
    return RESET if reset else SILENT
