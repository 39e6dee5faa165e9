"""The rare commands of one robot, in a popup of its pill."""

from __future__ import annotations

from PyQt5.QtCore import QPoint, Qt
from PyQt5.QtGui import QHideEvent, QKeyEvent
from PyQt5.QtWidgets import QAbstractButton, QVBoxLayout, QWidget

from gui.console.state.intents import EmergencyStop, Intent
from gui.console.state.views import ButtonView
from gui.window.keys import SEND_KEYS
from gui.window.widgets.controls import IntentButton, Panel, label, set_text, spaced

WIDTH_PX = 230


class RobotMenu(Panel):
    """Buttons below the pill; one with a question shows it here and stays open for the second press."""

    def __init__(self, parent: QWidget) -> None:
        super().__init__("panel", parent)
        self.setWindowFlags(Qt.WindowType.Popup)
        self._views: tuple[ButtonView, ...] = ()
        self.setFixedWidth(WIDTH_PX)
        self.buttons: list[IntentButton] = []
        self.question = label(wrap=True)
        self.question.hide()
        self._column = spaced(QVBoxLayout(self), 8, (8, 8, 8, 8))
        self._column.addWidget(self.question)

    def show_view(self, views: tuple[ButtonView, ...]) -> None:
        """Show a button for each command."""
        if views == self._views:
            return
        self._views = views
        while len(self.buttons) < len(views):
            button = IntentButton()
            if isinstance(views[len(self.buttons)].intent, EmergencyStop):
                button.setObjectName("emergency")
            button.intent.connect(self._choose)
            button.asking.connect(self._ask)
            self._column.insertWidget(len(self.buttons), button)
            self.buttons.append(button)
        for number, button in enumerate(self.buttons):
            button.setVisible(number < len(views))
            if number < len(views):
                button.show_view(views[number])
        self._fit()

    def open(self, below: QWidget) -> None:
        """Open below a button, at its right edge."""
        self._fit()
        corner = below.mapToGlobal(QPoint(below.width() - self.width(), below.height() + 2))
        self.move(max(0, corner.x()), corner.y())
        self.show()
        if self.buttons:
            self.buttons[0].setFocus()

    def keyPressEvent(self, event: QKeyEvent) -> None:  # noqa: N802
        """Press the focused button with Enter, as in the window; Space is STOP."""
        focus = self.focusWidget()
        if event.key() in SEND_KEYS and isinstance(focus, QAbstractButton):
            focus.click()
        else:
            super().keyPressEvent(event)

    def hideEvent(self, event: QHideEvent) -> None:  # noqa: N802
        super().hideEvent(event)
        for button in self.buttons:
            button.disarm()

    def _choose(self, intent: Intent) -> None:
        self.close()
        self.intent.emit(intent)

    def _ask(self, question: str) -> None:
        set_text(self.question, f"▲ {question}")
        self.question.setVisible(bool(question))
        self._fit()

    def _fit(self) -> None:
        """Take the height that the buttons and the wrapped question need."""
        self._column.activate()
        column = self._column
        # Only the question has a height for a width: without it Qt returns -1 here.
        wraps = column.hasHeightForWidth()
        self.setFixedHeight(
            column.totalHeightForWidth(WIDTH_PX) if wraps else column.totalSizeHint().height()
        )
