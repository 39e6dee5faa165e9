"""What the user asks of the robots: below the pad the motion and where it goes, the commands of every day, and STOP."""

from __future__ import annotations

from PyQt5.QtCore import QSignalBlocker, Qt, pyqtSignal
from PyQt5.QtWidgets import QBoxLayout, QLayout, QProgressBar, QPushButton, QSizePolicy, QWidget

from gui.console.state.commands import DAILY
from gui.console.state.intents import Choose, WindowPage
from gui.console.state.views import CommandsView, View
from gui.console.texts import Texts
from gui.window.widgets.controls import (
    NO_MARGINS,
    ChoiceCheck,
    IntentButton,
    Panel,
    in_column,
    in_row,
    label,
    named,
    set_role,
)
from gui.window.widgets.number_box import NumberBox

LEAD_MAX_S = 60.0
LINES = 2
"""Lines reserved for the text about the motion."""


class SendingPanel(Panel):
    """Destinations, lead, Send, and the present motion."""

    def __init__(self, texts: Texts) -> None:
        super().__init__("panel")
        self._texts = texts
        self.setAccessibleName(texts("label.send_to"))
        self.sim, self.hw = ChoiceCheck(texts, "sim"), ChoiceCheck(texts, "hw")
        self.lead_name = label(texts("label.lead"))
        self.lead = NumberBox(texts, texts("label.lead_unit"), 0.0)
        self.lead.setMaximum(LEAD_MAX_S)
        self.lead.setSingleStep(0.5)
        self.lead.setAccessibleName(f"{texts('label.lead')} (s)")
        self.lead.valueChanged.connect(lambda seconds: self.intent.emit(Choose("lead_s", seconds)))
        self.reports(self.sim.intent, self.hw.intent)
        self.send = self.button(main=True)
        self.title, self.text = label(role="large"), label(wrap=True)
        self.progress = QProgressBar()
        self.progress.setTextVisible(False)
        self.progress.setRange(0, 1000)
        self.send_now, self.change, self.abort = self.button(main=True), self.button(), self.button()
        self.plan = QWidget()
        """the buttons of a motion that waits"""
        self._lay_out()

    def _lay_out(self) -> None:
        to = in_row(self.sim, self.hw, None, self.lead_name, self.lead)
        self._send = in_row((self.send, 1), (in_column(self.title, self.progress, gap=2), 1), gap=10)
        buttons = (self.send_now, 1), (self.change, 1), (self.abort, 1)
        in_row(*buttons, margins=NO_MARGINS, inside=self.plan)
        self.text.setAlignment(Qt.AlignmentFlag.AlignTop)
        for part in (self.title, self.text):  # longer texts must not widen the column
            part.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Preferred)
        in_column(to, self._send, self.text, self.plan, gap=4, margins=(8, 8, 8, 8), inside=self)

    def show_simple(self, *, simple: bool) -> None:
        """Hide the lead, and show what the robots do below Send, because the column is narrow."""
        directions = QBoxLayout.Direction
        self._send.setDirection(directions.TopToBottom if simple else directions.LeftToRight)
        self._send.setSpacing(4 if simple else 10)
        for part in (self.lead_name, self.lead):
            part.setHidden(simple)

    def show_compact(self, *, compact: bool) -> None:
        """Reserve room for a waiting motion, so that nothing moves; in a low window, show the text as a tooltip."""
        policy = self.plan.sizePolicy()
        policy.setRetainSizeWhenHidden(not compact)
        self.plan.setSizePolicy(policy)
        self.text.setVisible(not compact)
        self.text.setMinimumHeight(LINES * self.text.fontMetrics().lineSpacing())

    def show_view(self, whole: View) -> None:
        """Show lead, Send and the present motion."""
        view, lead_s = whole.sending, whole.choices.lead_s
        self.send.show_view(whole.head.send)
        if self.lead.value() != lead_s:
            with QSignalBlocker(self.lead):
                self.lead.setValue(lead_s)
        self.lead.setToolTip(self._texts("tip.lead" if view.lead_matters else "tip.lead_one"))
        set_role(self.lead_name, "role", "" if view.lead_matters else "dim")
        self.title.setText(view.countdown or view.title)
        set_role(self.title, "role", "hw" if view.countdown else "large")
        self.title.setToolTip(view.text)
        self.text.setText(view.text)
        self.progress.setVisible(view.progress is not None)
        self.progress.setValue(round(1000 * (view.progress or 0.0)))
        self.send_now.show_view(view.send_now)
        self.change.show_view(view.change)
        self.abort.show_view(view.abort)
        waits = view.abort.enabled
        self.plan.setVisible(waits)
        due = whole.head.unsent and not waits  # else the next press is Send now, or elsewhere
        set_role(self.send, "main", "true" if due else "false")


STOP_PX = 56
"""Height of the bar of STOP; the style sheet contains it, too."""


class CommandsPanel(Panel):
    """A large button for each command of every day."""

    def __init__(self, texts: Texts) -> None:
        super().__init__("panel")
        self.setAccessibleName(texts("label.commands"))
        self.buttons = {name: self.button() for name in DAILY}
        self._layout = in_column(*self.buttons.values(), gap=8, margins=(8, 8, 8, 8), inside=self)

    def show_simple(self, *, simple: bool) -> None:
        """Show the buttons in a row, or larger in a column."""
        for button in self.buttons.values():
            set_role(button, "daily", "" if simple else "yes")
        directions = QBoxLayout.Direction
        self._layout.setDirection(directions.LeftToRight if simple else directions.TopToBottom)

    def show_view(self, view: CommandsView) -> None:
        """Show the buttons."""
        for name, button in self.buttons.items():
            button.show_view(view.buttons[name])


class StopBar(QPushButton):
    """Reports STOP when it is pressed, not when it is released."""

    intent = pyqtSignal(object)

    def __init__(self, texts: Texts) -> None:
        super().__init__()
        self._view: View | None = None
        self.emergency = IntentButton()
        """within this button, so that a press beside it is STOP"""
        self.emergency.setObjectName("emergency")
        self.emergency.intent.connect(self.intent)
        self.emergency.asking.connect(self._ask)
        self.setObjectName("stop")
        self.word, self.last = label(role="stop_word"), label(role="message", wrap=True)
        """STOP, and the last request with its outcome, which stands beside this button"""
        self.keys = label(texts("label.keys_stop").partition(": ")[0], "stop")
        self.last.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Ignored)
        self.last.setFixedHeight(STOP_PX)
        layout = in_row(
            self.word, self.keys, None, self.emergency, gap=12, margins=(20, 2, 12, 2), inside=self
        )
        layout.setSizeConstraint(
            QLayout.SizeConstraint.SetMinimumSize
        )  # a button alone would not count these
        for part in (self.word, self.keys):
            part.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
        self.pressed.connect(self.stop)

    def show_last(self, text: str) -> None:
        """Show the last request with its outcome, unless EMERGENCY_STOP asks its question there."""
        if not self.emergency.property("armed"):
            self.last.setText(text)

    def _ask(self, question: str) -> None:
        self.last.setText(f"▲ {question}" if question else "")  # until the next view

    def show_view(self, view: View) -> None:
        """Show the texts of both buttons."""
        stop, self._view = view.stop, view
        self.last.setToolTip(view.last_detail)
        # On the page of the robot it is in the menus of the pills.
        self.emergency.show_view(view.emergency if view.choices.page is WindowPage.CLASS else None)
        self.word.setText(stop.text)
        named(self, stop.text, stop.tooltip)

    def stop(self) -> None:
        """Report the intent."""
        if self._view is not None:
            self.intent.emit(self._view.stop.intent)
