"""The wheel of emotions: eight buttons around their name."""

from __future__ import annotations

import math
from typing import Final

from PyQt5.QtCore import QEvent, QObject, QPoint, QRectF, Qt
from PyQt5.QtGui import QColor, QMouseEvent, QPainter, QPaintEvent, QPen, QResizeEvent
from PyQt5.QtWidgets import QWidget

from beatrix_zenoh.client.choreography import EMOTIONS
from gui.console.state.intents import Theme
from gui.window.theme import style_of
from gui.window.widgets.picture_button import PictureButton

HUES: Final = (48, 95, 140, 180, 212, 250, 288, 0)
"""Colours of the sectors (degrees), in the order of `EMOTIONS`."""
TINT, TINT_CHOSEN = 0.3, 0.65
"""How much of its colour a sector has, and the one under the mouse or with the focus."""
SECTOR: Final = 360 / len(EMOTIONS)
HOLE: Final = 0.5
"""Size of the middle with the name, of that of the wheel."""
WIDEST: Final = 2.1
"""Largest width of the wheel, of its height."""
ENTERED: Final = (QEvent.Type.Enter, QEvent.Type.FocusIn)
LEFT: Final = (QEvent.Type.Leave, QEvent.Type.FocusOut)


class EmotionWheel(QWidget):
    """Eight buttons on an ellipse; a press anywhere in a sector presses its button."""

    def __init__(self, title: str) -> None:
        """Create it; `title` stands in the middle while no emotion is pointed at."""
        super().__init__()
        self.setAccessibleName(title)
        self._title, self._chosen, self._style = title, -1, style_of(Theme.DARK)
        self.buttons = {name: PictureButton(name) for name in EMOTIONS}
        for button in self.buttons.values():
            button.setParent(self)
            button.setToolButtonStyle(Qt.ToolButtonStyle.ToolButtonIconOnly)
            button.installEventFilter(self)

    def show_theme(self, theme: Theme) -> None:
        """Use the colours and sizes of a theme."""
        self._style = style = style_of(theme)
        self.setStyleSheet(
            "QToolButton { background: transparent; border: 2px solid transparent; border-radius: 6px; }"
            f"QToolButton:focus {{ border-color: {style.accent}; }}"
        )
        for button in self.buttons.values():
            button.show_theme(theme)

    @property
    def area(self) -> QRectF:
        """The place of the wheel (px)."""
        height = self.height() - 2
        width = min(self.width() - 2, height * WIDEST)
        return QRectF((self.width() - width) / 2, 1, width, height)

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802
        super().resizeEvent(event)
        area, share = self.area, (1 + HOLE) / 4
        for number, button in enumerate(self.buttons.values()):
            angle = math.radians(90 - SECTOR * (number + 0.5))
            side = button.sizeHint()
            x = area.center().x() + area.width() * share * math.cos(angle)
            y = area.center().y() - area.height() * share * math.sin(angle)
            button.setGeometry(
                round(x - side.width() / 2), round(y - side.height() / 2), side.width(), side.height()
            )

    def sector_at(self, place: QPoint) -> int:
        """Return the number of the sector at a place (px); -1: there is none."""
        area = self.area
        x = 2 * (place.x() - area.center().x()) / max(1.0, area.width())
        y = 2 * (area.center().y() - place.y()) / max(1.0, area.height())
        inside = HOLE <= math.hypot(x, y) <= 1
        return int(math.degrees(math.atan2(x, y)) % 360 / SECTOR) if inside else -1

    def mousePressEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        number = self.sector_at(event.pos())
        if number >= 0 and event.button() == Qt.MouseButton.LeftButton:
            [*self.buttons.values()][number].click()

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:  # noqa: N802
        if event.type() in ENTERED + LEFT:
            buttons: list[QObject] = [*self.buttons.values()]
            self._chosen = buttons.index(watched) if event.type() in ENTERED else -1
            self.update()
        return super().eventFilter(watched, event)

    def paintEvent(self, _event: QPaintEvent) -> None:  # noqa: N802
        painter, style, area = QPainter(self), self._style, self.area
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setPen(QPen(QColor(style.panel), 2))
        names = [*self.buttons]
        for number, name in enumerate(names):
            share = (TINT_CHOSEN if number == self._chosen else TINT) * self.buttons[name].isEnabled()
            painter.setBrush(mixed(QColor(style.field), QColor.fromHsv(HUES[number], 200, 220), share))
            painter.drawPie(area, round(16 * (90 - SECTOR * (number + 1))), round(16 * SECTOR))
        painter.setBrush(QColor(style.panel))
        middle = QRectF(0, 0, area.width() * HOLE, area.height() * HOLE)
        middle.moveCenter(area.center())
        painter.drawEllipse(middle)
        painter.setPen(QColor(style.text if self._chosen >= 0 else style.dim))
        text = self.buttons[names[self._chosen]].text() if self._chosen >= 0 else self._title
        if painter.fontMetrics().horizontalAdvance(text) < middle.width():  # else tooltips say it
            painter.drawText(middle, int(Qt.AlignmentFlag.AlignCenter), text)


def mixed(ground: QColor, colour: QColor, share: float) -> QColor:
    """Return a colour with this share of `colour`."""
    pairs = zip(ground.getRgb()[:3], colour.getRgb()[:3], strict=True)
    return QColor(*(round(below + share * (above - below)) for below, above in pairs))
