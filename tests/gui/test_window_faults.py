"""The loss of a robot is shown until it is back. The tests of the link have the faults of nodes and routers."""

from __future__ import annotations

import signal

import pytest
from gui_windows import windowed
from robots import Stage

pytestmark = pytest.mark.usefixtures("qtbot")


def test_the_window_shows_the_loss_and_the_return_of_a_robot() -> None:
    with Stage() as stage:
        hw = stage.hardware("bea")
        with windowed(stage.endpoint) as user:
            panels = user.window.panels
            pill = panels.header.pills["hw"]
            user.until(lambda: "motors off" in pill.state.text(), "the robot is shown")
            hw.send(signal.SIGKILL)
            user.until(lambda: "lost" in pill.state.text(), "the loss is shown")
            assert panels.arms.rows["short"].hw.text() == "–", "an old angle is not shown"
            user.send_to("hw")
            user.press(panels.arms.rows["short"].plus)
            assert "not online" in panels.refusal.text.text()
            stage.node("bea")
            user.until(lambda: "motors off" in pill.state.text(), "it is back")
            user.press(pill.next_step)
            user.until_last("enable done")
