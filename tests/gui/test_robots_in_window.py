"""The window with real robots: angles, commands, STOP, held buttons, the pad, the head, a face that is followed."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from gui_windows import HOME, Windowed, drag, near, windowed
from present import present
from PyQt5.QtCore import QPoint, Qt
from PyQt5.QtTest import QTest
from PyQt5.QtWidgets import QLabel
from pytestqt.qtbot import QtBot
from robots import Stage, ready, until

from beatrix_zenoh import Refused, Robot
from beatrix_zenoh.body.scene import SKULL
from beatrix_zenoh.contract.names import ARMS
from gui.console.state.intents import HeadOrientation
from gui.console.state.saved import Saved
from gui.window.widgets.head3d_drag import on_screen

pytestmark = pytest.mark.no_cover  # the tests of window, link and bridge cover the same code


FAST = Saved(speed=80.0, lead_s=0.0)


@pytest.fixture(scope="module")
def calibrated(stage: Stage) -> None:
    """Calibrate both robots where they are: the file before may have left them away from home."""
    for robot in (stage.robot("bea", side) for side in ("sim", "hw")):
        robot.stop()
        robot.disable()
        ready(robot)


@pytest.fixture
def robots(stage: Stage, calibrated: None) -> Iterator[dict[str, Robot]]:
    """Both robots, through new sessions of the window's seat, which need not pause after an earlier STOP of the seat."""
    yield {side: stage.robot("bea", side) for side in ("sim", "hw")}
    stage.close_clients()


@pytest.fixture
def sim(robots: dict[str, Robot]) -> Robot:
    return robots["sim"]


@pytest.fixture
def hw(robots: dict[str, Robot]) -> Robot:
    return robots["hw"]


@pytest.fixture
def user(stage: Stage, robots: dict[str, Robot], qtbot: QtBot) -> Iterator[Windowed]:
    """A window connected to two robots that are ready and at home; both are checked, without lead, at 80 deg/s."""
    for robot in robots.values():
        until(lambda robot=robot: goes_home(robot), "a pause has ended, and the arms are at home")  # type: ignore[misc]
    with windowed(stage.endpoint, saved=FAST) as made:
        made.until_ready("sim", "hw")
        made.send_to("sim", "hw")
        yield made


def goes_home(robot: Robot) -> bool:
    """Move a robot home; return False if it refuses or is stopped, as after a STOP of another seat."""
    try:
        robot.make_ready()
        robot.move(*HOME, speed=80)
    except Refused:
        return False
    return True


# -- arms -----------------------------------------------------------------------------------------


def shows(label: QLabel, angle: float) -> bool:
    """Return whether a label shows an angle (deg)."""
    return label.text() != "–" and abs(float(label.text().rstrip("°")) - angle) < 0.2


def test_each_column_shows_the_angles_of_its_robot(user: Windowed) -> None:
    rows, head = user.window.panels.arms.rows, user.window.panels.head
    user.send_to("hw")
    for arm in ARMS:
        user.press(rows[arm].plus)
        user.until_last("move", "done")
    for arm in ARMS:
        user.until(lambda row=rows[arm]: shows(row.hw, 5) and shows(row.sim, 0), f"the angles of {arm}")  # type: ignore[misc]
    user.until(lambda: shows(head.numbers["hw", "yaw"], 5), "the yaw of the hardware")
    assert shows(head.numbers["sim", "yaw"], 0)


# -- commands -------------------------------------------------------------------------------------


def test_commands_are_sent_to_both_robots(user: Windowed, robots: dict[str, Robot]) -> None:
    panels, buttons = user.window.panels, user.window.panels.commands.buttons
    user.press(panels.arms.rows["all"].plus)
    user.until_last("done")
    user.press(buttons["home"])
    for robot in robots.values():
        user.until_at(robot, *HOME)
    user.until_last("home done")


# -- STOP -----------------------------------------------------------------------------------------


def move_far(user: Windowed, *robots: Robot) -> None:
    """Turn all arms to 60 deg from home, slowly, and wait until the robots move."""
    arms = user.window.panels.arms
    user.type_number(arms.speed.box, 30)
    user.type_number(arms.increment.box, 60)
    user.check(arms.absolute)
    user.press(arms.rows["all"].plus)
    user.until(lambda: all(robot.status().moving for robot in robots), "both move")


def test_stop_stops_both_moving_robots(user: Windowed, sim: Robot, hw: Robot) -> None:
    bar = user.window.panels.stop_bar
    move_far(user, sim, hw)
    QTest.mousePress(bar, Qt.MouseButton.LeftButton)  # the button is not released yet
    user.until(lambda: not (sim.status().moving or hw.status().moving), "both rest")
    user.until_last("stop done", "both")
    assert all(robot.positions().arms.long < 55 for robot in (sim, hw)), "the arms moved on after STOP"
    QTest.mouseRelease(bar, Qt.MouseButton.LeftButton)


