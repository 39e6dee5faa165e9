"""The class as a projector shows it: the seat that drives each robot, the time left, and the next seats."""

from __future__ import annotations

from typing import Final

from beatrix_zenoh.client import RobotState
from gui.console.state import pills
from gui.console.state.views import Condition, ProjectorRowView, ProjectorView
from gui.console.state.world import LinkPhase, World
from gui.console.texts import Texts

NEXT: Final = 3
"""Largest number of waiting seats that a row names; more would not be legible from the last row."""
NEXT_CHARACTERS: Final = 24
"""Room for their names (characters) where a robot is as wide and as high as the screen, or both as a part of it."""
COLUMNS: Final = (2, 8, 15, 24)
"""Largest number of robots in one column, in two columns, and so on; still more are shown in one column more."""


def view(world: World, texts: Texts) -> ProjectorView:
    """Return what the projector shows; it has rows only while the link reads the robots of the class."""
    count = len(world.robots)
    columns = 1 + sum(count > most for most in COLUMNS)
    lines = max(1, -(-count // columns))
    one_side = len({robot.side for robot in world.robots}) == 1
    rows = []
    for robot in world.robots:
        side = "" if one_side else f"({texts(f'sides.{robot.side}')})"
        rows.append(_row(robot, side, world, texts, NEXT_CHARACTERS * lines // columns))
    offline = world.phase is not LinkPhase.ONLINE
    missing = texts("reason.no_router", endpoint=world.endpoint) if offline else texts("banner.no_robot")
    return ProjectorView(tuple(rows), columns, lines, "" if rows else missing, texts("projector.stop"))


def _row(robot: RobotState, side: str, world: World, texts: Texts, room: int) -> ProjectorRowView:
    status = robot.status
    found = pills.problem(robot, texts)
    if status is None or (found is not None and found.condition is Condition.SILENT):
        return ProjectorRowView(robot.robot, side, "", "", "", texts("condition.silent"))
    state = texts("condition.frozen_short") if status.frozen else "" if found is None else found.text
    return ProjectorRowView(
        robot=robot.robot,
        side=side,
        driver=world.pupils.get(status.holder, status.holder) or texts("projector.free"),
        left=texts("class.turn_left", seconds=float(status.turn_s)) if status.turn_s else "",
        waiting=_waiting([world.pupils.get(seat, seat) for seat in status.waiting], room, texts),
        state=state,
    )


def _waiting(names: list[str], room: int, texts: Texts) -> str:
    """Return the first names of a queue, as many as fit into `room` characters, and the number of the others."""
    shown = names[:NEXT]
    while len(shown) > 1 and len(", ".join(shown)) > room:
        shown.pop()
    if not shown:
        return ""
    more = texts("projector.more", count=float(len(names) - len(shown))) if len(names) > len(shown) else ""
    return texts("projector.next", seats=", ".join(shown) + more)
