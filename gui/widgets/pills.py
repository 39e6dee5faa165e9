"""State of each robot in the header: symbol, word, round trip, and the button for the next step."""

from __future__ import annotations

from PyQt5.QtCore import pyqtSignal
from PyQt5.QtWidgets import QFrame, QHBoxLayout, QSizePolicy, QVBoxLayout

from gui.state.views import Condition, PillView
from gui.widgets.controls import ElidedLabel, IntentButton, OptionalLabel, label, set_role, set_text

ROLES = {
    Condition.ABSENT: "dim",
    Condition.SILENT: "bad",
    Condition.DISABLED: "warn",
    Condition.NOT_CALIBRATED: "warn",
    Condition.READY: "good",
    Condition.MOVING: "good",
    Condition.DRIVEN: "warn",
    Condition.FAULT: "bad",
}


class Pill(QFrame):
    """One robot."""

    intent = pyqtSignal(object)

    def __init__(self, twin: str) -> None:
        super().__init__()
        self._view: PillView | None = None
        self.setProperty("pill", True)  # noqa: FBT003
        self.setProperty("twin", twin)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Preferred)
        self.title, self.state = label(role=twin), ElidedLabel()
        self.latency = label(role="dim")
        self.next_step = IntentButton()
        self.next_step.setProperty("next_step", True)  # noqa: FBT003
        self.next_step.intent.connect(self.intent)
        first = QHBoxLayout()
        first.setSpacing(8)
        first.addWidget(self.title)
        first.addWidget(self.latency)
        words = QVBoxLayout()
        words.setSpacing(0)
        words.addLayout(first)
        words.addWidget(self.state)
        layout = QHBoxLayout(self)
        layout.setContentsMargins(6, 2, 6, 2)
        self.reason = OptionalLabel("dim")
        layout.addLayout(words)
        layout.addWidget(self.reason, 1)
        layout.addWidget(self.next_step)
        self.next_step.hide()

    def show_view(self, view: PillView) -> None:
        """Show the robot's state."""
        if view == self._view:
            return
        self._view = view
        set_text(self.title, view.title)
        set_role(self.state, "role", ROLES[view.condition])
        set_text(self.state, f"{view.symbol} {view.text}")
        set_text(self.latency, view.latency)
        set_text(self.reason, " ".join(line for line in (view.reason, *view.warnings) if line))
        lines = [view.reason, *view.warnings, view.details]
        self.setToolTip("\n".join(line for line in lines if line))
        self.setAccessibleName(f"{view.title}: {view.text}")
        self.setAccessibleDescription(self.toolTip())
        if view.next_step is not None:
            self.next_step.show_view(view.next_step)
        self.next_step.setVisible(view.next_step is not None)
