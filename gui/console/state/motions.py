"""Motions: built from angles, added to the history, and sent."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from typing import Never

from msgspec import structs

from beatrix_zenoh.client.degrees import ArmAngles, head_angles, motion_query, pose_query
from beatrix_zenoh.contract._generated.messages import Head, MotionQuery, PoseQuery
from beatrix_zenoh.contract.errors import WrongUsage
from gui.console.state.actions import NEW, Action, Play, Send, SendStop
from gui.console.state.intents import HeadOrientation, Intent
from gui.console.state.memory import Memory, Motion, Request, RequestRow, ToRobots, sides_of, unreachable
from gui.console.state.world import World, commanded, news

Query = MotionQuery | PoseQuery
Handles = Mapping[type[Intent], Callable[[Memory, World, Never], list[Action]]]
"""What a topic does for its intents, by their class; each function takes an intent of that class."""


def pass_on(_memory: Memory, _world: World, action: Action) -> list[Action]:
    """Return an action for which nothing is left to decide."""
    return [action]


def send_arms(
    memory: Memory,
    world: World,
    arms: tuple[float, float, float],
    control: str,
    *,
    relative: bool = False,
    undoes: bool = False,
    sides: tuple[str, ...] | None = None,
) -> list[Action]:
    """Return the action that turns the arms to, or by, angles (deg) at the chosen speed; none if it is refused.

    sides: None: the checked robots
    """
    query = partial(motion_query, *arms, relative=relative, speed=memory.choices.speed)
    chosen = memory.choices.sides if sides is None else sides
    return _send(memory, world, query, control, chosen, undoes=undoes)


def send_head(memory: Memory, world: World, target: HeadOrientation, control: str) -> list[Action]:
    """Return the action that turns the head to an orientation (deg) at the chosen speed; none if it is refused."""
    angles = (target.yaw, target.pitch, target.roll)
    query = partial(pose_query, *angles, relative=False, speed=memory.choices.speed)
    return _send(memory, world, query, control, memory.choices.sides)


def _send(
    memory: Memory,
    world: World,
    query: Callable[[], Query],
    control: str,
    sides: tuple[str, ...],
    *,
    undoes: bool = False,
) -> list[Action]:
    try:
        request = Send(NEW, query(), sides, lead_of(memory, sides))
    except WrongUsage as error:  # a number outside the range of the message
        return memory.refuse_error(control, error)
    return begin(memory, world, request, control, undoes=undoes)


def head_of(query: PoseQuery) -> HeadOrientation:
    """Return the goal of a motion of the head (deg)."""
    return HeadOrientation(*head_angles(Head(query.yaw, query.pitch, query.roll)))


def lead_of(memory: Memory, sides: tuple[str, ...]) -> float:
    """Return the chosen lead (s) if both robots move; else 0."""
    return memory.choices.lead_s if len(sides) > 1 else 0.0


def again(memory: Memory, request: Request) -> Request:
    """Return the request as a new one; a motion goes to the checked robots, with the present lead."""
    if isinstance(request, Send | Play):
        sides = memory.choices.sides
        return structs.replace(request, row=NEW, sides=sides, lead_s=lead_of(memory, sides))
    return structs.replace(request, row=NEW)


def begin(
    memory: Memory, world: World, request: Request, control: str, *, undoes: bool = False
) -> list[Action]:
    """Number a request, add it to the history and return its action; none if it cannot reach its robots."""
    if isinstance(request, ToRobots) and unreachable(memory, world, sides_of(request), control):
        return []
    memory.numbers += 1
    request = structs.replace(request, row=memory.numbers)
    memory.news = news(world)
    looks = isinstance(request, Send) and isinstance(request.query, PoseQuery)
    if isinstance(request, Motion | SendStop) and not looks:
        # The target of the pad is out of date, so it follows the head again.
        memory.choices = structs.replace(memory.choices, target=None)
    return memory.add_row(RequestRow(request, control, world.wall_s, _before(world, request), undoes))


def _before(world: World, request: Request) -> dict[str, ArmAngles]:
    sides = request.sides if isinstance(request, Motion) else ()
    return {side: arms for side in sides if (arms := commanded(world, (side,))) is not None}
