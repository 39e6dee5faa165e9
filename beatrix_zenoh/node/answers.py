"""Replies of a robot, and the way back to who asked."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import msgspec

from beatrix_zenoh._generated.messages import CommandReply, MotionReply, Phase, PreviewReply, Reason
from beatrix_zenoh.drive import Arms
from beatrix_zenoh.errors import BeatrixError
from beatrix_zenoh.node.course import vector


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
