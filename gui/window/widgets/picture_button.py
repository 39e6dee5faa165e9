"""Buttons with a picture over their text: the drawn face of a shipped gesture, or the emoji that a user has chosen."""

from __future__ import annotations

from importlib import resources
from typing import Final

from PyQt5.QtCore import QByteArray, QRectF, QSize, Qt, pyqtSignal
from PyQt5.QtGui import QColor, QFont, QFontMetrics, QIcon, QPixmap, QResizeEvent
from PyQt5.QtSvg import QSvgRenderer
from PyQt5.QtWidgets import QSizePolicy, QToolButton

from gui.console.state.intents import Intent, Theme
from gui.console.state.views import ButtonView
from gui.window.theme import style_of
from gui.window.widgets.controls import in_lines
from gui.window.widgets.head3d_paint import painted

PICTURE_PX, LARGE_PX = 26, 44
"""Side of a picture at scale 1, and of that of a tall button."""
TALL_PX = 72
"""From which height a button is tall, at scale 1."""
COLOUR_FONTS: Final = ("Noto Color Emoji", "Segoe UI Emoji", "Apple Color Emoji")


class PictureButton(QToolButton):
    """A button with a picture over its text."""

    intent = pyqtSignal(object)

    def __init__(self, picture: str, sign: str | None = None) -> None:
        """Create it with a drawn picture, or with the emoji `sign`, which may be empty, of a gesture of this name."""
        super().__init__()
        self._picture, self._sign = picture, sign
        self._intent: Intent | None = None
        self._tall, self._small, self._large = TALL_PX, PICTURE_PX, LARGE_PX
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Ignored)
        self.clicked.connect(lambda: self.intent.emit(self._intent))

    def show_view(self, view: ButtonView) -> None:
        """Show the view's text, and enable or disable the button."""
        self._intent = view.intent
        self.setText(view.text.replace("&", "&&"))
        self.setToolTip(in_lines(f"{view.text}: {view.tooltip}"))
        self.setAccessibleName(view.text)
        self.setEnabled(view.enabled)

    def show_theme(self, theme: Theme) -> None:
        """Use the colours and sizes of a theme."""
        style, ratio = style_of(theme), self.devicePixelRatioF()
        icon, side = QIcon(), style.px(LARGE_PX)
        for mode, line, mark in (
            (QIcon.Mode.Normal, style.text, style.accent),
            (QIcon.Mode.Disabled, style.disabled, style.disabled),
        ):
            if self._sign is None:
                picture = drawn(self._picture, side, ratio, (line, style.field, mark))
            else:
                picture = emoji(self._sign, self._picture, side, ratio, line)
            icon.addPixmap(picture, mode)
        self._tall, (self._small, self._large) = style.px(TALL_PX), map(style.px, (PICTURE_PX, LARGE_PX))
        self.setIcon(icon)
        self._fit()

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802
        super().resizeEvent(event)
        self._fit()

    def _fit(self) -> None:
        named = self.toolButtonStyle() == Qt.ToolButtonStyle.ToolButtonTextUnderIcon
        side = self._large if named and self.height() >= self._tall else self._small
        self.setIconSize(QSize(side, side))


def drawn(name: str, side: int, ratio: float, colours: tuple[str, str, str]) -> QPixmap:
    """Return a picture with a side (px) on a screen with this ratio of pixels; colours of line, face and mark."""
    text = resources.files(__package__).joinpath("pictures", f"{name}.svg").read_text(encoding="utf-8")
    for variable, colour in zip(("currentColor", "var(--face)", "var(--mark)"), colours, strict=True):
        text = text.replace(variable, colour)
    with painted(side, side, ratio) as (image, painter):
        QSvgRenderer(QByteArray(text.encode())).render(painter, QRectF(0, 0, side, side))
    return QPixmap.fromImage(image)


def emoji_font(height: int) -> QFont:
    """Return the font of this height (px) that has the emoji, in colour if there is one."""
    font = QFont()
    font.setFamilies([*COLOUR_FONTS, font.family()])
    font.setPixelSize(height)
    return font


def emoji(text: str, name: str, side: int, ratio: float, colour: str) -> QPixmap:
    """Return an emoji as `drawn` does; the first letter of the name if it is empty, or the font lacks it."""
    font = emoji_font(round(side * 0.8))
    if not text or not all(QFontMetrics(font).inFontUcs4(ord(sign)) for sign in text):
        text = name[:1].upper()
    with painted(side, side, ratio) as (image, painter):
        painter.setPen(QColor(colour))
        painter.setFont(font)
        painter.drawText(QRectF(0, 0, side, side), int(Qt.AlignmentFlag.AlignCenter), text)
    return QPixmap.fromImage(image)
