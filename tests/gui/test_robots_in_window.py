"""The window with real robots: angles, commands, STOP, the pad, the lead, the next steps and the cameras."""

from __future__ import annotations

import pytest
from gui_windows import HOME, Windowed, menu_button, near
from present import present
from PyQt5.QtCore import QPoint, Qt
from PyQt5.QtTest import QTest
from PyQt5.QtWidgets import QApplication, QLabel
from robots import Stage

from beatrix_zenoh import Robot
from beatrix_zenoh.contract._generated.messages import Fault
from beatrix_zenoh.contract.names import ARMS
from gui.console.state.intents import HeadOrientation
from gui.window.widgets.head3d_drag import SKULL, on_screen

pytestmark = [
    pytest.mark.qt_log_ignore("This plugin does not support"),  # popups without a display
    pytest.mark.no_cover,  # the tests of window, link and bridge cover the same code
]


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


def stop_by_mouse(user: Windowed) -> None:
    QTest.mousePress(user.window.panels.stop_bar, Qt.MouseButton.LeftButton)  # the button is not released yet


def stop_in_a_box(user: Windowed) -> None:
    box = user.window.panels.sending.lead
    box.setFocus()
    user.until(box.hasFocus, "the box has the focus")
    user.key(Qt.Key.Key_Space)


def stop_in_a_popup(user: Windowed) -> None:
    user.window.panels.header.robots.showPopup()
    user.until(lambda: QApplication.activePopupWidget() is not None, "the list is open")
    user.key(Qt.Key.Key_Space)


def test_stop_stops_both_moving_robots(user: Windowed, sim: Robot, hw: Robot) -> None:
    panels, way = user.window.panels, 1
    user.type_number(panels.arms.speed.box, 30)
    user.type_number(panels.arms.increment.box, 60)
    user.check(panels.arms.absolute)
    for stop in (stop_by_mouse, stop_in_a_box, stop_in_a_popup):
        rows = panels.arms.rows["all"]
        user.press(rows.plus if way > 0 else rows.minus)
        user.until(lambda: sim.status().moving and hw.status().moving, "both move")
        stop(user)
        user.until(lambda: not (sim.status().moving or hw.status().moving), "both rest")
        user.until_last("stop done", "both")
        assert all(abs(robot.positions().arms.long - way * 60) > 5 for robot in (sim, hw)), (
            "the arms moved on after STOP"
        )
        QTest.mouseRelease(panels.stop_bar, Qt.MouseButton.LeftButton)
        way = -way


def test_an_emergency_stop_switches_off_both_moving_robots_and_offers_reset(
    user: Windowed, robots: dict[str, Robot]
) -> None:
    panels = user.window.panels
    user.type_number(panels.arms.speed.box, 30)
    user.type_number(panels.arms.increment.box, 60)
    user.press(panels.arms.rows["all"].plus)
    user.until(lambda: all(robot.status().moving for robot in robots.values()), "both move")
    user.press(menu_button(user.window, "sim", "EMERGENCY STOP"))
    assert all(robot.status().fault is Fault.NONE for robot in robots.values()), "the button asks first"
    user.press(menu_button(user.window, "sim", "EMERGENCY STOP"))
    user.until(
        lambda: all(robot.status().fault is Fault.EMERGENCY for robot in robots.values()), "both are latched"
    )
    user.until_last("emergency stop done", "both")
    assert all(robot.positions().arms.long < 55 for robot in robots.values())
    for pill in panels.header.pills.values():
        user.until(lambda pill=pill: pill.next_step.text() == "Clear the stop", "it offers RESET")  # type: ignore[misc]
        user.press(pill.next_step)
    user.until(lambda: all(robot.status().fault is Fault.NONE for robot in robots.values()), "both are reset")


# -- head -----------------------------------------------------------------------------------------


