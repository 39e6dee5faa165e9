"""Each control shows its view and reports its intent, by mouse and by keyboard."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import pytest
from gui_views import TARGET, example
from gui_windows import drag, menu_button, reveal
from PyQt5.QtCore import QPoint, QPointF, QRect, Qt
from PyQt5.QtGui import QColor
from PyQt5.QtTest import QTest
from PyQt5.QtWidgets import QAbstractButton, QAbstractSpinBox, QApplication, QSlider, QWidget
from pytestqt.qtbot import QtBot
from recording_link import ShownState

from beatrix_zenoh.body.scene import EARS, SKULL
from beatrix_zenoh.contract._generated.messages import Command
from beatrix_zenoh.contract.names import SIDES
from gui.console.state.actions import Abort, BeginRecording, EndRecording, SendNow, TakePicture
from gui.console.state.intents import (
    AddPose,
    AimHead,
    Change,
    Choose,
    DeletePose,
    HeadOrientation,
    Intent,
    Jog,
    PlaySequence,
    Repeat,
    RunCommand,
    SendHead,
    Theme,
    Undo,
)
from gui.console.state.views import ButtonView, RecordView
from gui.console.texts import Texts
from gui.window.theme import style_of
from gui.window.widgets.head import HeadPad
from gui.window.widgets.head3d_drag import on_screen
from gui.window.window import Window

Taken = Callable[[], list[Intent]]
LEFT, NO_BUTTON = Qt.MouseButton.LeftButton, Qt.MouseButton.NoButton
BUTTONS: dict[str, tuple[Callable[[Window], QAbstractButton], Intent]] = {
    **{
        f"{sign:+d} {arm}": (lambda window, arm=arm, sign=sign: jog(window, arm, sign), Jog(arm, sign))  # type: ignore[misc]
        for arm in ("short", "middle", "long", "all")
        for sign in (-1, 1)
    },
    "send": (lambda window: window.panels.sending.send, SendHead()),
    "relative": (lambda window: window.panels.arms.relative, Choose("relative", value=True)),
    "absolute": (lambda window: window.panels.arms.absolute, Choose("relative", value=False)),
    "simulation": (lambda window: window.panels.sending.sim, Choose("sim", value=False)),
    "hardware": (lambda window: window.panels.sending.hw, Choose("hw", value=False)),
    "cameras": (lambda window: window.panels.eyes.cameras, Choose("cameras", value=False)),
    "send now": (lambda window: window.panels.sending.send_now, SendNow()),
    "change": (lambda window: window.panels.sending.change, Change()),
    "abort": (lambda window: window.panels.sending.abort, Abort()),
    "calibrate": (
        lambda window: menu_button(window, "hw", "Calibrate"),
        RunCommand(Command.CALIBRATE, side="hw"),
    ),
    "home": (lambda window: window.panels.commands.buttons["home"], RunCommand(Command.HOME)),
    "reset": (
        lambda window: menu_button(window, "sim", "Clear emergency stop"),
        RunCommand(Command.RESET, side="sim"),
    ),
    "undo": (lambda window: window.panels.commands.buttons["undo"], Undo()),
    "record": (lambda window: window.panels.header.record.toggle, BeginRecording()),
    "photo": (
        lambda window: window.panels.show_buttons.photo,
        TakePicture(False, SIDES, ("Simulation", "Hardware"), "ben · bea1"),
    ),
    "add": (lambda window: window.panels.sequence.add, AddPose()),
    "delete": (lambda window: window.panels.sequence.delete, DeletePose("nod")),
    "play": (lambda window: window.panels.sequence.play, PlaySequence("sim")),
}


def jog(window: Window, arm: str, sign: int) -> QAbstractButton:
    row = window.panels.arms.rows[arm]
    return row.plus if sign > 0 else row.minus


@pytest.fixture
def state() -> ShownState:
    """A state in which a motion waits for its lead, so that every button is enabled."""
    return ShownState(example("preview", Theme.LIGHT, "en"))


@pytest.mark.qt_log_ignore("This plugin does not support")  # popups without a display
def test_each_button_reports_its_intent(qtbot: QtBot, window: Window, intents: Taken) -> None:
    for name, (find, intent) in BUTTONS.items():
        button = find(window)
        reveal(button)
        intents()
        assert button.isEnabled(), name
        QTest.mouseClick(button, LEFT, pos=button.rect().center())
        assert intents() == [intent], name
        reveal(button)
        QApplication.setActiveWindow(button.window())
        button.setFocus()
        qtbot.waitUntil(button.hasFocus)
        QTest.keyClick(button, Qt.Key.Key_Return)
        assert intents() == [intent], name


def test_every_control_has_a_tooltip_and_a_name(window: Window) -> None:
    """Disabled controls have a tooltip and an accessible name, too."""
    kinds = (QAbstractButton, QSlider)
    controls = [widget for widget in window.findChildren(QWidget) if isinstance(widget, kinds)]
    controls = [
        widget for widget in controls if not type(widget).__module__.startswith("PyQt5.QtWidgets.QTab")
    ]
    mute = [
        (type(widget).__name__, widget.objectName(), widget.accessibleName())
        for widget in controls
        if not (widget.toolTip() and widget.accessibleName())
        and not (isinstance(widget, QAbstractButton) and not widget.text())
    ]
    assert len(controls) > 30
    assert mute == []


def test_a_slider_and_its_box_report_the_same_intent(window: Window, intents: Taken) -> None:
    for name in ("increment", "speed"):
        control = getattr(window.panels.arms, name)
        before = control.box.value()
        QTest.keyClick(control.slider, Qt.Key.Key_Right)
        assert intents() == [Choose(name, before + 1)]
        control.box.setFocus()
        control.box.selectAll()
        QTest.keyClicks(control.box, "12.5")
        assert intents() == []
        QTest.keyClick(control.box, Qt.Key.Key_Return)
        assert intents() == [Choose(name, 12.5)]


def test_a_row_of_the_history_is_sent_again(window: Window, intents: Taken) -> None:
    history = window.panels.history
    assert not history.repeat.isEnabled()
    assert history.details.text() == "Select a request to send it again."
    history.list.setFocus()
    history.list.setCurrentRow(1)
    row = example("preview", Theme.LIGHT, "en").history[1]
    QTest.mouseClick(history.repeat, LEFT)
    assert intents() == [Repeat(row.row)]


DRAGS = {"nose down": (0, 1), "nose up": (0, -1), "right ear down": (1, 0), "left ear down": (-1, 0)}
"""Directions of a drag to the right and down, by what the head does."""


@pytest.mark.parametrize("facing", [True, False])
def test_dragging_the_disc_or_the_ring_changes_its_angles_only(
    window: Window, state: ShownState, intents: Taken, *, facing: bool
) -> None:
    pad = window.panels.head.pad
    state.shown = replace(state.shown, head=replace(state.shown.head, facing=facing))
    window.refresh()
    middle = QPointF(pad.width() / 2, pad.height() / 2)
    for name, (right, down) in DRAGS.items():
        across = -40 * right if facing else 40 * right  # who faces a robot sees its right ear at the left
        drag(pad, middle.toPoint(), (middle + QPointF(across, 40 * down)).toPoint())
        aim = [intent for intent in intents() if isinstance(intent, AimHead)][-1]
        assert (round(aim.roll, -1) > 0) - (aim.roll < -5) == right, name
        assert (round(aim.pitch, -1) > 0) - (aim.pitch < -5) == down, name
        assert aim.yaw == 20.0, "the ring stays where it was"
    assert (pad.yaw_point(40.0).x() > middle.x()) is facing
    for yaw in (-170.0, -90.0, 0.0, 45.0, 120.0):
        drag(pad, pad.yaw_point(10.0).toPoint(), pad.yaw_point(yaw).toPoint())
        aim = [intent for intent in intents() if isinstance(intent, AimHead)][-1]
        assert aim.yaw == pytest.approx(yaw, abs=1.5)
        assert (aim.pitch, aim.roll) == TARGET[1:], "the disc stays where it was"


SIM, HW = HeadOrientation(-60.0, -15.0, 15.0), HeadOrientation(60.0, 15.0, -15.0)
DOTS = (HeadOrientation(90.0, 0.0, 20.0), HeadOrientation(120.0, 0.0, 25.0))


@pytest.mark.parametrize("theme", Theme)
def test_on_the_pad_the_simulation_is_a_cross_the_hardware_a_square_and_the_path_dots(
    qtbot: QtBot, theme: Theme
) -> None:
    pad = HeadPad(Texts("en"))
    qtbot.addWidget(pad)
    pad.resize(400, 400)
    pad.show_theme(theme)
    shown = example("ready", theme, "en").head
    pad.show_view(replace(shown, target=HeadOrientation(0.0, 0.0, 0.0), sim=SIM, hw=HW, path=DOTS))
    picture, style = pad.grab().toImage(), style_of(theme)

    def shows(at: QPointF, colour: str) -> bool:
        seen, wanted = QColor(picture.pixel(int(at.x()), int(at.y()))), QColor(colour)
        return all(abs(a - b) < 30 for a, b in zip(seen.getRgb()[:3], wanted.getRgb()[:3], strict=True))

    for centre in (pad.tilt_point(SIM, shown.tilt_max), pad.yaw_point(SIM.yaw)):
        assert shows(centre + QPointF(8, 0), style.sim)
        assert shows(centre + QPointF(0, 8), style.sim)
        assert not shows(centre + QPointF(6, 6), style.sim), "a cross has no corners"
    for centre in (pad.tilt_point(HW, shown.tilt_max), pad.yaw_point(HW.yaw)):
        for corner in (QPointF(6, 6), QPointF(-6, 6), QPointF(6, -6), QPointF(-6, -6)):
            assert shows(centre + corner, style.hw)
    for at in DOTS:
        for centre in (pad.tilt_point(at, shown.tilt_max), pad.yaw_point(at.yaw)):
            assert shows(centre, style.dim)
            assert not shows(centre + QPointF(5, 5), style.dim)


def test_record_stays_where_it_was_pressed(window: Window, state: ShownState) -> None:
    """The second press in the same place ends the recording, and no button of the pills moves meanwhile."""
    state.shown = example("well", Theme.LIGHT, "en")
    window.refresh()
    header = window.panels.header
    watched = (header.record.toggle, header.pills["sim"].lease, header.pills["hw"].lease)
    QApplication.processEvents()
    before = [widget.geometry() for widget in watched]
    toggle = ButtonView("End recording", "End the recording", EndRecording())
    state.shown = replace(state.shown, record=RecordView(toggle, "12:34"))
    window.refresh()
    QApplication.processEvents()
    assert header.record.toggle.text() == "■ 12:34"
    assert header.record.toggle.accessibleName() == "End recording"
    assert [widget.geometry() for widget in watched] == before


@pytest.mark.parametrize("size", [(1366, 768), (1024, 560)])
def test_a_refusal_covers_neither_a_control_nor_a_head(
    window: Window, state: ShownState, size: tuple[int, int]
) -> None:
    window.resize(*size)
    view, panels = example("refusal", Theme.LIGHT, "en"), window.panels
    assert view.head.refusal is not None
    kinds = (QAbstractButton, QAbstractSpinBox, QSlider, HeadPad)
    state.shown = view
    window.refresh()
    notice = QRect(panels.refusal.mapTo(panels, QPoint(0, 0)), panels.refusal.size())
    for other in (found for kind in kinds for found in panels.findChildren(kind)):
        if other.isVisible() and not panels.refusal.isAncestorOf(other):
            place = QRect(other.mapTo(panels, QPoint(0, 0)), other.size())
            assert not notice.intersects(place), other.accessibleName()
    head = panels.head3d
    for robot in filter(None, (view.head.sim, view.head.hw)):
        for point in (SKULL, *EARS.values()):
            x, y, _ = on_screen(head.screen3d, robot, point)
            assert not notice.contains(head.mapTo(panels, QPoint(round(x), round(y))))
