"""The strip of the sequence editor: a card with a small head for each pose, in their order."""

from __future__ import annotations

import math

from PyQt5.QtCore import QPoint, QPointF, QRect, QRectF, QSignalBlocker, QSize, Qt, pyqtSignal
from PyQt5.QtGui import QColor, QIcon, QKeyEvent, QMouseEvent, QPainter, QPaintEvent, QPen, QPixmap, QPolygonF
from PyQt5.QtWidgets import QApplication, QListWidget, QListWidgetItem

from gui.console.state.intents import HeadOrientation, Theme
from gui.console.state.views import CardView
from gui.window.theme import Style, style_of

WIDTH_PX, HEIGHT_PX, PICTURE_PX = 70, 92, 48
"""Size of a card, and side of its picture, at scale 1."""
FACE = 0.42
"""Radius of a head, as a share of the side of its picture."""


class Strip(QListWidget):
    """Cards to select, to drag to another place, and to use with the keyboard."""

    used = pyqtSignal(int)
    """a click or Enter on this card"""
    moved = pyqtSignal(int, int)
    """a card, and its new place counted without it"""
    deleted = pyqtSignal(int)

    def __init__(self, name: str, empty: str) -> None:
        """Create an empty strip; `empty` is its text while it has no card."""
        super().__init__()
        self._empty = empty
        self.setAccessibleName(name)
        self.setViewMode(QListWidget.ViewMode.IconMode)
        self.setMovement(QListWidget.Movement.Static)
        self.setWrapping(False)
        self.setVerticalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.setMinimumWidth(80)
        self.cards: tuple[CardView, ...] = ()
        self._played = -1
        self._style = style_of(Theme.DARK)
        self._pressed: QPoint | None = None
        self._drop: int | None = None
        """while a card is dragged: its place counted without it"""

    def show_cards(self, cards: tuple[CardView, ...], current: int, played: int = -1) -> None:
        """Show the cards; numbers of the selected one and of the one that is being played (-1: none)."""
        with QSignalBlocker(self):
            if (cards, played) != (self.cards, self._played):
                self.cards, self._played = cards, played
                self._fill()
            self.setCurrentRow(current)
        self.scrollTo(self.model().index(played if played >= 0 else current, 0))

    def show_theme(self, theme: Theme) -> None:
        """Use the colours and sizes of a theme."""
        current, self._style = self.currentRow(), style_of(theme)
        self.setGridSize(QSize(self._style.px(WIDTH_PX), self._style.px(HEIGHT_PX)))
        self.setIconSize(QSize(self._style.px(PICTURE_PX), self._style.px(PICTURE_PX)))
        with QSignalBlocker(self):
            self._fill()
            self.setCurrentRow(current)

    def _fill(self) -> None:
        self._pressed, self._drop = None, None
        self.clear()
        for number, card in enumerate(self.cards):
            mark = "▸" if number == self._played else ""
            item = QListWidgetItem(self._icon(card), f"{mark}{card.name}\n{card.duration}")
            item.setToolTip("\n".join(filter(None, (f"{card.name}, {card.duration}", card.problem))))
            if card.problem:
                item.setForeground(QColor(self._style.bad))
            self.addItem(item)

    def _icon(self, card: CardView) -> QIcon:
        side, ratio = self._style.px(PICTURE_PX), self.devicePixelRatioF()
        picture = QPixmap(round(side * ratio), round(side * ratio))
        picture.setDevicePixelRatio(ratio)
        picture.fill(Qt.GlobalColor.transparent)
        if card.head is not None:
            painter = QPainter(picture)
            painter.setRenderHint(QPainter.RenderHint.Antialiasing)
            paint_head(painter, QRectF(0, 0, side, side), card.head, self._style)
            painter.end()
        icon = QIcon(picture)
        icon.addPixmap(picture, QIcon.Mode.Selected)  # Qt would tint it
        return icon

    def card(self, number: int) -> QRect:
        """Return the place of a card (px)."""
        return self.visualRect(self.model().index(number, 0))

    # -- mouse --------------------------------------------------------------------------------------

    def mousePressEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        super().mousePressEvent(event)
        if event.button() == Qt.MouseButton.LeftButton and self.indexAt(event.pos()).isValid():
            self._pressed = event.pos()

    def mouseMoveEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        if self._pressed is None:
            return
        x = event.pos().x()
        if abs(x - self._pressed.x()) >= QApplication.startDragDistance() or self._drop is not None:
            others = (self.card(number) for number in range(len(self.cards)) if number != self.currentRow())
            self._drop = sum(other.center().x() < x for other in others)
            self.viewport().update()

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        pressed, drop, self._pressed, self._drop = self._pressed, self._drop, None, None
        if event.button() != Qt.MouseButton.LeftButton or pressed is None:
            return
        self.viewport().update()
        if drop is None:
            self.used.emit(self.currentRow())
        elif drop != self.currentRow():
            self.moved.emit(self.currentRow(), drop)

    # -- keyboard -----------------------------------------------------------------------------------

    def keyPressEvent(self, event: QKeyEvent) -> None:  # noqa: N802
        """Move with Ctrl and the arrows, use with Enter, delete with Delete; the list selects with the arrows."""
        ways = {Qt.Key.Key_Left: -1, Qt.Key.Key_Right: 1}
        key, number = event.key(), self.currentRow()
        if key in ways and event.modifiers() & Qt.KeyboardModifier.ControlModifier:
            goal = number + ways[Qt.Key(key)]
            if number >= 0 and 0 <= goal < len(self.cards):
                self.moved.emit(number, goal)
        elif number >= 0 and key in {Qt.Key.Key_Return, Qt.Key.Key_Enter}:
            self.used.emit(number)
        elif number >= 0 and key in {Qt.Key.Key_Delete, Qt.Key.Key_Backspace}:
            self.deleted.emit(number)
        else:
            super().keyPressEvent(event)

    # -- drawing ------------------------------------------------------------------------------------

    def paintEvent(self, event: QPaintEvent) -> None:  # noqa: N802
        """Draw the cards, the text without cards, and where a dragged card would be put."""
        super().paintEvent(event)
        painter = QPainter(self.viewport())
        if not self.cards:
            painter.setPen(QColor(self._style.dim))
            flags = int(Qt.AlignmentFlag.AlignVCenter) | int(Qt.TextFlag.TextWordWrap)
            painter.drawText(self.viewport().rect().adjusted(4, 4, -4, -4), flags, self._empty)
        if self._drop is not None:
            before = self._drop + (self._drop > self.currentRow())
            x = self.card(before).left() if before < len(self.cards) else self.card(before - 1).right()
            painter.setPen(QPen(QColor(self._style.accent), 3))
            painter.drawLine(x, 2, x, self.height() - 2)


