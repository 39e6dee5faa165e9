"""The head in three dimensions: where it is drawn, what the mouse grabs, and where a drag turns it."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import replace

import pytest
from gui_views import posed, ready
from gui_worlds import NOWHERE, world
from hypothesis import given
from hypothesis import strategies as st
from PyQt5.QtCore import QEvent, QPointF, Qt
from PyQt5.QtGui import QMouseEvent
from PyQt5.QtTest import QTest
from PyQt5.QtWidgets import QApplication
from pytestqt.qtbot import QtBot

from beatrix_zenoh.body.scene import Screen, Viewpoint
from beatrix_zenoh.client.degrees import HeadAngles
from gui.console.state import intents
from gui.console.state.intents import AimHead, Choose, HeadOrientation, Intent, LiveHead, ReleaseHead
from gui.console.state.state import State
from gui.console.state.world import World
from gui.console.texts import Texts
from gui.window.widgets.head3d import VIEWS, Head3dPanel
from gui.window.widgets.head3d_drag import (
    EARS,
    NOSE,
    SKULL,
    Drag,
    Part,
    grabbed,
    on_screen,
)

UPRIGHT = HeadOrientation(0.0, 0.0, 0.0)
angles = st.floats(-30.0, 30.0)
cameras = st.builds(Viewpoint, st.floats(0.0, 360.0), st.floats(-10.0, 80.0), st.floats(0.6, 3.0))
LEFT, RIGHT = Qt.MouseButton.LeftButton, Qt.MouseButton.RightButton


def screen(name: str) -> Screen:
    return Screen(VIEWS[name], 600.0, 450.0)


# -- geometry ---------------------------------------------------------------------------------------


@pytest.mark.parametrize(("name", "sign"), [("behind", -1), ("front", 1)])
def test_from_behind_the_left_ear_is_at_the_left(name: str, sign: int) -> None:
    ears = {side: on_screen(screen(name), UPRIGHT, place) for side, place in EARS.items()}
    assert (ears["left"][0] - ears["right"][0]) * sign > 50


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
        drag = Drag.begin(screen("front"), start, part, 300.0, 200.0)
        at = drag.at(300.0 + across, 200.0 - up, 42.0, 180.0)
        assert abs(at.yaw) <= 180.0
        assert math.hypot(at.pitch, at.roll) <= 42.2
        back = drag.at(300.0, 200.0, 42.0, 180.0)
        assert back == start


@pytest.mark.parametrize("name", ["front", "behind"])
@given(across=st.floats(5, 60), up=st.floats(5, 60))
def test_the_nose_follows_the_mouse(name: str, across: float, up: float) -> None:
    seen = screen(name)
    before = on_screen(seen, UPRIGHT, NOSE)
    at = Drag.begin(seen, UPRIGHT, Part.FACE, 300.0, 200.0).at(300.0 + across, 200.0 - up, 42.0, 180.0)
    after = on_screen(seen, at, NOSE)
    assert after[0] > before[0]
    assert after[1] < before[1]


# -- the widget -------------------------------------------------------------------------------------


class Shown:
    """A panel with the real state, and the intents that it has reported."""

    def __init__(self, qtbot: QtBot, now: World) -> None:
        self.state, self.now, self.intents = State(), now, list[Intent]()
        self.panel = Head3dPanel(Texts("en"))
        qtbot.addWidget(self.panel)
        self.panel.intent.connect(self.handle)
        self.panel.resize(640, 480)
        self.show()
        self.panel.show()
        QApplication.processEvents()

    def handle(self, intent: Intent) -> None:
        self.intents.append(intent)
        self.state.handle(intent, self.now)
        self.show()

    def show(self) -> None:
        self.panel.show_view(self.state.view(self.now).head)

    @property
    def target(self) -> HeadOrientation:
        return self.state.view(self.now).head.target

    def mouse(self, kind: QEvent.Type, at: QPointF, button: Qt.MouseButton = LEFT) -> None:
        event = QMouseEvent(kind, at, button, Qt.MouseButtons(button), Qt.KeyboardModifier.NoModifier)
        QApplication.sendEvent(self.panel.head, event)

    def drag(self, place: tuple[float, float, float], right: float, down: float) -> None:
        at = on_screen(self.panel.head.screen3d, self.target, place)
        start = QPointF(at[0], at[1])
        self.mouse(QEvent.Type.MouseButtonPress, start)
        self.mouse(QEvent.Type.MouseMove, start + QPointF(right, down) / 2)
        self.mouse(QEvent.Type.MouseMove, start + QPointF(right, down))
        self.mouse(QEvent.Type.MouseButtonRelease, start + QPointF(right, down))


@pytest.fixture
def shown(qtbot: QtBot) -> Iterator[Callable[..., Shown]]:
    kept = []  # widgets must live until Qt has drawn them for the last time

    def made(now: World | None = None) -> Shown:
        upright = HeadAngles(0, 0, 0)
        home = world(posed("sim", (0, 0, 0), upright), posed("hw", (0, 0, 0), upright))
        kept.append(Shown(qtbot, now or home))
        return kept[-1]

    yield made
    for window in kept:
        window.panel.close()


@pytest.mark.parametrize(("view", "sign"), [("front", 1), ("behind", -1)])
def test_dragging_the_face_to_the_right_turns_the_nose_to_the_right_of_the_picture(
    shown: Callable[..., Shown], view: str, sign: int
) -> None:
    window = shown()
    QTest.mouseClick(window.panel.views[view], LEFT)
    window.drag(SKULL, 40, -30)
    last = [intent for intent in window.intents if isinstance(intent, AimHead)][-1]
    assert last.yaw * sign > 10
    assert last.pitch < -8  # nose up
    assert last.roll == 0
    assert window.intents[-1] == ReleaseHead()


def test_dragging_an_ear_tilts_the_head(shown: Callable[..., Shown]) -> None:
    window = shown()
    window.drag(EARS["left"], 0, -40)
    assert window.target.roll > 10  # right ear down
    window.drag(EARS["right"], 0, -40)
    assert abs(window.target.roll) < 3


def test_dragging_beside_the_head_or_with_the_right_button_moves_the_camera(
    shown: Callable[..., Shown],
) -> None:
    window = shown()
    head = window.panel.head
    for button, start in ((LEFT, QPointF(30, 300)), (RIGHT, QPointF(320, 150))):
        before = head.camera
        window.mouse(QEvent.Type.MouseButtonPress, start, button)
        window.mouse(QEvent.Type.MouseMove, start + QPointF(40, 20), button)
        window.mouse(QEvent.Type.MouseButtonRelease, start + QPointF(40, 20), button)
        assert head.camera != before
    assert not window.intents
    assert not any(button.isChecked() for button in window.panel.views.values())
    QTest.mouseClick(window.panel.views["side"], LEFT)
    assert head.camera == VIEWS["side"]
    assert window.panel.views["side"].isChecked()


def test_live_reports_while_the_mouse_moves_and_only_if_it_was_chosen(shown: Callable[..., Shown]) -> None:
    window = shown()
    window.drag(SKULL, 40, 0)
    assert LiveHead() not in window.intents
    QTest.mouseClick(window.panel.live, LEFT, pos=window.panel.live.rect().center())
    assert Choose("live", value=True) in window.intents
    window.intents.clear()
    window.drag(SKULL, 40, 0)
    assert window.intents.count(LiveHead()) >= 2  # the first, and the last before the release
    assert window.intents[-1] == ReleaseHead()


def test_a_hidden_head_reports_no_more_live_targets(shown: Callable[..., Shown]) -> None:
    window = shown()
    window.handle(Choose("live", value=True))
    at = on_screen(window.panel.head.screen3d, window.target, SKULL)
    window.mouse(QEvent.Type.MouseButtonPress, QPointF(at[0], at[1]))
    window.mouse(QEvent.Type.MouseMove, QPointF(at[0] + 20, at[1]))
    window.panel.hide()
    assert window.intents[-1] == ReleaseHead()
    window.intents.clear()
    QTest.qWait(120)
    assert not window.intents


@pytest.mark.parametrize(
    ("checked", "solid"), [(("sim",), "sim"), (("hw",), "hw"), (("sim", "hw"), "hw"), ((), "hw")]
)
def test_the_checked_robot_is_solid_and_the_other_one_a_ghost(
    shown: Callable[..., Shown], monkeypatch: pytest.MonkeyPatch, checked: tuple[str, ...], solid: str
) -> None:
    drawn = dict[str, object]()
    for name in ("paint_robot", "paint_ghost"):
        place = f"gui.window.widgets.head3d.{name}"
        monkeypatch.setattr(place, lambda _image, head, *_, name=name, **__: drawn.update({name: head}))
    window = shown(ready())
    for side in ("sim", "hw"):
        window.handle(intents.Choose(side, value=side in checked))
    window.panel.grab()
    heads = {side: getattr(window.state.view(window.now).head, side) for side in ("sim", "hw")}
    assert drawn == {"paint_robot": heads.pop(solid), "paint_ghost": heads.popitem()[1]}


def test_a_gap_in_the_positions_greys_the_head_where_it_was(
    shown: Callable[..., Shown], monkeypatch: pytest.MonkeyPatch
) -> None:
    drawn = list[tuple[object, bool]]()
    place = "gui.window.widgets.head3d.paint_robot"
    monkeypatch.setattr(place, lambda _, head, *__, grey: drawn.append((head, grey)))
    window = shown(ready())
    window.panel.grab()
    here = window.state.view(window.now).head
    for side in ("sim", "hw"):
        gap = replace(getattr(window.now, side), positions_age_s=0.6)
        window.now = replace(window.now, **{side: gap})
    window.show()
    window.panel.grab()
    assert drawn == [(here.shown, False), (here.shown, True)]
    assert window.target == here.target, "it does not jump to the middle"
    assert window.panel.views["front"].isVisible()
    window.now = NOWHERE
    window.show()
    assert window.state.view(window.now).head.shown is None