def test_the_user_drags_a_target_on_the_pad_and_sends_it(user: Windowed, sim: Robot, hw: Robot) -> None:
    pad, view = user.window.panels.head.pad, user.state.view(user.window._world).head
    goal = HeadOrientation(0.0, 12.0, -8.0)
    user.drag(pad, *(pad.tilt_point(at, view.tilt_max).toPoint() for at in (view.target, goal)))
    target = present(user.state.choices.target)
    assert (target.pitch, target.roll) == pytest.approx((12, -8), abs=0.7)
    assert near(sim.positions().arms, HOME), "nothing was sent yet"
    user.press(user.window.panels.sending.send)
    user.until_last("look", "done")
    for robot in (sim, hw):
        assert robot.positions().head == pytest.approx((0, target.pitch, target.roll), abs=0.25)


# -- lead -----------------------------------------------------------------------------------------


def leading(user: Windowed, sim: Robot) -> None:
    """Send a motion whose lead is a minute, and wait until the simulation is at its goal."""
    panels = user.window.panels
    user.type_number(panels.sending.lead, 60)
    user.press(panels.arms.rows["all"].plus)
    user.until_at(sim, 5, 5, 5)
    user.until(lambda: "follows in 5" in panels.sending.title.text(), "the countdown")


@pytest.mark.parametrize("name", ["change", "abort"])
def test_during_the_lead_the_hardware_can_be_kept_unmoved(
    user: Windowed, sim: Robot, hw: Robot, name: str
) -> None:
    leading(user, sim)
    before = hw.positions().commanded
    user.press(getattr(user.window.panels.sending, name))
    user.until(lambda: not user.window.panels.sending.plan.isVisible(), "nothing waits")
    user.until_ready("sim", "hw")
    assert hw.positions().commanded == before == HOME
    shown = user.window.panels.head.pad._view
    assert shown is not None
    assert shown.sim is not None
    expected_yaw = 5 if name == "change" else shown.sim.yaw
    assert shown.target.yaw == pytest.approx(expected_yaw, abs=0.2)


def test_the_next_steps_of_a_pill_make_the_robot_ready(
    user: Windowed, stage: Stage, sim: Robot, hw: Robot
) -> None:
    pills = user.window.panels.header.pills
    stage.robot("bea", "sim", "eve").emergency_stop()
    for _ in range(2):
        assert hw.status().enabled
        user.press(menu_button(user.window, "hw", "Disable"))  # it asks first, because the head sinks
    user.until(lambda: not hw.status().enabled, "the second press disables it")
    user.until(lambda: "emergency" in pills["sim"].state.text(), "the window shows the emergency stop")
    assert sim.status().fault is Fault.EMERGENCY
    user.press(menu_button(user.window, "sim", "Clear emergency stop"))
    user.until(lambda: pills["sim"].next_step.text() == "Make ready", "the next step")
    assert not sim.status().enabled
    user.press(pills["sim"].next_step)
    for text in ("Enable", "Calibrate"):
        user.until(lambda text=text: pills["hw"].next_step.text() == text, text)  # type: ignore[misc]
        user.press(pills["hw"].next_step)
    user.until_ready("sim", "hw")
    assert all(robot.status().calibrated for robot in (sim, hw))


@pytest.mark.long("test_head3d.py and test_link_plans.py have its parts")
def test_the_dragged_head_is_sent_to_both_robots(user: Windowed, sim: Robot, hw: Robot) -> None:
    head = user.window.panels.head3d
    x, y, _ = on_screen(head.screen3d, user.state.view(user.window._world).head.target, SKULL)
    user.drag(head, QPoint(round(x), round(y)), QPoint(round(x) - 40, round(y) - 15))
    target = present(user.state.choices.target)
    assert target.yaw > 10  # from behind, left is left
    assert target.pitch < -3  # nose up
    user.window.panels.head.pad.setFocus()
    user.key(Qt.Key.Key_Return)
    user.until_last("look", "done")
    for robot in (sim, hw):
        assert robot.positions().head == pytest.approx((target.yaw, target.pitch, target.roll), abs=0.5)
