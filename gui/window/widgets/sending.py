"""Below the head pad: where motions go, Send, and the motion that waits to be sent to the hardware."""

from __future__ import annotations

from PyQt5.QtCore import QSignalBlocker, Qt
from PyQt5.QtWidgets import QHBoxLayout, QProgressBar, QSizePolicy, QVBoxLayout, QWidget

from gui.console.state.intents import Choose
from gui.console.state.views import SendingView, View
from gui.console.texts import Texts
from gui.window.widgets.controls import ChoiceCheck, IntentButton, Panel, label, set_role, set_text, spaced
from gui.window.widgets.number_box import NumberBox

LEAD_MAX_S = 60.0
SEND_GAP_PX = 10
LINES = 2
"""Lines reserved for the text about the motion."""


class SendingPanel(Panel):
    """Destinations, lead, Send, and the present motion."""

    def __init__(self, texts: Texts) -> None:
        super().__init__("panel")
        self._texts = texts
        self._view: SendingView | None = None
        self.setAccessibleName(texts("label.send_to"))
        self.sim, self.hw = ChoiceCheck(texts, "sim"), ChoiceCheck(texts, "hw")
        self.lead_name = label(texts("label.lead"))
        self.lead = NumberBox(texts, texts("label.lead_unit"), 0.0)
        self.lead.setMaximum(LEAD_MAX_S)
        self.lead.setSingleStep(0.5)
        self.lead.setAccessibleName(f"{texts('label.lead')} (s)")
        self.send = IntentButton(main=True)
        self.title, self.text = label(role="large"), label(wrap=True)
        self.countdown = label(role="hw")
        self.progress = QProgressBar()
        self.progress.setTextVisible(False)
        self.progress.setRange(0, 1000)
        self.send_now, self.change, self.abort = IntentButton(main=True), IntentButton(), IntentButton()
        self.plan = QWidget()
        """the buttons of a motion that waits"""
        self._lay_out()
        self._connect()

    def _lay_out(self) -> None:
        to, send, plan = QHBoxLayout(), QHBoxLayout(), QHBoxLayout()
        state = QVBoxLayout()
        to.addWidget(self.sim)
        to.addWidget(self.hw)
        to.addStretch(1)
        to.addWidget(self.lead_name)
        to.addWidget(self.lead)
        send.setSpacing(SEND_GAP_PX)
        send.addWidget(self.send, 1)
        send.addLayout(state, 1)
        state.setSpacing(2)
        for part in (self.title, self.countdown, self.progress):
            state.addWidget(part)
        for button in (self.send_now, self.change, self.abort):
            plan.addWidget(button, 1)
        plan.setContentsMargins(0, 0, 0, 0)
        self.plan.setLayout(plan)
        self.text.setAlignment(Qt.AlignmentFlag.AlignTop)
        for part in (self.title, self.countdown, self.text):  # longer texts must not widen the column
            part.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Preferred)
        layout = spaced(QVBoxLayout(self), 4, (8, 8, 8, 8))
        layout.addLayout(to)
        layout.addLayout(send)
        layout.addWidget(self.text)
        layout.addWidget(self.plan)

    def _connect(self) -> None:
        self.lead.valueChanged.connect(lambda seconds: self.intent.emit(Choose("lead_s", seconds)))
        for button in (self.sim, self.hw, self.send, self.send_now, self.change, self.abort):
            button.intent.connect(self.intent)

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
        if view == self._view:
            return
        self._view = view
        self.lead.setToolTip(self._texts("tip.lead" if view.lead_matters else "tip.lead_one"))
        set_role(self.lead_name, "role", "" if view.lead_matters else "dim")
        set_text(self.title, view.title)
        set_text(self.text, view.text)
        set_text(self.countdown, view.countdown)
        for part in (self.title, self.countdown):
            part.setToolTip(view.text)
        self.title.setVisible(not view.countdown)
        self.countdown.setVisible(bool(view.countdown))
        self.progress.setVisible(view.progress is not None)
        self.progress.setValue(round(1000 * (view.progress or 0.0)))
        self.send_now.show_view(view.send_now)
        self.change.show_view(view.change)
        self.abort.show_view(view.abort)
        waits = view.abort.enabled
        self.plan.setVisible(waits)
        set_role(
            self.send, "main", "false" if waits else "true"
        )  # while a motion waits, the next press is Send now
