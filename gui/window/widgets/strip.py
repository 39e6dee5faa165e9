"""The strip of the sequence editor: a card with a small head for each pose, in their order."""

from __future__ import annotations

import math

from PyQt5.QtCore import QEvent, QPoint, QPointF, QRect, QRectF, QSize, Qt, pyqtSignal
from PyQt5.QtGui import QColor, QKeyEvent, QMouseEvent, QPainter, QPaintEvent, QPen, QPolygonF
from PyQt5.QtWidgets import QApplication, QToolTip, QWidget

from gui.console.state.intents import HeadOrientation, Theme
from gui.console.state.views import CardView
from gui.window.theme import Style, style_of

WIDTH_PX, GAP_PX = 66, 4
"""Width of a card, and the gap between cards, at scale 1."""
HEIGHT_PX = 128
"""Largest height of a card, at scale 1."""
FACE = 0.42
"""Radius of a head, as a share of the shorter side of its picture."""
HELP_EVENT = QEvent.Type.ToolTip


class Strip(QWidget):
    """Cards to select, to drag to another place, and to use with the keyboard."""

    chosen = pyqtSignal(int)
    """another card is selected; -1: none"""
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
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.cards: tuple[CardView, ...] = ()
        self.current = self.played = -1
        self._style = style_of(Theme.DARK)
        self._pressed: QPoint | None = None
        self._drop: int | None = None
        """while a card is dragged: its place counted without it"""

    def show_cards(self, cards: tuple[CardView, ...], current: int, played: int = -1) -> None:
        """Show the cards; numbers of the selected one and of the one that is being played (-1: none)."""
        if cards != self.cards:
            self._pressed, self._drop = None, None
        self.cards, self.played = cards, played
        self.current = min(current, len(cards) - 1)
        self.setMinimumWidth(max(1, len(cards)) * self._step)
        shown = cards[self.current] if self.current >= 0 else None
        self.setAccessibleDescription(
            "" if shown is None else f"{shown.name}, {shown.duration}. {shown.problem}"
        )
        self.update()

    def show_theme(self, theme: Theme) -> None:
        """Use the colours and sizes of a theme."""
        self._style = style_of(theme)
        self.show_cards(self.cards, self.current, self.played)

    def choose(self, number: int) -> None:
        """Select a card as the user does."""
        if 0 <= number < len(self.cards) and number != self.current:
            self.current = number
            self.update()
            self.chosen.emit(number)

    @property
    def _step(self) -> int:
        return self._style.px(WIDTH_PX + GAP_PX)

    @property
    def highest(self) -> int:
        """Height (px) above which cards do not grow."""
        return self._style.px(HEIGHT_PX)

    def card(self, number: int) -> QRect:
        """Return the place of a card (px)."""
        height = min(self.height(), self.highest)
        return QRect(number * self._step, 0, self._style.px(WIDTH_PX), height)

    def minimumSizeHint(self) -> QSize:  # noqa: N802
        return QSize(self._step, self._style.px(52))

    def _number_at(self, place: QPoint) -> int:
        number = place.x() // self._step
        return number if 0 <= number < len(self.cards) and self.rect().contains(place) else -1

    # -- mouse --------------------------------------------------------------------------------------

    def mousePressEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        if event.button() == Qt.MouseButton.LeftButton and self._number_at(event.pos()) >= 0:
            self._pressed = event.pos()
            self.choose(self._number_at(event.pos()))

    def mouseMoveEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        pressed = self._pressed
        if pressed is None:
            return
        far = abs(event.pos().x() - pressed.x()) >= QApplication.startDragDistance()
        if far or self._drop is not None:
            gap = max(0, min(len(self.cards), round(event.pos().x() / self._step)))
            self._drop = gap - (gap > self.current)
            self.update()

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        pressed, drop, self._pressed, self._drop = self._pressed, self._drop, None, None
        if event.button() != Qt.MouseButton.LeftButton or pressed is None:
            return
        self.update()
        if drop is None:
            self.used.emit(self.current)
        elif drop != self.current:
            self.moved.emit(self.current, drop)

    def event(self, event: QEvent) -> bool:
        """Show the name and the problem of the card under the mouse as a tooltip."""
        if event.type() == HELP_EVENT:
            place = self.mapFromGlobal(self.cursor().pos())
            number = self._number_at(place)
            card = self.cards[number] if number >= 0 else None
            text = (
                ""
                if card is None
                else "\n".join(filter(None, (f"{card.name}, {card.duration}", card.problem)))
            )
            QToolTip.showText(self.mapToGlobal(place), text, self)
            return True
        return super().event(event)

    # -- keyboard -----------------------------------------------------------------------------------

    def keyPressEvent(self, event: QKeyEvent) -> None:  # noqa: N802
        """Select with the arrows, move with Ctrl and the arrows, use with Enter, delete with Delete."""
        ways = {Qt.Key.Key_Left: -1, Qt.Key.Key_Right: 1}
        key, number = event.key(), self.current
        if key in ways:
            goal = number + ways[Qt.Key(key)]
            if not event.modifiers() & Qt.KeyboardModifier.ControlModifier:
                self.choose(max(0, min(goal, len(self.cards) - 1)))
            elif number >= 0 and 0 <= goal < len(self.cards):
                self.moved.emit(number, goal)
        elif key in {Qt.Key.Key_Home, Qt.Key.Key_End}:
            self.choose(0 if key == Qt.Key.Key_Home else len(self.cards) - 1)
        elif number >= 0 and key in {Qt.Key.Key_Return, Qt.Key.Key_Enter}:
            self.used.emit(number)
        elif number >= 0 and key in {Qt.Key.Key_Delete, Qt.Key.Key_Backspace}:
            self.deleted.emit(number)
        else:
            super().keyPressEvent(event)

    # -- drawing ------------------------------------------------------------------------------------

    def paintEvent(self, _event: QPaintEvent) -> None:  # noqa: N802
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        if not self.cards:
            painter.setPen(QColor(self._style.dim))
            flags = int(Qt.AlignmentFlag.AlignVCenter) | int(Qt.TextFlag.TextWordWrap)
            painter.drawText(self.rect().adjusted(4, 4, -4, -4), flags, self._empty)
        for number, card in enumerate(self.cards):
            self._paint_card(painter, QRectF(self.card(number)).adjusted(1, 1, -1, -1), card, number)
        if self._drop is not None:
            gap = self._drop + (self._drop >= self.current)
            x = max(1.5, gap * self._step - self._style.px(GAP_PX) / 2)
            painter.setPen(QPen(QColor(self._style.accent), 3))
            painter.drawLine(QPointF(x, 2), QPointF(x, self.height() - 2))

    def _paint_card(self, painter: QPainter, place: QRectF, card: CardView, number: int) -> None:
        colours, chosen = self._style, number == self.current
        edge = colours.accent if chosen and self.hasFocus() else colours.edge if chosen else colours.line
        painter.setPen(QPen(QColor(edge), 2 if chosen else 1))
        painter.setBrush(QColor(colours.raised if chosen else colours.field))
        painter.drawRoundedRect(place, 4, 4)
        line = painter.fontMetrics().height()
        picture = place.adjusted(2, 2, -2, -2 * line)
        if number == self.played:
            painter.fillRect(place.adjusted(1, 1, -1, 4 - place.height()), QColor(colours.good))
        if card.head is not None:
            paint_head(painter, picture, card.head, colours)
        inner = place.adjusted(3, 0, -3, -1)
        words = QRectF(inner.left(), inner.bottom() - 2 * line, inner.width(), line)
        middle = int(Qt.AlignmentFlag.AlignCenter)
        painter.setPen(QColor(colours.text))
        name = painter.fontMetrics().elidedText(card.name, Qt.TextElideMode.ElideRight, int(words.width()))
        painter.drawText(words, middle, name)
        painter.setPen(QColor(colours.bad if card.problem else colours.dim))
        painter.drawText(words.translated(0, line), middle, card.duration)


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
