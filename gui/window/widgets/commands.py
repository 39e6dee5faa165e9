"""Requests to the checked robots: destinations and lead, commands, and STOP of all."""

from __future__ import annotations

from PyQt5.QtCore import Qt, pyqtSignal
from PyQt5.QtWidgets import (
    QFrame,
    QGridLayout,
    QHBoxLayout,
    QProgressBar,
    QPushButton,
    QSizePolicy,
    QVBoxLayout,
)

from gui.console.state.intents import SetCameras, SetDestination, SetLead
from gui.console.state.views import CommandsView, SendingView, View
from gui.console.texts import Texts
from gui.window.widgets.controls import Check, IntentButton, label, set_role, set_text
from gui.window.widgets.number_box import NumberBox

LEAD_MAX_S = 60.0
LINES = 4
"""Lines reserved for the text about the motion."""
NAMES = ("enable", "disable", "calibrate", "home", "reset", "undo")
COLUMNS = 2


class SendingPanel(QFrame):
    """Destinations, lead and the present motion."""

    intent = pyqtSignal(object)

    def __init__(self, texts: Texts) -> None:
        super().__init__()
        self._texts = texts
        self._view: SendingView | None = None
        self.setProperty("panel", True)  # noqa: FBT003
        self.setAccessibleName(texts("label.send_to"))
        self.heading = label(texts("label.send_to"), "title")
        self.sim = Check(texts("label.sim"), texts("tip.sim"))
        self.hw = Check(texts("label.hw"), texts("tip.hw"))
        self.cameras = Check(texts("label.cameras"), texts("tip.cameras"))
        self.lead_name = label(texts("label.lead"))
        self.lead = NumberBox(texts, texts("label.lead_unit"), 0.0)
        self.lead.setMaximum(LEAD_MAX_S)
        self.lead.setSingleStep(0.5)
        self.lead.setAccessibleName(f"{texts('label.lead')} (s)")
        self.title, self.text = label(role="large"), label(wrap=True)
        self.countdown = label(role="hw")
        self.progress = QProgressBar()
        self.progress.setTextVisible(False)
        self.progress.setRange(0, 1000)
        self.send_now, self.change, self.abort = IntentButton(main=True), IntentButton(), IntentButton()
        self._lay_out()
        self._connect()

    def _lay_out(self) -> None:
        top = QGridLayout()
        top.setVerticalSpacing(2)
        top.addWidget(self.heading, 0, 0, 1, 3)
        top.addWidget(self.sim, 1, 0)
        top.addWidget(self.hw, 1, 1, 1, 2)
        top.addWidget(self.cameras, 2, 0)
        top.addWidget(self.lead_name, 2, 1)
        top.addWidget(self.lead, 2, 2)
        top.setColumnStretch(0, 1)
        buttons = QGridLayout()
        buttons.setSpacing(4)
        buttons.addWidget(self.send_now, 0, 0, 1, 2)
        buttons.addWidget(self.change, 1, 0)
        buttons.addWidget(self.abort, 1, 1)
        self.text.setAlignment(Qt.AlignmentFlag.AlignTop)
        self.text.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Preferred)  # it wraps
        layout = QVBoxLayout(self)
        layout.setContentsMargins(5, 4, 5, 5)
        layout.setSpacing(4)
        layout.addLayout(top)
        layout.addWidget(self.title)
        layout.addWidget(self.text, 1)
        layout.addWidget(self.countdown)
        layout.addWidget(self.progress)
        layout.addLayout(buttons)

    def _connect(self) -> None:
        self.sim.asked.connect(lambda checked: self.intent.emit(SetDestination("sim", checked)))
        self.hw.asked.connect(lambda checked: self.intent.emit(SetDestination("hw", checked)))
        self.cameras.asked.connect(lambda on: self.intent.emit(SetCameras(on)))
        self.lead.valueChanged.connect(lambda seconds: self.intent.emit(SetLead(seconds)))
        for button in (self.send_now, self.change, self.abort):
            button.intent.connect(self.intent)

    def show_compact(self, *, compact: bool) -> None:
        """Hide the heading in a low window; reserve room in a high one, so that buttons do not move."""
        self.heading.setVisible(not compact)
        for part in (self.countdown, self.progress):
            policy = part.sizePolicy()
            policy.setRetainSizeWhenHidden(not compact)
            part.setSizePolicy(policy)
        self.text.setMinimumHeight(0 if compact else LINES * self.text.fontMetrics().lineSpacing())

    def show_view(self, view: SendingView) -> None:
        """Show destinations and the present motion."""
        if view == self._view:
            return
        self._view = view
        self.sim.setChecked(view.sim)
        self.hw.setChecked(view.hw)
        self.cameras.setChecked(view.cameras)
        self.lead.blockSignals(True)  # noqa: FBT003
        if self.lead.value() != view.lead_s:
            self.lead.setValue(view.lead_s)
        self.lead.blockSignals(False)  # noqa: FBT003
        self.lead.setToolTip(self._texts("tip.lead" if view.lead_matters else "tip.lead_one"))
        set_role(self.lead_name, "role", "" if view.lead_matters else "dim")
        set_text(self.title, view.title)
        set_text(self.text, view.text)
        set_text(self.countdown, view.countdown)
        self.countdown.setVisible(bool(view.countdown))
        self.progress.setVisible(view.progress is not None)
        self.progress.setValue(round(1000 * (view.progress or 0.0)))
        self.send_now.show_view(view.send_now)
        self.change.show_view(view.change)
        self.abort.show_view(view.abort)


