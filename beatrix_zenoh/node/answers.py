"""Replies of a robot, and the way back to who asked."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import msgspec

from beatrix_zenoh._generated.messages import Command, CommandReply, MotionReply, Phase, PreviewReply, Reason
from beatrix_zenoh._generated.serial import State
from beatrix_zenoh.board.board import Board
from beatrix_zenoh.drive import Arms
from beatrix_zenoh.errors import BeatrixError, NoAnswer, Refused
from beatrix_zenoh.node.course import degrees, vector


@dataclass(frozen=True)
class Asker:
    """Who asked, and the way back; `answer` may be called several times, `finish` ends it."""

    who: str
    session: str
    answer: Callable[[msgspec.Struct], None]
    finish: Callable[[], None]


def motion_reply(
    phase: Phase, reason: Reason, text: str, motion: int, duration_s: float, position: Arms
) -> MotionReply:
    """A reply to a motion; its result follows from the reason."""
    return MotionReply(
        result=reason is Reason.OK,
        phase=phase,
        reason=reason,
        message=text,
        motion=motion,
        duration=duration_s,
        position=vector(position),
    )


def command_reply(reason: Reason, text: str, position: Arms) -> CommandReply:
    """A reply to a command; its result follows from the reason."""
    return CommandReply(result=reason is Reason.OK, reason=reason, message=text, position=vector(position))


def not_stopped(error: BeatrixError) -> BeatrixError:
    """Why STOP had no effect, and what is left to do."""
    return BeatrixError(
        error.reason,
        f"NOT stopped. {error.message} A board that misses its node stops the arms after half a second; if they still "
        "move, switch the motor power off.",
    )


def lost_while_stopping(*, reset: bool) -> BeatrixError:
    """What to tell who pressed STOP while arms moved, and the board went."""
    if reset:
        return NoAnswer(
            Reason.BOARD_LOST, "The board was reset meanwhile: its motors are off, and home is not known."
        )
    return not_stopped(NoAnswer(Reason.BOARD_LOST, "The board was lost while stopping."))


def at_rest(board: Board, how: str, arms: Arms) -> str:
    """What is true after a stop that the board has taken; arms in rad."""
    link = board.link
    if not link.connected:
        return f"The board has taken it, but what it does now cannot be seen. {link.trouble}"
    if board.state & State.EMERGENCY:
        return "Motors off, latched until enabled; home is forgotten."
    return f"{how}; the arms rest at {degrees(arms)}."


def unknown_command(number: int) -> Refused:
    """What to tell who asked for a command that is not in the table."""
    table = ", ".join(f"{command.value} {command.name}" for command in Command)
    return Refused(Reason.UNKNOWN_COMMAND, f"There is no command {number}. There are: {table}.")


def preview_refused(error: BeatrixError) -> PreviewReply:
    """Why there is no preview."""
    return PreviewReply(
        result=False,
        reason=error.reason,
        message=error.message,
        duration=0.0,
        tilt_max=0.0,
        gap_min=0.0,
        t=[],
        arms=[],
        head=[],
    )
