"""The STOP button over the whole width, with the last request beside it."""

from __future__ import annotations

from PyQt5.QtCore import Qt, pyqtSignal
from PyQt5.QtWidgets import QHBoxLayout, QPushButton

from gui.console.state.views import ButtonView
from gui.console.texts import Texts
from gui.window.widgets.controls import label, set_text


class StopBar(QPushButton):
    """Reports STOP when it is pressed, not when it is released."""

    intent = pyqtSignal(object)

    def __init__(self, texts: Texts) -> None:
        super().__init__()
        self._view: ButtonView | None = None
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
        for part in (self.word, self.keys, self.last):
            part.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
        self.pressed.connect(self.stop)

    def show_last(self, text: str) -> None:
        """Show the last request with its outcome."""
        set_text(self.last, text)

    def show_view(self, stop: ButtonView) -> None:
        """Show the text of the button."""
        if stop == self._view:
            return
        self._view = stop
        set_text(self.word, stop.text)
        self.setToolTip(stop.tooltip)
        self.setAccessibleName(stop.text)
        self.setAccessibleDescription(stop.tooltip)

    def stop(self) -> None:
        """Report the intent."""
        if self._view is not None:
            self.intent.emit(self._view.intent)