class CommandsPanel(QFrame):
    """A button for each command; Disable needs a second press if the hardware is checked, because its head sinks."""

    intent = pyqtSignal(object)
    asking = pyqtSignal(str)

    def __init__(self, texts: Texts) -> None:
        super().__init__()
        self._view: CommandsView | None = None
        self.setProperty("panel", True)  # noqa: FBT003
        self.setAccessibleName(texts("label.commands"))
        self.buttons = {name: IntentButton() for name in NAMES}
        layout = QGridLayout(self)
        layout.setContentsMargins(5, 5, 5, 5)
        layout.setSpacing(4)
        for number, button in enumerate(self.buttons.values()):
            layout.addWidget(button, *divmod(number, COLUMNS))
            button.intent.connect(self.intent)
            button.asking.connect(self.asking)

    def show_view(self, view: CommandsView) -> None:
        """Show the buttons and which of them are enabled."""
        if view == self._view:
            return
        self._view = view
        shown = (view.enable, view.disable, view.calibrate, view.home, view.reset, view.undo)
        for button, button_view in zip(self.buttons.values(), shown, strict=True):
            button.show_view(button_view)


class StopBar(QPushButton):
    """Reports STOP when it is pressed, not when it is released."""

    intent = pyqtSignal(object)

    def __init__(self, texts: Texts) -> None:
        super().__init__()
        self._view: View | None = None
        self._last = self._question = ""
        self.emergency = IntentButton()
        """within this button, so that a press beside it is STOP"""
        self.emergency.setObjectName("emergency")
        self.emergency.intent.connect(self.intent)
        self.emergency.asking.connect(self._ask)
        self.setObjectName("stop")
        self.setAutoDefault(False)
        self.word, self.last = label(role="stop_word"), label(role="stop", wrap=True)
        self.keys = label(texts("label.keys_stop").partition(": ")[0], "stop")
        self.last.setAlignment(Qt.AlignmentFlag.AlignVCenter | Qt.AlignmentFlag.AlignRight)
        self.last.setMinimumWidth(1)
        layout = QHBoxLayout(self)
        layout.setContentsMargins(20, 2, 16, 2)
        layout.addWidget(self.word)
        layout.addSpacing(12)
        layout.addWidget(self.keys)
        layout.addWidget(self.last, 1)
        layout.addSpacing(12)
        layout.addWidget(self.emergency)
        for part in (self.word, self.keys, self.last):
            part.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
        self.pressed.connect(self.stop)

    def show_last(self, text: str) -> None:
        """Show the last request with its outcome, unless EMERGENCY_STOP asks its question there."""
        self._last = text
        set_text(self.last, f"▲ {self._question}" if self._question else text)

    def _ask(self, question: str) -> None:
        self._question = question
        self.show_last(self._last)

    def show_view(self, view: View) -> None:
        """Show the texts of both buttons."""
        stop, self._view = view.stop, view
        self.emergency.show_view(view.emergency)
        set_text(self.word, stop.text)
        self.setToolTip(stop.tooltip)
        self.setAccessibleName(stop.text)
        self.setAccessibleDescription(stop.tooltip)

    def stop(self) -> None:
        """Report the intent."""
        if self._view is not None:
            self.intent.emit(self._view.stop.intent)
