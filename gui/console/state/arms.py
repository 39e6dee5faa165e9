"""The rows of the arms, one for each and one for all, and the motions of + and -.

Held buttons move the robots on until the release: window and page repeat each hold as a heartbeat.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Annotated, Final

from msgspec import Meta, structs

from beatrix_zenoh.client.degrees import ArmAngles, arm_angles, motion_query
from beatrix_zenoh.client.twin_motion import furthest
from beatrix_zenoh.contract._generated.messages import MotionQuery, PoseQuery, Vector3
from beatrix_zenoh.contract._generated.robot import ROBOT
from beatrix_zenoh.contract.names import ARMS, SIDES
from beatrix_zenoh.motion.gear import Gear
from gui.console.state import refusals
from gui.console.state.actions import NEW, Action, Hold, Release, Send, Shares
from gui.console.state.intents import ALL_ARMS, Intent, Jog
from gui.console.state.memory import Handles, Memory, begin, send_arms, unreachable
from gui.console.state.views import ArmRowView, ArmsView, ButtonView
from gui.console.state.world import World, commanded, reading

HALF_STEP_DEG: Final = 180 / Gear().steps_per_turn * 1.001
"""Largest distance (deg) of the set point of an arm at rest from its goal: half a microstep, and rounding."""
AXES: Final = dict(zip(ARMS, "xyz", strict=True)) | {ALL_ARMS: ""}
INCREMENT_MAX: Final = 90.0
"""deg, a quarter of a turn; larger turns take several presses"""
ROTATIONS: Final = ("yaw", "pitch", "roll")
SLOWEST: Final = math.radians(1.0)
"""rad/s; a stick that is hardly moved turns the head less far, not slower"""
AHEAD_S: Final = 0.5
"""Time to each goal of a hold, longer than network delays; without a new goal the robots stop by themselves."""
FASTEST_DEG_S: Final = 40.0
"""Largest speed of a hold (deg/s)."""
REFUSED: Final = 0
"""`Memory.held_row` of a press that was refused: nothing is sent before the next press."""


def view(memory: Memory, world: World) -> ArmsView:
    """Return all rows, and the choices that + and - depend on."""
    limit = ROBOT.limits.speed_max if world.limits is None else math.degrees(world.limits.speed_max)
    return ArmsView(
        rows=tuple(_row(memory, world, arm) for arm in (*ARMS, ALL_ARMS)),
        increment_max=INCREMENT_MAX,
        speed_max=limit,
        refusal=refusals.at(memory, (*ARMS, ALL_ARMS)),
    )


def _row(memory: Memory, world: World, arm: str) -> ArmRowView:
    texts = memory.choices.texts
    angles: dict[str, float] = {}
    if arm != ALL_ARMS:
        for side in SIDES:
            if (found := reading(world, side)) is not None:
                angles[side] = getattr(found.arms, arm)
    shown = {side: texts("angle", degrees=angle) for side, angle in angles.items()}
    empty = "" if arm == ALL_ARMS else texts("unknown")
    apart = texts("difference", degrees=angles["hw"] - angles["sim"]) if len(angles) > 1 else ""
    return ArmRowView(
        arm=arm,
        title=texts(f"arm.{arm}"),
        axis=AXES[arm],
        sim=shown.get("sim", empty),
        hw=shown.get("hw", empty),
        difference=apart,
        minus=_button(memory, Jog(arm, -1)),
        plus=_button(memory, Jog(arm, +1)),
    )


def _button(memory: Memory, jog: Jog) -> ButtonView:
    texts = memory.choices.texts
    text = texts("arm.plus") if jog.sign > 0 else texts("arm.minus")
    if not memory.choices.sides:
        return ButtonView(text, texts("off.unchecked"), jog, enabled=False)
    hold = texts("arm.hold_both" if len(memory.choices.sides) > 1 else "arm.hold")
    effect = "arm.effect_by" if memory.choices.relative else "arm.effect_to"
    told = texts(effect, arm=texts(f"arm.{jog.arm}"), by=jog.sign * memory.choices.increment)
    return ButtonView(text, f"{told}\n{hold}", jog)


def jog(memory: Memory, world: World, intent: Jog) -> list[Action]:
    """Return the action for + or - in the chosen mode: one motion, also for all arms; none if it is refused."""
    choices = memory.choices
    by = intent.sign * choices.increment
    chosen = ARMS if intent.arm == ALL_ARMS else (intent.arm,)
    if choices.relative and len(choices.sides) < 2 and _going(memory, world) is None:
        by_arms = _moved(ArmAngles(0.0, 0.0, 0.0), chosen, by, relative=True)
        return send_arms(memory, world, by_arms, intent.arm, relative=True)
    if unreachable(memory, world, choices.sides, intent.arm):
        return []
    start = _start(memory, world)
    if start is None:
        if choices.relative or intent.arm != ALL_ARMS:
            return memory.refuse(intent.arm, "cannot.position")
        start = ArmAngles(by, by, by)
    return send_arms(memory, world, _moved(start, chosen, by, relative=choices.relative), intent.arm)


def _start(memory: Memory, world: World) -> ArmAngles | None:
    """Return the angles that + or - start from; None if they are unknown.

    They are the goal of the motion that the checked robots are making, or else the set point: so three quick presses
    turn an arm three times as far, and robots that stand apart, as after STOP, come together. Arms at rest stand at
    whole microsteps; if the last goal is nearer than one, it counts, so that increments add up exactly.
    """
    here = commanded(world, memory.choices.sides)
    if not memory.choices.relative:
        return here
    goal = None if here is None else _goal(memory, world)
    reached = here is not None and goal is not None and furthest(goal, here) <= HALF_STEP_DEG
    return _going(memory, world) or (goal if reached else here)


def _going(memory: Memory, world: World) -> ArmAngles | None:
    """Return the goal of the motion that just the checked robots are making; None if there is none, or it is unknown."""
    if not memory.rows or memory.rows[-1].ended or (len(memory.choices.sides) > 1 and world.plan is None):
        return None
    return _goal(memory, world)


def _goal(memory: Memory, world: World) -> ArmAngles | None:
    """Return the goal of the newest request if it is a motion of just the checked robots, and not of a held button."""
    row, sides = memory.rows[-1] if memory.rows else None, memory.choices.sides
    if row is None or row.sides != sides or row.number == memory.open_hold:
        return None
    if not isinstance(row.request, Send):
        return None
    query = row.request.query
    if isinstance(query, PoseQuery):
        path = None if world.plan is None else world.plan.path
        return path.arms[-1] if path is not None and path.arms else None
    goal, start = arm_angles(query.position), row.before.get(sides[0])
    if query.absolute or start is None:
        return goal if query.absolute else None
    return ArmAngles(*map(sum, zip(start, goal, strict=True)))


def _moved(start: ArmAngles, chosen: tuple[str, ...], by: float, *, relative: bool) -> ArmAngles:
    """Return the angles with some arms turned by an angle, or to it (deg)."""
    goals = {arm: angle + by if relative else by for arm, angle in zip(ARMS, start, strict=True)}
    return ArmAngles(
        *(goals[arm] if arm in chosen else angle for arm, angle in zip(ARMS, start, strict=True))
    )


class HoldArm(Intent, frozen=True):
    """+ or - of an arm, or of an axis of the head, is held; reported again and again until the release."""

    arm: Annotated[str, Meta(pattern="^(short|middle|long|all|yaw|pitch|roll)$")]
    sign: Annotated[int, Meta(ge=-1, le=1)]
    """+1 or -1"""


Share = Annotated[float, Meta(ge=-1, le=1)]
"""Speed of an axis, divided by the chosen speed."""


class Steer(Intent, frozen=True):
    """A stick, or keys, turn the head; reported again and again until they rest, which `ReleaseArm` reports."""

    yaw: Share
    pitch: Share
    roll: Share


class ReleaseArm(Intent, frozen=True):
    """The held button or stick was released, or can no longer be held."""


def jog_query(shares: Shares, speed_deg_s: float, ahead_s: float) -> MotionQuery | PoseQuery:
    """Return the motion of arms, or of axes of the head, from the present set point for `ahead_s`."""
    speed = math.radians(min(speed_deg_s, FASTEST_DEG_S))
    turned = {part: share * speed * ahead_s for part, share in shares}
    fastest = max(SLOWEST, *(speed * abs(share) for _, share in shares))
    if turned.keys() <= {*ROTATIONS}:
        yaw, pitch, roll = (turned.get(name, 0.0) for name in ROTATIONS)
        return PoseQuery(absolute=False, yaw=yaw, pitch=pitch, roll=roll, speed=fastest)
    x, y, z = (turned.get(name, turned.get(ALL_ARMS, 0.0)) for name in ARMS)
    return MotionQuery(absolute=False, position=Vector3(x, y, z), speed=Vector3(fastest, fastest, fastest))


def _shares(intent: HoldArm | Steer) -> Shares:
    if isinstance(intent, HoldArm):
        return ((intent.arm, float(intent.sign)),)
    return tuple((name, getattr(intent, name)) for name in ROTATIONS)


def hold(memory: Memory, world: World, intent: HoldArm | Steer) -> list[Action]:
    """Return the action of a held button or stick, which has one row in the history; none if the hold is refused."""
    speed, sides, shares = memory.choices.speed, memory.choices.sides, _shares(intent)
    if not any(share for _, share in shares):
        return []
    if memory.held_row is None:
        query = jog_query(shares, speed, AHEAD_S)
        control = "head" if isinstance(query, PoseQuery) else shares[0][0]
        begun = begin(memory, world, Send(NEW, query, sides), control)
        memory.held_row = memory.open_hold = memory.numbers if begun else REFUSED
    if memory.held_row == REFUSED:
        return []
    return [Hold(memory.held_row, shares, speed, sides)]


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


HANDLES: Handles = {
    Jog: jog,
    HoldArm: hold,
    Steer: hold,
    ReleaseArm: release,
}
