"""Replies of the node, and the sentences about the end of a motion or a STOP."""

from __future__ import annotations

from enum import Enum

from beatrix_zenoh.board.board import Board
from beatrix_zenoh.contract._generated.messages import (
    CommandReply,
    Detail,
    MotionReply,
    Phase,
    Reason,
)
from beatrix_zenoh.contract._generated.serial import OUTCOME_REASON, OUTCOME_TEXT, BoardOutcome, BoardState
from beatrix_zenoh.contract.errors import BeatrixError, NoAnswer
from beatrix_zenoh.motion.gear import Arms
from beatrix_zenoh.node.planner import degrees, vector


class StopCause(Enum):
    """Causes for which a node stops a motion: the reason in the last reply, and the words after `Ended`."""

    STOP = Reason.STOPPED, OUTCOME_TEXT[BoardOutcome.STOPPED]
    TAKEN = Reason.STOPPED, "by the teacher, who has taken the robot"
    FROZEN = Reason.STOPPED, "by the teacher, who has frozen the robot"
    MUTED = Reason.STOPPED, "by the teacher, who has muted this seat"
    SKIPPED = Reason.STOPPED, "by the teacher, who has ended this turn"
    TOO_FAST = Reason.STOPPED, "by the teacher, whose new speed limit is lower"
    SHUTDOWN = Reason.SHUTDOWN, "by its node, which is closing"
    CLIENT_LOST = Reason.CLIENT_LOST, "by its node, because the client that requested it is gone"


POWERLESS = (BoardOutcome.DISABLED, BoardOutcome.EMERGENCY)
RESET = (
    "The board was reset: its motors are off, and home is not known. Set the head upright, enable, calibrate."
)
SILENT = (
    "The board does not answer any more. If it has power, it stops the arms by itself, half a second after the last "
    "frame of its node; if they still move, switch the motor power off."
)
SUPERSEDED = "The board carries out a newer motion, which it has not acknowledged."
NOT_CARRIED_OUT = "The board acknowledged the motion but does not carry it out."


def motion_reply(
    phase: Phase,
    reason: Reason,
    text: str,
    motion: int,
    duration_s: float,
    position: Arms,
    detail: Detail | None = None,
) -> MotionReply:
    """Return a reply to a motion; its result follows from the reason."""
    return MotionReply(
        result=reason is Reason.OK,
        phase=phase,
        reason=reason,
        message=text,
        motion=motion,
        duration=duration_s,
        position=vector(position),
        detail=detail,
    )


def motion_refusal(error: BeatrixError, position: Arms) -> MotionReply:
    """Return the reply to a refused motion; `position`: set points of the arms (rad)."""
    return motion_reply(Phase.ACCEPTED, error.reason, error.message, 0, 0.0, position, error.detail)


def command_reply(reason: Reason, text: str, position: Arms, detail: Detail | None = None) -> CommandReply:
    """Return a reply to a command; its result follows from the reason."""
    return CommandReply(
        result=reason is Reason.OK, reason=reason, message=text, position=vector(position), detail=detail
    )


def command_refusal(error: BeatrixError, position: Arms) -> CommandReply:
    """Return the reply to a refused command; `position`: set points of the arms (rad)."""
    return command_reply(error.reason, error.message, position, error.detail)


def motion_end(code: int, cause: StopCause, arms: Arms, presser: str = "") -> tuple[Reason, str]:
    """Return reason and sentence for an outcome other than NONE.

    `cause`: why the node sent STOP; arms in rad; `presser`: seat that pressed STOP, empty if unknown.
    """
    by_seat = f" of {presser}" if presser else ""
    where = degrees(arms)
    if code not in OUTCOME_TEXT:
        return Reason.CONTRACT_MISMATCH, f"Ended with an unknown outcome ({code}); the arms rest at {where}."
    outcome = BoardOutcome(code)
    if outcome is BoardOutcome.DONE:
        return Reason.OK, f"Arrived; the arms rest at {where}."
    if outcome in POWERLESS:
        first = "reset, enable" if outcome is BoardOutcome.EMERGENCY else "enable"
        return OUTCOME_REASON[outcome], (
            f"Ended {OUTCOME_TEXT[outcome]}{by_seat if outcome is BoardOutcome.EMERGENCY else ''}. The arms were at {where}; without power the head may have sunk: set it "
            f"upright, {first}, calibrate."
        )
    if outcome is BoardOutcome.STOPPED:
        reason, words = cause.value
        by_seat = by_seat if cause is StopCause.STOP else ""
        return reason, f"Ended {words}{by_seat}; the arms rest at {where}."
    return OUTCOME_REASON[outcome], f"Ended {OUTCOME_TEXT[outcome]}; the arms rest at {where}."


def board_lost(*, reset: bool) -> str:
    """Return the sentence about a motion that ended because the board was lost or reset."""
    return RESET if reset else SILENT


def not_stopped(error: BeatrixError) -> BeatrixError:
    """Return the error about a STOP that did not stop the arms, with advice."""
    return BeatrixError(
        error.reason,
        f"NOT stopped. {error.message} Without frames of its node a board stops the arms after half a second; if they "
        "still move, switch the motor power off.",
    )


def lost_while_stopping(*, reset: bool) -> BeatrixError:
    """Return the error about a STOP whose effect is unknown: the board was lost while the arms moved."""
    if reset:
        return NoAnswer(
            Reason.BOARD_LOST, "The board was reset meanwhile: its motors are off, and home is not known."
        )
    return not_stopped(NoAnswer(Reason.BOARD_LOST, "The board was lost while the arms moved."))


def at_rest(board: Board, how: str, arms: Arms) -> str:
    """Return the state after an acknowledged STOP as a sentence; `how`: its first words at rest; arms in rad."""
    link = board.link
    if not link.connected:
        return f"The board has acknowledged STOP, but its state is unknown. {link.trouble}"
    if board.state & BoardState.EMERGENCY:
        return "The motors are off, EMERGENCY_STOP is latched until reset, and home is no longer known."
    return f"{how}; the arms rest at {degrees(arms)}."
