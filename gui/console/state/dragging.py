"""Dragging the head: the border of its rest positions, the simulation that follows, and the release."""

from __future__ import annotations

import dataclasses
import math
from functools import cache

from beatrix_zenoh.client.degrees import head_angles, pose_query
from beatrix_zenoh.contract._generated.messages import Head, PoseQuery, Reason
from beatrix_zenoh.motion.limits.region import border, reach
from gui.console.state import motions
from gui.console.state.actions import Action, Outcome, Send
from gui.console.state.intents import GrabHead, HeadOrientation, LiveHead, ReleaseHead
from gui.console.state.memory import Memory, unreachable
from gui.console.state.views import DragView
from gui.console.state.world import World

PAD = "head"
WITHIN_DEG = 0.1
"""How far inside the border the simulation stays that follows a target beyond it."""
STOPPED = 0
"""`Memory.live_row` after a STOP: nothing is sent before the next drag."""
REFUSED = -1
"""`Memory.live_row` after a refusal that further targets would meet again: Live sends nothing before the next drag."""
REASONS = {
    Reason.OUT_OF_REACH: "refused.tilt",
    Reason.ARM_GAP: "refused.gap",
    Reason.YAW_LIMIT: "refused.yaw",
}


@cache
def border_deg(tilt_max: float, gap_min: float) -> tuple[float, ...]:
    """Return `limits.region.border` in deg, for limits in deg."""
    return tuple(map(math.degrees, border(math.radians(tilt_max), math.radians(gap_min))))


def view(memory: Memory, tilt_max: float, gap_min: float) -> DragView:
    """Return choices, border and the refused target; limits in deg."""
    choices, refusal = memory.choices, memory.refusal
    limits = border_deg(round(tilt_max, 3), round(gap_min, 3))
    refused, reason = None, ""
    request = None if refusal is None or refusal.control != PAD else refusal.request
    if refusal is not None and isinstance(request, Send) and isinstance(request.query, PoseQuery):
        query = request.query
        refused = HeadOrientation(*head_angles(Head(query.yaw, query.pitch, query.roll)))
        reason = choices.texts(REASONS.get(refusal.reason, "refused.other"))
    return DragView(choices.live, limits, refused, reason)


def grab(memory: Memory, _world: World, _intent: GrabHead) -> list[Action]:
    """Begin a drag."""
    memory.live_row = None
    return []


def live(memory: Memory, world: World, _intent: LiveHead) -> list[Action]:
    """Return the action with which the simulation follows a drag, if that was chosen."""
    return _follow(memory, world) if memory.choices.live and memory.live_row not in (STOPPED, REFUSED) else []


def release(memory: Memory, world: World, _intent: ReleaseHead) -> list[Action]:
    """Return the action that sends the target at the end of a drag, if that was chosen."""
    target, ended = memory.choices.target, memory.live_row in (STOPPED, REFUSED)
    if memory.live_row == REFUSED:
        memory.live_row = None
    if target is None or ended or not memory.choices.send_on_release:
        return []
    return motions.send_head(memory, world, target, PAD)


def note_refusal(memory: Memory, outcome: Outcome) -> None:
    """After a refusal that is not about the place of the target, Live ends until the next drag."""
    passing = outcome.accepted or outcome.reason in (Reason.OK, Reason.REPLACED, *REASONS)
    if outcome.row == memory.live_row and not passing:
        memory.live_row = REFUSED


def _follow(memory: Memory, world: World) -> list[Action]:
    """Send the target to the simulation alone; all motions of a drag are one row of the history."""
    sides, target = ("sim",), memory.choices.target
    if target is None:
        return []
    if unreachable(memory, world, sides, PAD):
        memory.live_row = REFUSED
        return []
    pitch, roll = _inside(world, target)
    query = pose_query(target.yaw, pitch, roll, relative=False, speed=memory.choices.speed)
    row = None if memory.live_row is None else memory.row(memory.live_row)
    if row is None:
        request = Send(memory.next_row(), query, sides)
        memory.live_row = request.row
        return motions.begin(memory, world, request, PAD)
    request = Send(row.number, query, sides)
    memory.replace_row(dataclasses.replace(row, request=request))
    return [request]


def _inside(world: World, target: HeadOrientation) -> tuple[float, float]:
    """Return pitch and roll (deg) of the target, or of the point of the border in its direction."""
    limits = world.limits
    if limits is None:
        return target.pitch, target.roll
    tilt_max, gap_min = (round(math.degrees(angle), 3) for angle in (limits.tilt_max, limits.gap_min))
    furthest = reach(border_deg(tilt_max, gap_min), target.pitch, target.roll) - WITHIN_DEG
    shrink = min(1.0, furthest / max(math.hypot(target.pitch, target.roll), 1e-9))
    return target.pitch * shrink, target.roll * shrink


HANDLES: motions.Handles = {GrabHead: grab, LiveHead: live, ReleaseHead: release}
