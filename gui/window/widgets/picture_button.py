"""Buttons with a picture over their text."""

from __future__ import annotations

from PyQt5.QtCore import QSize, Qt, pyqtSignal
from PyQt5.QtGui import QIcon, QPixmap
from PyQt5.QtWidgets import QSizePolicy, QToolButton

from gui.console.state.intents import Intent, Theme
from gui.console.state.views import ButtonView
from gui.window.theme import style_of
from gui.window.widgets.gesture_pictures import drawn, emoji

PICTURE_PX = 26
"""Side of a picture at scale 1."""


class PictureButton(QToolButton):
    """A button with a picture over its text."""

    intent = pyqtSignal(object)

    def __init__(self, picture: str, sign: str | None = None) -> None:
        """Create it with a drawn picture, or with the emoji `sign`, which may be empty, of a gesture of this name."""
        super().__init__()
        self._picture, self._sign = picture, sign
        self._intent: Intent | None = None
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Ignored)
        self.clicked.connect(lambda: self.intent.emit(self._intent))

    def show_view(self, view: ButtonView) -> None:
        """Show the view's text, and enable or disable the button."""
        self._intent = view.intent
        self.setText(view.text.replace("&", "&&"))
        self.setToolTip(f"{view.text}: {view.tooltip}")
        self.setAccessibleName(view.text)
        self.setEnabled(view.enabled)

    def show_theme(self, theme: Theme) -> None:
        """Use the colours and sizes of a theme."""
        style = style_of(theme)
        icon, side = QIcon(), style.px(PICTURE_PX)
        for mode, line, mark in (
            (QIcon.Mode.Normal, style.text, style.accent),
            (QIcon.Mode.Disabled, style.disabled, style.disabled),
        ):
            icon.addPixmap(self._drawn(side, (line, style.field, mark)), mode)
        self.setIcon(icon)
        self.setIconSize(QSize(side, side))

    def _drawn(self, side: int, colours: tuple[str, str, str]) -> QPixmap:
        ratio = self.devicePixelRatioF()
        if self._sign is None:
            return drawn(self._picture, side, ratio, colours)
        return emoji(self._sign, self._picture, side, ratio, colours)
