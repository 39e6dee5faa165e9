"""Pictures of gestures: the drawn faces of shipped ones, and the emoji that a user has chosen."""

from __future__ import annotations

from importlib import resources
from typing import Final

from PyQt5.QtCore import QByteArray, QRectF, Qt
from PyQt5.QtGui import QColor, QFont, QFontMetrics, QPainter, QPixmap
from PyQt5.QtSvg import QSvgRenderer

from gui.window.widgets.head3d_paint import painted

EMOJI: Final = tuple("😀😂😍😎😜😇😏😋😢😭😡😱😴😳😵🙃🐱🐭🐵🐮❤⚡☀☃")
"""Those that are offered: Windows and macOS have them in colour, and DejaVu Sans, which Linux has, in black and white."""
COLOUR_FONTS: Final = ("Noto Color Emoji", "Segoe UI Emoji", "Apple Color Emoji")


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
            painter.setRenderHint(QPainter.RenderHint.Antialiasing)
            painter.setPen(QColor(mark))
            painter.setBrush(QColor(face))
            painter.drawEllipse(QRectF(1, 1, side - 2, side - 2))
        painter.setPen(QColor(line))
        painter.setFont(font)
        painter.drawText(QRectF(0, 0, side, side), int(Qt.AlignmentFlag.AlignCenter), text)
    return QPixmap.fromImage(image)