# -- held buttons ---------------------------------------------------------------------------------

BRAKE_DEG = 10.0
"""Largest angle between release and rest at 30 deg/s: 0.1 s of the way, 0.12 s to the last goal, and slow tests."""


def test_both_robots_move_while_a_button_is_held_until_release_or_stop(
    user: Windowed, sim: Robot, hw: Robot
) -> None:
    robots, button = (sim, hw), user.window.panels.arms.rows["all"].plus

    def long() -> list[float]:
        return [robot.positions().arms.long for robot in robots]

    def rest() -> bool:
        return not any(robot.status().moving for robot in robots)

    QTest.mousePress(button, Qt.MouseButton.LeftButton)
    user.until(lambda: min(long()) > 20, "both have moved on")
    QTest.mouseRelease(button, Qt.MouseButton.LeftButton)
    here = long()
    user.until(rest, "both rest")
    assert long() == pytest.approx(here, abs=BRAKE_DEG)
    QTest.mousePress(button, Qt.MouseButton.LeftButton)
    user.until(lambda: all(robot.status().moving for robot in robots), "both move again")
    QTest.mouseClick(user.window.panels.stop_bar, Qt.MouseButton.LeftButton)
    user.until(rest, "both rest")
    here = long()
    QTest.qWait(500)
    assert long() == pytest.approx(here, abs=0.1), "the button is still held"
    QTest.mouseRelease(button, Qt.MouseButton.LeftButton)


# -- head -----------------------------------------------------------------------------------------


def test_the_user_drags_a_target_on_the_pad_and_sends_it(user: Windowed, sim: Robot, hw: Robot) -> None:
    pad, view = user.window.panels.head.pad, user.state.view(user.window._world).head
    goal = HeadOrientation(0.0, 12.0, -8.0)
    drag(pad, *(pad.tilt_point(at, view.tilt_max).toPoint() for at in (view.target, goal)))
    target = present(user.state.choices.target)
    assert (target.pitch, target.roll) == pytest.approx((12, -8), abs=0.7)
    assert near(sim.positions().arms, HOME), "nothing was sent yet"
    user.press(user.window.panels.sending.send)
    user.until_last("look", "done")
    for robot in (sim, hw):
        assert robot.positions().head == pytest.approx((0, target.pitch, target.roll), abs=0.25)


@pytest.mark.long("test_head3d.py and test_link_plans.py have its parts")
def test_the_dragged_head_is_sent_to_both_robots(user: Windowed, sim: Robot, hw: Robot) -> None:
    head = user.window.panels.head3d
    x, y, _ = on_screen(head.screen3d, user.state.view(user.window._world).head.target, SKULL)
    drag(head, QPoint(round(x), round(y)), QPoint(round(x) - 40, round(y) - 15))
    target = present(user.state.choices.target)
    assert target.yaw < -10  # it faces the user, so that it looks to its right
    assert target.pitch < -3  # nose up
    user.window.panels.head.pad.setFocus()
    QTest.keyClick(user.window.panels.head.pad, Qt.Key.Key_Return)
    user.until_shown()
    user.until_last("look", "done")
    for robot in (sim, hw):
        assert robot.positions().head == pytest.approx((target.yaw, target.pitch, target.roll), abs=0.5)


# -- following a face -----------------------------------------------------------------------------

SEEN_S = 60.0
"""Time limit (s) of the first pictures and of the start of a program on a busy computer."""


@pytest.mark.long("follows with its eyes in real time")
def test_the_simulated_head_follows_a_person_who_walks_until_the_second_press(
    user: Windowed, sim: Robot, hw: Robot, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("HOME", str(tmp_path))  # a user without programs
    panel = user.window.panels.gestures
    user.send_to("sim")
    for end in (panel.follow, user.window.panels.stop_bar):
        sim.move_target(1.0, 0.5, 0.1)
        user.press(panel.follow)
        user.until(lambda: sim.positions().head.yaw > 20, "the head has turned to the left", SEEN_S)
        assert panel.follow.property("running") == "yes"
        sim.move_target(1.0, -0.5, 0.1)
        user.until(lambda: sim.positions().head.yaw < -20, "the head has turned to the right", SEEN_S)
        user.press(end)
        user.until(lambda: panel.follow.property("running") != "yes", "the program has ended")
        user.until(lambda: not sim.status().moving, "the head rests")
    assert hw.positions().head == pytest.approx((0, 0, 0), abs=0.5), "the hardware was not checked"
