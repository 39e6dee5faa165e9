"""The Record button, the duration of the recording, and the button that opens it."""

from __future__ import annotations

from PyQt5.QtCore import pyqtSignal
from PyQt5.QtWidgets import QHBoxLayout, QWidget

from gui.console.state.views import RecordView
from gui.window.widgets.controls import IntentButton, label, set_text


class Record(QWidget):
    """The buttons that begin, end and open a recording, and its duration."""

    intent = pyqtSignal(object)

    def __init__(self) -> None:
        super().__init__()
        self._view: RecordView | None = None
        self.toggle, self.open = IntentButton(), IntentButton()
        self.text = label(role="bad")
        layout = QHBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.setSpacing(4)
        for widget in (self.toggle, self.text, self.open):
            layout.addWidget(widget)
        for button in (self.toggle, self.open):
            button.intent.connect(self.intent)

    def show_view(self, view: RecordView) -> None:
        """Show the buttons, and the duration while a recording runs."""
        if view == self._view:
            return
        self._view = view
        self.toggle.show_view(view.toggle)
        set_text(self.text, f"● {view.text}" if view.running else view.text)
        self.text.setVisible(bool(view.text))
        if view.open is not None:
            self.open.show_view(view.open)
        self.open.setVisible(view.open is not None)
