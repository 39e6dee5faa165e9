"""The strip of the sequence editor: a card with a small head for each pose, in their order."""

from __future__ import annotations

from PyQt5.QtCore import QPoint, QRect, QSignalBlocker, QSize, Qt, pyqtSignal
from PyQt5.QtGui import QColor, QIcon, QKeyEvent, QMouseEvent, QPainter, QPaintEvent, QPen, QPixmap
from PyQt5.QtWidgets import QApplication, QListWidget, QListWidgetItem

from gui.console.state.intents import HeadOrientation, Theme
from gui.console.state.views import CardView
from gui.window.theme import style_of
from gui.window.widgets.head3d_paint import portrait

WIDTH_PX, HEIGHT_PX, PICTURE_PX = 70, 92, 48
"""Size of a card, and side of its picture, at scale 1."""


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
        if card.head is None:
            return QIcon()
        head = HeadOrientation(*card.head.tenths)
        picture = QPixmap.fromImage(portrait(head, self._style.px(PICTURE_PX), self.devicePixelRatioF()))
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
