"""Commands to the checked robots, and STOP of all."""

from __future__ import annotations

from PyQt5.QtCore import Qt, pyqtSignal
from PyQt5.QtWidgets import QHBoxLayout, QPushButton, QSizePolicy, QVBoxLayout

from gui.console.state.intents import WindowPage
from gui.console.state.views import CommandsView, View
from gui.console.texts import Texts
from gui.window.widgets.controls import IntentButton, Panel, label, set_text, spaced

NAMES = ("home", "undo")
"""Commands of every day; the menus of the pills contain the others."""
HEIGHT_PX = 56
"""Height of the bar of STOP; the style sheet contains it, too."""


class CommandsPanel(Panel):
    """A large button for each command of every day."""

    def __init__(self, texts: Texts) -> None:
        super().__init__("panel")
        self._view: CommandsView | None = None
        self.setAccessibleName(texts("label.commands"))
        self.buttons = {name: IntentButton() for name in NAMES}
        layout = spaced(QVBoxLayout(self), 8, (8, 8, 8, 8))
        for button in self.buttons.values():
            button.setProperty("daily", True)  # noqa: FBT003
            layout.addWidget(button)
            button.intent.connect(self.intent)

    def show_view(self, view: CommandsView) -> None:
        """Show the buttons."""
        if view == self._view:
            return
        self._view = view
        self.buttons["home"].show_view(view.home)
        self.buttons["undo"].show_view(view.undo)


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
        self.word, self.last = label(role="stop_word"), label(role="message", wrap=True)
        """STOP, and the last request with its outcome, which stands beside this button"""
        self.keys = label(texts("label.keys_stop").partition(": ")[0], "stop")
        self.last.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Ignored)
        self.last.setFixedHeight(HEIGHT_PX)
        layout = spaced(QHBoxLayout(self), None, (20, 2, 12, 2))
        layout.setSizeConstraint(
            QHBoxLayout.SizeConstraint.SetMinimumSize
        )  # a button alone would not count these
        layout.addWidget(self.word)
        layout.addSpacing(12)
        layout.addWidget(self.keys)
        layout.addStretch(1)
        layout.addWidget(self.emergency)
        for part in (self.word, self.keys):
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
        self.last.setToolTip(view.last_detail)
        self.emergency.show_view(view.emergency)
        self.emergency.setVisible(
            view.choices.page is WindowPage.CLASS
        )  # elsewhere it is in the menus of the pills
        set_text(self.word, stop.text)
        self.setToolTip(stop.tooltip)
        self.setAccessibleName(stop.text)
        self.setAccessibleDescription(stop.tooltip)

    def stop(self) -> None:
        """Report the intent."""
        if self._view is not None:
            self.intent.emit(self._view.stop.intent)
