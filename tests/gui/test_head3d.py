"""The head in three dimensions: where it is drawn, what the mouse grabs, and where a drag turns it."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from unittest.mock import Mock

import pytest
from gui_views import posed, ready
from gui_windows import drag
from gui_worlds import NOWHERE, world
from hypothesis import given
from hypothesis import strategies as st
from present import present
from PyQt5.QtCore import QPoint, Qt
from PyQt5.QtGui import QImage
from PyQt5.QtTest import QTest
from recording_link import RecordingLink

from beatrix_zenoh.body.scene import EARS, SKULL, Screen
from beatrix_zenoh.client.degrees import HeadAngles
from gui.console.state.intents import Choose, HeadOrientation, Intent, LiveHead, ReleaseHead
from gui.console.state.state import State
from gui.window.widgets import head3d
from gui.window.widgets.head3d import VIEWS, Head3d
from gui.window.widgets.head3d_drag import Drag, Part, grabbed, on_screen
from gui.window.window import Window

Taken = Callable[[], list[Intent]]
UPRIGHT = HeadOrientation(0.0, 0.0, 0.0)
angles = st.floats(-30.0, 30.0)
LEFT = Qt.MouseButton.LeftButton


def screen(name: str) -> Screen:
    return Screen(VIEWS[name], 600.0, 450.0)


# -- geometry ---------------------------------------------------------------------------------------


def test_the_head_of_a_robot_is_grabbed_where_the_target_is_elsewhere() -> None:
    seen, aim = screen("behind"), HeadOrientation(60.0, 0.0, -30.0)
    view = replace(State().view(world()).head, target=aim, sim=UPRIGHT, hw=None)
    x, y, _ = on_screen(seen, UPRIGHT, EARS["right"])
    assert grabbed(seen, replace(view, sim=None), x, y) is None
    assert grabbed(seen, view, x, y) is Part.RIGHT_EAR
    assert grabbed(seen, view, x - 20.0, y + 20.0) is Part.FACE


@given(yaw=st.floats(-170, 170), pitch=angles, roll=angles, across=st.floats(-80, 80), up=st.floats(-80, 80))
def test_a_drag_stays_within_yaw_and_lean_and_back_is_where_it_began(
    yaw: float, pitch: float, roll: float, across: float, up: float
) -> None:
    start = HeadOrientation(round(yaw, 1), round(pitch / 2, 1), round(roll / 2, 1))
    for part in Part:
        drag = Drag(screen("front"), start, part, 300.0, 200.0)
        at = drag.at(300.0 + across, 200.0 - up, 42.0, 180.0)
        assert abs(at.yaw) <= 180.0
        assert math.hypot(at.pitch, at.roll) <= 42.2
        back = drag.at(300.0, 200.0, 42.0, 180.0)
        assert back == start


# -- the widget -------------------------------------------------------------------------------------


@pytest.fixture
def panel(window: Window, link: RecordingLink, intents: Taken) -> Head3d:
    """The panel in the window; both robots look ahead."""
    link.known = world(*(posed(side, (0, 0, 0), HeadAngles(0, 0, 0)) for side in ("sim", "hw")))
    window.refresh()
    intents()
    return window.panels.head3d


def target(panel: Head3d) -> HeadOrientation:
    return present(panel._view).target


def dragged(panel: Head3d, place: tuple[float, float, float], right: int, down: int) -> None:
    """Drag a point of the head."""
    x, y, _ = on_screen(panel.screen3d, target(panel), place)
    drag(panel, QPoint(round(x), round(y)), QPoint(round(x) + right, round(y) + down))


def test_dragging_the_face_to_the_right_turns_the_nose_to_the_right_of_the_picture(
    panel: Head3d, intents: Taken
) -> None:
    for view, sign in (("front", 1), ("behind", -1)):
        QTest.mouseClick(panel.views[view], LEFT)
        before = target(panel)
        dragged(panel, SKULL, 40, -30)
        assert (target(panel).yaw - before.yaw) * sign > 10
        assert target(panel).pitch < before.pitch - 8  # nose up
        assert target(panel).roll == 0
        assert intents()[-1] == ReleaseHead()
        assert present(panel._view).facing is (view == "front"), "the pad turns with the view"
        QTest.keyClick(panel, Qt.Key.Key_Space)


def test_dragging_an_ear_tilts_the_head(panel: Head3d) -> None:
    dragged(panel, EARS["left"], 0, -40)
    assert target(panel).roll > 10  # right ear down
    dragged(panel, EARS["right"], 0, -40)
    assert abs(target(panel).roll) < 3


def test_dragging_beside_the_head_moves_the_camera(panel: Head3d, intents: Taken) -> None:
    before = panel.camera
    drag(panel, QPoint(30, 200), QPoint(70, 220))
    assert panel.camera != before
    assert intents() == []
    assert not any(button.isChecked() for button in panel.views.values())
    QTest.mouseClick(panel.views["side"], LEFT)
    assert panel.camera == VIEWS["side"]
    assert panel.views["side"].isChecked()


def test_the_pad_turns_with_a_view_that_is_dragged_to_the_other_side(panel: Head3d, intents: Taken) -> None:
    drag(panel, QPoint(30, 200), QPoint(320, 200))
    assert intents() == [Choose("facing", value=False)]
    assert not present(panel._view).facing
    assert panel.camera.azimuth == 215.0, "the view stays where the user dragged it"


def test_live_reports_while_the_mouse_moves_and_only_if_it_was_chosen(panel: Head3d, intents: Taken) -> None:
    dragged(panel, SKULL, 40, 0)
    assert LiveHead() not in intents()
    QTest.mouseClick(panel.live, LEFT, pos=panel.live.rect().center())
    assert intents() == [Choose("live", value=True)]
    dragged(panel, SKULL, 40, 0)
    given = intents()
    assert given.count(LiveHead()) >= 2  # the first, and the last before the release
    assert given[-1] == ReleaseHead()
    x, y, _ = on_screen(panel.screen3d, target(panel), SKULL)
    QTest.mousePress(panel, LEFT, pos=QPoint(round(x), round(y)))
    panel.hide()
    assert intents()[-1] == ReleaseHead(), "a hidden head is not dragged"
    panel.show()


def test_the_checked_robot_is_solid_and_the_other_one_a_ghost(
    window: Window, panel: Head3d, link: RecordingLink, monkeypatch: pytest.MonkeyPatch
) -> None:
    drawn = {name: Mock(return_value=QImage()) for name in ("robot", "ghost")}
    for name, draws in drawn.items():
        monkeypatch.setattr(head3d, name, draws)
    link.known = ready()
    for checked, solid in (("sim",), "sim"), (("hw",), "hw"), (("sim", "hw"), "hw"), ((), "hw"):
        for side in ("sim", "hw"):
            window.handle(Choose(side, value=side in checked))
        panel.grab()
        view = present(panel._view)
        assert drawn["robot"].call_args.args[0] == view.side(solid)
        assert drawn["ghost"].call_args.args[0] == view.side("hw" if solid == "sim" else "sim")


def test_a_gap_in_the_positions_greys_the_head_where_it_was(
    window: Window, panel: Head3d, link: RecordingLink, monkeypatch: pytest.MonkeyPatch
) -> None:
    robot = Mock(return_value=QImage())
    monkeypatch.setattr(head3d, "robot", robot)
    link.known = here = ready()
    window.refresh()
    panel.grab()
    aim, shown = target(panel), present(panel._view).shown
    sim, hw = (replace(here.side(side), positions_age_s=0.6) for side in ("sim", "hw"))
    link.known = replace(here, sim=sim, hw=hw)
    window.refresh()
    panel.grab()
    assert [(call.args[0], call.kwargs["silent"]) for call in robot.mock_calls] == [
        (shown, False),
        (shown, True),
    ]
    assert target(panel) == aim, "it does not jump to the middle"
    link.known = NOWHERE
    window.refresh()
    assert present(panel._view).shown is None
