"""Held + and -: the robots move on until the release. Window and page repeat each hold as a heartbeat."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Final

from msgspec import structs

from beatrix_zenoh.client.degrees import motion_query
from beatrix_zenoh.contract._generated.messages import MotionQuery, PoseQuery, Vector3
from beatrix_zenoh.contract.names import ARMS
from gui.console.state import motions
from gui.console.state.actions import Action, Hold, Release, Send
from gui.console.state.intents import ALL_ARMS, Intent
from gui.console.state.memory import Memory, unreachable
from gui.console.state.world import World, commanded

ROTATIONS: Final = ("yaw", "pitch", "roll")
AHEAD_S: Final = 0.5
"""Time to each goal of a hold, longer than network delays; without a new goal the robots stop by themselves."""
FASTEST_DEG_S: Final = 40.0
"""Largest speed of a hold (deg/s)."""
REFUSED: Final = 0
"""`Memory.held_row` of a press that was refused: nothing is sent before the next press."""


class HoldArm(Intent, frozen=True):
    """+ or - of an arm is held; reported again and again until the release."""

    arm: str
    """`short`, `middle`, `long` or `all`"""
    sign: int
    """+1 or -1"""


class ReleaseArm(Intent, frozen=True):
    """The held button was released, or can no longer be held."""


def jog_query(part: str, sign: int, speed_deg_s: float, ahead_s: float) -> MotionQuery | PoseQuery:
    """Return the motion of one part of the head, or of all arms, from the present set point for `ahead_s`."""
    speed = math.radians(min(speed_deg_s, FASTEST_DEG_S))
    angle = sign * speed * ahead_s
    if part in ROTATIONS:
        yaw, pitch, roll = (angle if part == name else 0.0 for name in ROTATIONS)
        return PoseQuery(absolute=False, yaw=yaw, pitch=pitch, roll=roll, speed=speed)
    x, y, z = (angle if part in (name, ALL_ARMS) else 0.0 for name in ARMS)
    return MotionQuery(absolute=False, position=Vector3(x, y, z), speed=Vector3(speed, speed, speed))


def begin(memory: Memory, world: World, query: MotionQuery | PoseQuery, control: str) -> int | None:
    """Add the one row of a hold to the history; return its number, or None if the hold is refused."""
    sides = memory.choices.sides
    if unreachable(memory, world, sides, control):
        return None
    request = Send(memory.next_row(), query, sides)
    motions.begin(memory, world, request, control)
    return request.row


def hold(memory: Memory, world: World, intent: HoldArm) -> list[Action]:
    """Return the action of a held button; none if the hold is refused."""
    speed = memory.choices.speed
    if memory.held_row is None:
        query = jog_query(intent.arm, intent.sign, speed, AHEAD_S)
        memory.held_row = begin(memory, world, query, intent.arm) or REFUSED
        memory.open_hold = memory.held_row
    if memory.held_row == REFUSED:
        return []
    return [Hold(memory.held_row, intent.arm, intent.sign, speed, memory.choices.sides)]


def release(memory: Memory, _world: World, _intent: ReleaseArm) -> list[Action]:
    """Return the action of a released button; none if the hold was refused."""
    row, memory.held_row = memory.held_row, None
    return [Release(row)] if row else []


def follow(memory: Memory, world: World) -> None:
    """Once the arms rest after a hold, write their angles into its row, so that a copied program repeats the motion."""
    row = memory.row(memory.open_hold)
    if row is None or not row.ended:
        return
    memory.open_hold = REFUSED
    here = commanded(world, row.sides)
    good = all(outcome.accepted for outcome in row.outcomes.values())
    if good and here is not None and isinstance(row.request, Send):
        query = motion_query(*here, relative=False, speed=min(memory.choices.speed, FASTEST_DEG_S))
        memory.replace_row(replace(row, request=structs.replace(row.request, query=query)))


HANDLES: motions.Handles = {HoldArm: hold, ReleaseArm: release}
