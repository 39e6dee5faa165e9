"""The head pad: its target, the heads of simulation and hardware, limits and the previewed path."""

from __future__ import annotations

import math

from beatrix_zenoh.contract._generated.robot import ROBOT
from gui.console.state import refusals
from gui.console.state.intents import SendHead
from gui.console.state.memory import Memory
from gui.console.state.presence import orientation, reading
from gui.console.state.views import ButtonView, HeadView, Orientation
from gui.console.state.world import World

CONTROL = "head"
UPRIGHT = Orientation(0.0, 0.0, 0.0)


def view(memory: Memory, world: World) -> HeadView:
    """Return the pad; limits are those of the robot, or the defaults while they are unknown."""
    tilt_max, yaw_max = ROBOT.limits.tilt_max, ROBOT.limits.yaw_max
    if world.limits is not None:
        tilt_max, yaw_max = math.degrees(world.limits.tilt_max), math.degrees(world.limits.yaw_max)
    path = world.plan.path if world.plan is not None else None
    return HeadView(
        target=target(memory, world),
        sim=_head(world, "sim"),
        hw=_head(world, "hw"),
        tilt_max=tilt_max,
        yaw_max=yaw_max,
        path=() if path is None else tuple(orientation(head) for head in path.head),
        send=_send(memory, world),
        refusal=refusals.at(memory, (CONTROL,)),
    )


def _head(world: World, side: str) -> Orientation | None:
    found = reading(world, side)
    return None if found is None else orientation(found.head)


def target(memory: Memory, world: World) -> Orientation:
    """Return the target of the user, else the head's orientation, so that Send moves nothing, else upright."""
    if memory.choices.target is not None:
        return memory.choices.target
    here = _head(world, (memory.choices.sides or ("sim",))[0]) or UPRIGHT
    return Orientation(*(round(angle, 1) + 0.0 for angle in (here.yaw, here.pitch, here.roll)))


def _send(memory: Memory, world: World) -> ButtonView:
    texts, aim = memory.choices.texts, target(memory, world)
    if not memory.choices.sides:
        return ButtonView(texts("head.send"), texts("off.unchecked"), SendHead(), enabled=False)
    tooltip = texts("head.send_tip", yaw=aim.yaw, pitch=aim.pitch, roll=aim.roll)
    return ButtonView(texts("head.send"), tooltip, SendHead())
