"""The banner over the whole width of the window: the action that is needed first, with its buttons."""

from __future__ import annotations

from PyQt5.QtCore import pyqtSignal
from PyQt5.QtWidgets import QFrame, QHBoxLayout

from gui.console.state.views import BannerView
from gui.window.widgets.controls import IntentButton, label, set_text


class Banner(QFrame):
    """A sentence and buttons for the next step; hidden while there is nothing to do."""

    intent = pyqtSignal(object)

    def __init__(self) -> None:
        super().__init__()
        self._view: BannerView | None = None
        self.setProperty("notice", True)  # noqa: FBT003
        self.text = label(role="title", wrap=True)
        self.buttons: list[IntentButton] = []
        self._layout = QHBoxLayout(self)
        self._layout.setContentsMargins(10, 4, 6, 4)
        self._layout.addWidget(self.text, 1)
        self.hide()

    def show_view(self, view: BannerView | None) -> None:
        """Show the banner, or hide it."""
        if view == self._view:
            return
        self._view = view
        if view is not None:
            set_text(self.text, view.text)
            while len(self.buttons) < len(view.buttons):
                button = IntentButton(main=not self.buttons)
                button.intent.connect(self.intent)
                self.buttons.append(button)
                self._layout.addWidget(button)
            for button, shown in zip(self.buttons, view.buttons, strict=False):
                button.show_view(shown)
            for number, button in enumerate(self.buttons):
                button.setVisible(number < len(view.buttons))
        self.setVisible(view is not None)
