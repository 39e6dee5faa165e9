"""The missions of the first run, played with real robots: the window notices each when its robots have done it."""

from __future__ import annotations

import pytest
from gui_windows import Windowed, windowed
from robots import Stage

from beatrix_zenoh import Robot
from gui.console.state.intents import AimHead, SendHead
from gui.console.state.missions import MISSIONS, STEPS
from gui.console.state.saved import Saved

pytestmark = pytest.mark.no_cover  # the tests of the state cover the same code
BEFORE = Saved(speed=80.0, lead_s=8.0, guided=len(STEPS))


def send(user: Windowed, yaw: float, pitch: float) -> None:
    """Aim as a drag does, and press Send."""
    user.window.handle(AimHead(yaw, pitch, 0.0))
    user.window.handle(SendHead())
    user.until_shown()


@pytest.mark.long("plays all missions; test_missions.py has their rules")
@pytest.mark.usefixtures("qapp")
def test_the_missions_are_noticed_when_the_robots_have_done_them(
    stage: Stage, robots: dict[str, Robot]
) -> None:
    for robot in robots.values():
        robot.make_ready()
        robot.home()
    with windowed(stage.endpoint, saved=BEFORE) as user:
        panels = user.window.panels

        def until_noticed(mission: int, what: str) -> None:
            user.until(lambda: user.state.saved.guided > len(STEPS) + mission, what)

        user.until_ready("sim", "hw")
        assert "Mission 1 of 3" in panels.guide.text.text()
        user.send_to("sim")
        user.press(panels.gestures.buttons["no"])
        user.until_last("gesture", "done")
        assert "Mission 1 of 3" in panels.guide.text.text(), "a gesture is no solution"
        for yaw in (12.0, -12.0, 12.0):
            send(user, yaw, 0.0)
            user.until_last("done")
        until_noticed(0, "the head has said no")
        assert "Mission 2 of 3" in panels.guide.text.text()
        send(user, 0.0, 20.0)
        user.until_last("done")
        assert "Mission 2 of 3" in panels.guide.text.text(), "the robot has accepted that"
        send(user, 0.0, 42.0)
        until_noticed(1, "the robot has refused a target beyond the edge")
        assert "Mission 3 of 3" in panels.guide.text.text()
        user.send_to("sim", "hw")
        send(user, 15.0, 0.0)
        user.until(panels.sending.send_now.isEnabled, "the hardware waits for the simulation")
        user.press(panels.sending.send_now)
        until_noticed(2, "the hardware moved before the end of the lead")
        assert user.state.saved.guided == len(STEPS) + len(MISSIONS)
        assert "All missions done" in panels.guide.text.text()
        user.until_at(robots["hw"], 15.0, 15.0, 15.0)
