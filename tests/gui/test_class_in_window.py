"""A teacher's and a student's window connected to real robots: freeze, queue, speed limit, STOP for all."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from gui_windows import Windowed, windowed
from robots import Stage

from beatrix_zenoh import Robot
from beatrix_zenoh.client import lease
from beatrix_zenoh.contract._generated.messages import LeaseAction
from gui.console.state.intents import Choose


@pytest.fixture
def teacher(stage: Stage) -> Iterator[Windowed]:
    """A teacher's window that shows the class; afterwards all robots are free."""
    with windowed(stage.endpoint, who="teacher") as made:
        page = made.window.panels.class_page
        made.press(made.window.panels.header.page)
        made.until(lambda: page.list.topLevelItemCount() == 3, "all robots are listed")
        yield made
    for side in ("sim", "hw"):
        robot = stage.robot("bea", side, "teacher")
        lease.ask(robot, LeaseAction.UNFREEZE)
        lease.ask(robot, LeaseAction.LIMIT)
        lease.ask(robot, LeaseAction.GIVE_BACK)


def moves(user: Windowed, robots: dict[str, Robot], goal: float = 60.0) -> None:
    """Let the student's window turn all arms to `goal` (deg), and wait until both robots move."""
    for intent in (Choose("relative", value=False), Choose("speed", 20.0), Choose("increment", goal)):
        user.window.handle(intent)
    user.press(user.window.panels.arms.rows["all"].plus)
    user.until(lambda: all(robot.status().moving for robot in robots.values()), "both move")


def test_freeze_all_stops_the_robots_and_refuses_students(
    user: Windowed, teacher: Windowed, robots: dict[str, Robot]
) -> None:
    panels, page = user.window.panels, teacher.window.panels.class_page
    moves(user, robots)
    teacher.press(page.freeze_all)
    teacher.until(lambda: "done by 3 robots" in page.result.text(), "all are frozen")
    user.until(lambda: not any(robot.status().moving for robot in robots.values()), "both rest")
    assert all(robot.status().frozen and robot.positions().arms.long < 55 for robot in robots.values())
    user.until(lambda: "frozen by the teacher" in panels.header.pills["hw"].state.text(), "the pill shows it")
    user.until(lambda: "frozen the robot (both)" in panels.banner.text.text(), "the banner names both robots")
    user.press(panels.arms.rows["all"].plus)
    user.until(lambda: "The teacher has frozen this robot" in panels.refusal.text.text(), "it is refused")
    teacher.press(page.unfreeze_all)
    user.until_ready("sim", "hw")
    user.window.handle(Choose("increment", 2.0))
    user.press(panels.arms.rows["all"].minus)
    user.until_last("move", "under way")


def test_the_teacher_limits_the_speed_and_stops_all_robots(
    user: Windowed, teacher: Windowed, robots: dict[str, Robot]
) -> None:
    panels, page = user.window.panels, teacher.window.panels.class_page
    page.limit.setText("25")
    teacher.press(page.set_limit)
    user.until(
        lambda: "limit 25 °/s" in panels.header.pills["sim"].notes.text(), "the student sees the limit"
    )
    moves(user, robots)
    teacher.press(teacher.window.panels.stop_bar)
    teacher.until(lambda: "stop all robots: done by 3 robots" in page.result.text(), "all have stopped")
    assert not any(robot.status().moving for robot in robots.values())
    assert all(robot.positions().arms.long < 55 for robot in robots.values())
