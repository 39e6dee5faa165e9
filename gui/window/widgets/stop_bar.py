"""The STOP button over the whole width, with the last request and a small button for EMERGENCY_STOP."""

from __future__ import annotations

from PyQt5.QtCore import Qt, pyqtSignal
from PyQt5.QtWidgets import QHBoxLayout, QPushButton

from gui.console.state.views import View
from gui.console.texts import Texts
from gui.window.widgets.controls import IntentButton, label, set_text


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