def paint_head(painter: QPainter, place: QRectF, head: HeadOrientation, colours: Style) -> None:
    """Draw a small head as the pad shows it: left is left, and the nose points where the head looks."""
    radius = FACE * min(place.width(), place.height())
    yaw, pitch = math.radians(head.yaw), math.radians(head.pitch)
    painter.save()
    painter.translate(place.center())
    painter.rotate(head.roll)
    painter.setPen(QPen(QColor(colours.edge), 1.5))
    painter.setBrush(QColor(colours.panel))
    for side in (-1, 1):
        x = side * radius * math.cos(yaw)
        painter.drawEllipse(QPointF(x, 0), radius * 0.16, radius * 0.24)
    painter.drawEllipse(QPointF(0, 0), radius * 0.92, radius)

    def on_face(left: float, up: float) -> QPointF | None:
        """Return the place of a point of the face (deg from its middle); None behind the head."""
        turned, raised = yaw + math.radians(left), math.radians(up) - pitch
        if math.cos(turned) * math.cos(raised) < 0:
            return None
        return QPointF(-radius * 0.92 * math.sin(turned) * math.cos(raised), -radius * math.sin(raised))

    painter.setPen(Qt.PenStyle.NoPen)
    painter.setBrush(QColor(colours.text))
    for left in (28.0, -28.0):
        if (eye := on_face(left, 18.0)) is not None:
            painter.drawEllipse(eye, radius * 0.15, radius * 0.15)
    nose, tips = on_face(0.0, -12.0), (on_face(9.0, -18.0), on_face(-9.0, -18.0), on_face(0.0, 4.0))
    if nose is not None and None not in tips:
        painter.setBrush(QColor(colours.accent))
        painter.drawPolygon(QPolygonF([tip for tip in tips if tip is not None]))
    painter.restore()
