"""Buttons with a picture over their text: the drawn face of a shipped gesture, or the emoji that a user has chosen."""

from __future__ import annotations

from importlib import resources
from typing import Final

from PyQt5.QtCore import QByteArray, QRectF, QSize, Qt, pyqtSignal
from PyQt5.QtGui import QColor, QFont, QFontMetrics, QIcon, QPixmap
from PyQt5.QtSvg import QSvgRenderer
from PyQt5.QtWidgets import QSizePolicy, QToolButton

from gui.console.state.intents import Intent, Theme
from gui.console.state.views import ButtonView
from gui.window.theme import style_of
from gui.window.widgets.head3d_paint import painted

PICTURE_PX = 26
"""Side of a picture at scale 1."""
COLOUR_FONTS: Final = ("Noto Color Emoji", "Segoe UI Emoji", "Apple Color Emoji")


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


def drawn(name: str, side: int, ratio: float, colours: tuple[str, str, str]) -> QPixmap:
    """Return a picture with a side (px) on a screen with this ratio of pixels; colours of line, face and mark."""
    text = resources.files(__package__).joinpath("pictures", f"{name}.svg").read_text(encoding="utf-8")
    for variable, colour in zip(("currentColor", "var(--face)", "var(--mark)"), colours, strict=True):
        text = text.replace(variable, colour)
    with painted(side, side, ratio) as (image, painter):
        QSvgRenderer(QByteArray(text.encode())).render(painter, QRectF(0, 0, side, side))
    return QPixmap.fromImage(image)


def emoji(text: str, name: str, side: int, ratio: float, colours: tuple[str, str, str]) -> QPixmap:
    """Return an emoji as `drawn` does; if no font has it, or it is empty, the first letter of the name in a circle."""
    line, face, mark = colours
    font = QFont()
    font.setFamilies([*COLOUR_FONTS, font.family()])
    font.setPixelSize(round(side * 0.8))
    if not text or not all(QFontMetrics(font).inFontUcs4(ord(sign)) for sign in text):
        text = name[:1].upper()
        font = QFont()
        font.setPixelSize(round(side * 0.5))
    with painted(side, side, ratio) as (image, painter):
        if text.isalnum():
            painter.setPen(QColor(mark))
            painter.setBrush(QColor(face))
            painter.drawEllipse(QRectF(1, 1, side - 2, side - 2))
        painter.setPen(QColor(line))
        painter.setFont(font)
        painter.drawText(QRectF(0, 0, side, side), int(Qt.AlignmentFlag.AlignCenter), text)
    return QPixmap.fromImage(image)
