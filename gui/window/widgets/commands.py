"""Commands for the checked robots: Calibrate, Home, Enable, Disable, Reset, Undo."""

from __future__ import annotations

from PyQt5.QtCore import pyqtSignal
from PyQt5.QtWidgets import QFrame, QGridLayout

from gui.console.state.views import CommandsView
from gui.console.texts import Texts
from gui.window.widgets.controls import IntentButton

NAMES = ("enable", "disable", "calibrate", "home", "reset", "undo")
COLUMNS = 2


class Commands(QFrame):
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
