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


def view(world: World, texts: Texts) -> ProjectorView:
    """Return what the projector shows; it has rows only while the link reads the robots of the class."""
    rows = tuple(_row(robot, world, texts) for robot in world.robots)
    offline = world.phase is not LinkPhase.ONLINE
    missing = texts("reason.no_router", endpoint=world.endpoint) if offline else texts("banner.no_robot")
    return ProjectorView(rows, "" if rows else missing, texts("projector.stop"))


def _row(robot: RobotState, world: World, texts: Texts) -> ProjectorRowView:
    status = robot.status
    found = pills.problem(robot, texts)
    named = f"{robot.robot} ({texts(f'sides.{robot.side}')})"
    if status is None or (found is not None and found.condition is Condition.SILENT):
        return ProjectorRowView(named, "", "", "", texts("condition.silent"), frozen=False)
    state = texts("condition.frozen_short") if status.frozen else "" if found is None else found.text
    names = [world.pupils.get(seat, seat) for seat in status.waiting]
    more = texts("projector.more", count=float(len(names) - NEXT)) if len(names) > NEXT else ""
    return ProjectorRowView(
        robot=named,
        driver=world.pupils.get(status.holder, status.holder) or texts("projector.free"),
        left=texts("class.turn_left", seconds=float(status.turn_s)) if status.turn_s else "",
        waiting=texts("projector.next", seats=", ".join(names[:NEXT]) + more) if names else "",
        state=state,
        frozen=status.frozen,
    )
