"""State of each robot in the header: symbol, word, round trip, lease, and the buttons for next step and lease."""

from __future__ import annotations

from PyQt5.QtCore import pyqtSignal
from PyQt5.QtWidgets import QFrame, QHBoxLayout, QSizePolicy, QVBoxLayout

from gui.console.state.views import Condition, PillView
from gui.window.widgets.controls import (
    SEPARATOR,
    ElidedLabel,
    IntentButton,
    OptionalLabel,
    PartsLabel,
    label,
    set_role,
    set_text,
)

ROLES = {
    Condition.ABSENT: "dim",
    Condition.SILENT: "bad",
    Condition.DISABLED: "warn",
    Condition.NOT_CALIBRATED: "warn",
    Condition.READY: "good",
    Condition.MOVING: "good",
    Condition.DRIVEN: "warn",
    Condition.FROZEN: "warn",
    Condition.FAULT: "bad",
}


class Pill(QFrame):
    """State of one robot, with the buttons for its next step and lease."""

    intent = pyqtSignal(object)

    def __init__(self, side: str) -> None:
        super().__init__()
        self._view: PillView | None = None
        self.setProperty("pill", True)  # noqa: FBT003
        self.setProperty("side", side)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Preferred)
        self.title, self.state = label(role=side), ElidedLabel()
        self.notes = PartsLabel("dim")
        """notes and round trip"""
        self.next_step, self.lease = IntentButton(), IntentButton()
        self.lease.intent.connect(self.intent)
        self.next_step.setProperty("next_step", True)  # noqa: FBT003
        self.next_step.intent.connect(self.intent)
        first = QHBoxLayout()
        first.setSpacing(8)
        first.addWidget(self.title)
        first.addWidget(self.notes, 1)
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
        layout.addWidget(self.lease)
        self.next_step.hide()
        self.lease.hide()

    def show_view(self, view: PillView) -> None:
        """Show the robot's state."""
        if view == self._view:
            return
        self._view = view
        set_text(self.title, view.title)
        set_role(self.state, "role", ROLES[view.condition])
        set_text(self.state, f"{view.symbol} {view.text}")
        self.notes.show_parts(tuple(part for part in (*view.notes, view.latency) if part))
        set_text(self.reason, " ".join(line for line in (view.reason, *view.warnings) if line))
        lines = [view.reason, *view.warnings, SEPARATOR.join(view.notes), view.details]
        self.setToolTip("\n".join(line for line in lines if line))
        self.setAccessibleName(f"{view.title}: {view.text}")
        self.setAccessibleDescription(self.toolTip())
        buttons = ((self.next_step, view.next_step), (self.lease, view.lease))
        for button, shown in buttons:  # hidden first, so that the window never needs the width of both
            if shown is None:
                button.hide()
        for button, shown in buttons:
            if shown is not None:
                button.show_view(shown)
                button.show()
