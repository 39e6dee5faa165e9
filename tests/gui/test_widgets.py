"""Each control shows its view and reports its intent, by mouse and by keyboard."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import pytest
from gui_views import TARGET, example
from gui_windows import menu_button, reveal
from present import present
from PyQt5.QtCore import QEvent, QPoint, QPointF, QRect, Qt
from PyQt5.QtGui import QGuiApplication, QMouseEvent
from PyQt5.QtTest import QTest
from PyQt5.QtWidgets import (
    QAbstractButton,
    QAbstractSpinBox,
    QApplication,
    QSlider,
    QWidget,
)
from pytestqt.qtbot import QtBot
from recording_link import RecordingLink, ShownState

from beatrix_zenoh.contract._generated.messages import Command
from gui.console.state.actions import Abort, BeginRecording, EndRecording, SendNow
from gui.console.state.intents import (
    AddPose,
    AimHead,
    Change,
    Choose,
    DeletePose,
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
from gui.window.widgets.head3d_drag import EARS, SKULL, on_screen
from gui.window.widgets.head_pad import HeadPad
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
    "add": (lambda window: window.panels.sequence.add, AddPose()),
    "delete": (lambda window: window.panels.sequence.delete, DeletePose("nod")),
    "play": (lambda window: window.panels.sequence.play, PlaySequence("sim")),
}


def jog(window: Window, arm: str, sign: int) -> QAbstractButton:
    row = window.panels.arms.rows[arm]
    return row.plus if sign > 0 else row.minus


@pytest.fixture
def shown() -> ShownState:
    """A state in which a motion waits for its lead, so that every button is enabled."""
    return ShownState(example("preview", Theme.LIGHT, "en"))


@pytest.fixture
def window(qtbot: QtBot, shown: ShownState) -> Window:
    window = Window(RecordingLink(), shown)
    qtbot.addWidget(window)
    window.resize(1366, 768)
    window.show()
    qtbot.waitActive(window)
    return window


@pytest.fixture
def intents(window: Window, shown: ShownState) -> Taken:
    def taken() -> list[Intent]:
        given = shown.intents.copy()
        shown.intents.clear()
        return given

    return taken


@pytest.mark.qt_log_ignore("This plugin does not support")  # popups without a display
@pytest.mark.parametrize("name", BUTTONS)
def test_each_button_reports_its_intent(qtbot: QtBot, window: Window, intents: Taken, name: str) -> None:
    find, intent = BUTTONS[name]
    button = find(window)
    reveal(button)
    intents()
    assert button.isEnabled()
    assert button.toolTip()
    assert button.accessibleName()
    QTest.mouseClick(button, LEFT, pos=button.rect().center())
    assert intents() == [intent]
    reveal(button)
    button.setFocus()
    qtbot.waitUntil(button.hasFocus)
    QTest.keyClick(button, Qt.Key.Key_Return)
    assert intents() == [intent]


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


@pytest.mark.parametrize("name", ["increment", "speed"])
def test_a_slider_and_its_box_report_the_same_intent(window: Window, intents: Taken, name: str) -> None:
    control = getattr(window.panels.arms, name)
    before = control.box.value()
    control.slider.setFocus()
    QTest.keyClick(control.slider, Qt.Key.Key_Right)
    assert intents() == [Choose(name, before + 1)]
    control.box.setFocus()
    control.box.selectAll()
    QTest.keyClicks(control.box, "12.5")
    assert intents() == []
    QTest.keyClick(control.box, Qt.Key.Key_Return)
    assert intents() == [Choose(name, 12.5)]


def test_a_row_of_the_history_is_sent_again_and_copied(window: Window, intents: Taken) -> None:
    history = window.panels.history
    assert not history.repeat.isEnabled()
    assert history.details.text() == "Select a request to send it again or to copy it."
    history.list.setFocus()
    history.list.setCurrentRow(1)
    row = example("preview", Theme.LIGHT, "en").history[1]
    QTest.mouseClick(history.repeat, LEFT)
    assert intents() == [Repeat(row.row)]
    clipboard = present(QGuiApplication.clipboard())
    assert row.program
    QTest.mouseClick(history.python, LEFT)
    assert clipboard.text() == row.program


def drag(pad: HeadPad, start: QPointF, end: QPointF) -> None:
    QTest.mousePress(pad, LEFT, pos=start.toPoint())
    held = QMouseEvent(QEvent.Type.MouseMove, end, NO_BUTTON, LEFT, Qt.KeyboardModifier.NoModifier)
    QApplication.sendEvent(pad, held)  # not by QTest, which moves the mouse without a pressed button
    QTest.mouseRelease(pad, LEFT, pos=end.toPoint())


DRAGS: dict[str, tuple[QPointF, Callable[[AimHead], bool]]] = {
    "down is nose down": (QPointF(0, 40), lambda aim: aim.pitch > 5 and abs(aim.roll) < 1),
    "up is nose up": (QPointF(0, -40), lambda aim: aim.pitch < -5 and abs(aim.roll) < 1),
    "right is right ear down": (QPointF(40, 0), lambda aim: aim.roll > 5 and abs(aim.pitch) < 1),
    "left is left ear down": (QPointF(-40, 0), lambda aim: aim.roll < -5 and abs(aim.pitch) < 1),
}


def test_dragging_the_disc_or_the_ring_changes_its_angles_only(window: Window, intents: Taken) -> None:
    pad = window.panels.head.pad
    middle = QPointF(pad.width() / 2, pad.height() / 2)
    for name, (offset, right) in DRAGS.items():
        drag(pad, middle, middle + offset)
        aim = [intent for intent in intents() if isinstance(intent, AimHead)][-1]
        assert right(aim), name
        assert aim.yaw == 20.0, "the ring stays where it was"
    for yaw in (-170.0, -90.0, 0.0, 45.0, 120.0):
        drag(pad, pad.yaw_point(10.0), pad.yaw_point(yaw))
        aim = [intent for intent in intents() if isinstance(intent, AimHead)][-1]
        assert aim.yaw == pytest.approx(yaw, abs=1.5)
        assert (aim.pitch, aim.roll) == TARGET[1:], "the disc stays where it was"


@pytest.mark.parametrize("theme", Theme)
def test_record_stays_where_it_was_pressed(window: Window, shown: ShownState, theme: Theme) -> None:
    """The second press in the same place ends the recording, and no button of the pills moves meanwhile."""
    shown.shown = example("well", theme, "en")
    window.refresh()
    header = window.panels.header
    watched = (header.record.toggle, header.pills["sim"].lease, header.pills["hw"].lease)
    QApplication.processEvents()
    before = [widget.geometry() for widget in watched]
    toggle = ButtonView("End recording", "End the recording", EndRecording())
    shown.shown = replace(shown.shown, record=RecordView(toggle, running=True, text="12:34", open=None))
    window.refresh()
    QApplication.processEvents()
    assert header.record.toggle.text() == "■ 12:34"
    assert header.record.toggle.accessibleName() == "End recording"
    assert [widget.geometry() for widget in watched] == before


def test_the_buttons_of_a_pill_name_its_robot_for_screen_readers(window: Window) -> None:
    pills = window.panels.header.pills.values()
    shown = [button for pill in pills for button in (pill.more, pill.next_step, pill.lease)]
    names = [button.accessibleName() for button in shown if not button.isHidden()]
    assert len(names) > 2
    assert all(name.startswith(("Simulation: ", "Hardware: ")) for name in names), names


@pytest.mark.parametrize("size", [(1366, 768), (1024, 560)])
def test_a_refusal_covers_neither_a_control_nor_a_head(
    window: Window, shown: ShownState, size: tuple[int, int]
) -> None:
    window.resize(*size)
    view, panels = example("refusal", Theme.LIGHT, "en"), window.panels
    assert view.head.refusal is not None
    kinds = (QAbstractButton, QAbstractSpinBox, QSlider, HeadPad)
    for control in ("head", "short", "commands", "gestures"):
        refused = replace(view.head, refusal=replace(view.head.refusal, control=control))
        shown.shown = replace(view, head=refused)
        window.refresh()
        notice = QRect(panels.refusal.mapTo(panels, QPoint(0, 0)), panels.refusal.size())
        for other in (found for kind in kinds for found in panels.findChildren(kind)):
            if other.isVisible() and not panels.refusal.isAncestorOf(other):
                place = QRect(other.mapTo(panels, QPoint(0, 0)), other.size())
                assert not notice.intersects(place), (control, other.accessibleName())
        head = panels.head3d.head
        for robot in filter(None, (view.head.sim, view.head.hw)):
            for point in (SKULL, *EARS.values()):
                x, y, _ = on_screen(head.screen3d, robot, point)
                assert not notice.contains(head.mapTo(panels, QPoint(round(x), round(y)))), control
