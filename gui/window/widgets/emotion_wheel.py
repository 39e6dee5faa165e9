"""The wheel of emotions: eight buttons around their name."""

from __future__ import annotations

from typing import Final

from PyQt5.QtCore import QEvent, QObject, QRectF, Qt
from PyQt5.QtGui import QPainterPath, QRegion, QResizeEvent
from PyQt5.QtWidgets import QWidget

from beatrix_zenoh.client.choreography import EMOTIONS
from gui.console.state.intents import Theme
from gui.window.theme import style_of
from gui.window.widgets.controls import label
from gui.window.widgets.picture_button import PictureButton

HUES: Final = (48, 95, 140, 180, 212, 250, 288, 0)
"""Colours of the sectors (degrees), in the order of `EMOTIONS`."""
TINT, TINT_CHOSEN = 30, 65
"""How much of its colour (%) a sector has, and the one under the mouse or with the focus."""
SECTOR: Final = 360 / len(EMOTIONS)
AIR_PX: Final = 10
HOLE: Final = 0.5
"""Size of the middle with the name, of that of the wheel."""
ENTERED: Final = (QEvent.Type.Enter, QEvent.Type.FocusIn)
LEFT: Final = (QEvent.Type.Leave, QEvent.Type.FocusOut)


class EmotionWheel(QWidget):
    """Eight buttons with the shape of sectors of a ring."""

    def __init__(self, title: str) -> None:
        """Create it; `title` stands in the middle while no emotion is pointed at."""
        super().__init__()
        self.setAccessibleName(title)
        self._title = title
        self.middle = label(title)
        self.middle.setParent(self)
        self.middle.setAlignment(Qt.AlignmentFlag.AlignCenter)
        self.buttons = {name: PictureButton(name) for name in EMOTIONS}
        for button in self.buttons.values():
            button.setParent(self)
            button.setToolButtonStyle(Qt.ToolButtonStyle.ToolButtonIconOnly)
            button.installEventFilter(self)

    @property
    def least_width(self) -> int:
        """The width (px) at which the title fits into the middle."""
        return round(self.fontMetrics().horizontalAdvance(self._title) / HOLE) + AIR_PX

    def show_theme(self, theme: Theme) -> None:
        """Use the colours and sizes of a theme."""
        field = style_of(theme).field
        for hue, button in zip(HUES, self.buttons.values(), strict=True):
            button.show_theme(theme)
            faint, strong = (f"hsva({hue}, 200, 220, {tint}%)" for tint in (TINT, TINT_CHOSEN))
            button.setStyleSheet(
                f"QToolButton {{ border: none; border-radius: 0; background: {faint}; }}"
                f"QToolButton:hover, QToolButton:focus {{ background: {strong}; }}"
                f"QToolButton:disabled {{ background: {field}; }}"
            )

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802
        super().resizeEvent(event)
        area = QRectF(self.rect()).adjusted(1, 1, -1, -1)
        hole = QRectF(0, 0, area.width() * HOLE, area.height() * HOLE)
        hole.moveCenter(area.center())
        self.middle.setGeometry(hole.toRect())
        for number, button in enumerate(self.buttons.values()):
            begin, gap = 90 - SECTOR * (number + 1), 1.0
            path = QPainterPath()
            path.arcMoveTo(hole, begin + gap)
            path.arcTo(area, begin + gap, SECTOR - 2 * gap)
            path.arcTo(hole, begin + SECTOR - gap, 2 * gap - SECTOR)
            shape = path.toFillPolygon().toPolygon()
            button.setGeometry(shape.boundingRect())
            button.setMask(QRegion(shape.translated(-button.pos())))

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:  # noqa: N802
        if isinstance(watched, PictureButton) and event.type() in ENTERED + LEFT:
            self.middle.setText(watched.text() if event.type() in ENTERED else self._title)
        return super().eventFilter(watched, event)
