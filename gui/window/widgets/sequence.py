"""The sequence editor: the strip of poses with its buttons."""

from __future__ import annotations

from collections.abc import Sequence

from PyQt5.QtCore import QPoint, QRect, QSignalBlocker, QSize, Qt, pyqtSignal
from PyQt5.QtGui import QColor, QIcon, QKeyEvent, QMouseEvent, QPainter, QPaintEvent, QPen, QPixmap
from PyQt5.QtWidgets import (
    QApplication,
    QGridLayout,
    QLineEdit,
    QListWidget,
    QListWidgetItem,
    QSizePolicy,
    QWidget,
)

from gui.console.state import intents
from gui.console.state.intents import HeadOrientation, Theme
from gui.console.state.music import SetNote
from gui.console.state.saved import DURATION_MAX_S
from gui.console.state.views import CardView, SequenceView
from gui.console.texts import Texts
from gui.window.theme import style_of
from gui.window.widgets.controls import (
    NO_MARGINS,
    ChoiceCheck,
    IntentButton,
    Panel,
    in_row,
    named,
    plain_button,
    spaced,
)
from gui.window.widgets.head3d_paint import portrait
from gui.window.widgets.music import MusicMenu, paint_beats
from gui.window.widgets.number_box import NumberBox

NAME_LONGEST = 24
NAME_PX = 90
WIDTH_PX, HEIGHT_PX, PICTURE_PX = 70, 92, 48
"""Size of a card, and side of its picture, at scale 1."""


class Strip(QListWidget):
    """Cards to select, to drag to another place, and to use with the keyboard."""

    used = pyqtSignal(int)
    """a click or Enter on this card"""
    moved = pyqtSignal(int, int)
    """a card, and its new place counted without it"""
    deleted = pyqtSignal(int)

    def __init__(self, name: str, empty: str, notes: Sequence[str]) -> None:
        """Create an empty strip; `empty` is its text while it has no card, `notes` are the names of the tones."""
        super().__init__()
        self._empty = empty
        self.setAccessibleName(name)
        self.setViewMode(QListWidget.ViewMode.IconMode)
        self.setMovement(QListWidget.Movement.Static)
        self.setWrapping(False)
        self.setVerticalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.setMinimumWidth(80)
        self.cards: tuple[CardView, ...] = ()
        self._played, self._facing = -1, True
        self._style = style_of(Theme.DARK)
        self._notes = notes
        self._pressed: QPoint | None = None
        self._drop: int | None = None
        """while a card is dragged: its place counted without it"""

    def show_cards(
        self, cards: tuple[CardView, ...], current: int, played: int = -1, *, facing: bool = True
    ) -> None:
        """Show the cards; numbers of the selected one and of the one that is being played (-1: none)."""
        if (cards, played, facing) != (self.cards, self._played, self._facing):
            self.cards, self._played, self._facing = cards, played, facing
            self._fill()
        with QSignalBlocker(self):
            self.setCurrentRow(current)
        self.scrollTo(self.model().index(played if played >= 0 else current, 0))

    def show_theme(self, theme: Theme) -> None:
        """Use the colours and sizes of a theme."""
        self._style = style_of(theme)
        self.setGridSize(QSize(self._style.px(WIDTH_PX), self._style.px(HEIGHT_PX)))
        self.setIconSize(QSize(self._style.px(PICTURE_PX), self._style.px(PICTURE_PX)))
        self._fill()

    def _fill(self) -> None:
        """Make all cards; the selected place stays selected."""
        current, self._pressed, self._drop = self.currentRow(), None, None
        with QSignalBlocker(self):
            self.clear()
            for number, card in enumerate(self.cards):
                mark = "▸" if number == self._played else ""
                tone = self._notes[card.note - 1] if card.note else ""
                item = QListWidgetItem(
                    self._icon(card), f"{mark}{card.name}\n{card.duration} {tone}".rstrip()
                )
                item.setToolTip("\n".join(filter(None, (f"{card.name}, {card.duration}", card.problem))))
                if card.problem:
                    item.setForeground(QColor(self._style.bad))
                self.addItem(item)
            self.setCurrentRow(current)

    def _icon(self, card: CardView) -> QIcon:
        head = None if card.head is None else HeadOrientation(*card.head.tenths)
        side, ratio = self._style.px(PICTURE_PX), self.devicePixelRatioF()
        picture = QPixmap.fromImage(portrait(head, side, ratio, facing=self._facing))
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
        for number, card in enumerate(self.cards):
            paint_beats(painter, self.card(number), card.beats, self._style)
        if self._drop is not None:
            before = self._drop + (self._drop > self.currentRow())
            x = self.card(before).left() if before < len(self.cards) else self.card(before - 1).right()
            painter.setPen(QPen(QColor(self._style.accent), 3))
            painter.drawLine(x, 2, x, self.height() - 2)


class SequencePanel(Panel):
    """Poses with durations: to add, order, change and play."""

    def __init__(self, texts: Texts) -> None:
        super().__init__()
        self._view: SequenceView | None = None
        self.strip = Strip(
            texts("label.sequence"), texts("label.sequence_empty"), texts("music.notes").split()
        )
        self.name = named(QLineEdit(), texts("label.pose_name"), texts("tip.pose_name"))
        self.name.setMaxLength(NAME_LONGEST)
        self.name.setPlaceholderText(texts("label.pose_name"))
        self.name.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Fixed)  # cards need the width
        box = NumberBox(texts, texts("label.lead_unit"), 0.1)
        self.duration = named(box, texts("label.duration"), texts("tip.duration"))
        self.duration.setMaximum(DURATION_MAX_S)
        self.duration.setSingleStep(0.5)
        self.add, self.play, self.hardware = self.button(), self.button(main=True), self.button()
        self.delete = plain_button("✕", texts("sequence.delete_tip"), texts("sequence.delete"))
        self.duplicate = plain_button("❐", texts("sequence.duplicate"), texts("sequence.duplicate"))
        self.undo = plain_button("↶", texts("sequence.undo_tip"), texts("sequence.undo"))
        self.loop, self.music = ChoiceCheck(texts, "loop"), MusicMenu(texts)
        self.gesture = IntentButton()
        """its intent goes to the gestures, which ask for name and emoji"""
        timed = QWidget()
        in_row((self.duration, 1), self.music, gap=3, margins=NO_MARGINS, inside=timed)
        lines = (
            (self.name, timed),
            (self.add, self.gesture),
            (self.loop, self.delete, self.duplicate, self.undo),
            (self.play, self.hardware),
        )
        grid = spaced(QGridLayout(), 3)
        grid.setColumnMinimumWidth(0, NAME_PX)
        for line, (left, *right) in enumerate(lines):
            grid.addWidget(left, line, 0)
            for number, part in enumerate(right):
                grid.addWidget(part, line, 1 + number, 1, 3 // len(right))
        in_row((self.strip, 1), grid, gap=6, margins=(4, 4, 4, 4), inside=self)
        self._connect()

    def _connect(self) -> None:
        self.reports(self.loop.intent)
        self.delete.clicked.connect(lambda: self._about(intents.DeletePose))
        self.strip.currentRowChanged.connect(self._show_chosen)
        self.strip.used.connect(self._aim)
        self.strip.moved.connect(
            lambda number, to: self.intent.emit(intents.MovePose(self.strip.cards[number].name, to))
        )
        self.strip.deleted.connect(lambda: self._about(intents.DeletePose))
        self.duration.valueChanged.connect(self._report_duration)
        self.music.noted.connect(self._set_note)
        self.name.editingFinished.connect(self._rename)
        self.duplicate.clicked.connect(lambda: self._about(intents.DuplicatePose))
        self.undo.clicked.connect(lambda: self.intent.emit(intents.UndoSequence()))

    # -- what it shows ------------------------------------------------------------------------------

    def show_view(self, view: SequenceView) -> None:
        """Show the poses; the selected one stays selected while it exists, and a new one is selected."""
        before, self._view = self._view, view
        self.strip.show_cards(view.cards, self._selection(before, view), view.played, facing=view.facing)
        self.add.show_view(view.add)
        self.play.show_view(view.play)
        self.hardware.show_view(view.hardware)
        self.gesture.show_view(view.gesture)
        self.loop.setEnabled(view.played < 0)
        self.undo.setEnabled(view.undo.enabled)
        self._show_chosen()

    def _selection(self, before: SequenceView | None, view: SequenceView) -> int:
        """Return the card to select: a new one, else the same, else the one at its place."""
        names = [card.name for card in view.cards]
        known = names[1:] if before is None else [card.name for card in before.cards]
        new, chosen = [name for name in names if name not in known], self._chosen()
        if len(new) == 1:
            return names.index(new[0])
        if chosen is not None and chosen.name in names:
            return names.index(chosen.name)
        return min(max(0, self.strip.currentRow()), len(names) - 1)

    def show_theme(self, theme: Theme) -> None:
        """Use the colours and sizes of a theme."""
        self.strip.show_theme(theme)

    def _chosen(self) -> CardView | None:
        number = self.strip.currentRow()
        return self.strip.cards[number] if 0 <= number < len(self.strip.cards) else None

    def _show_chosen(self) -> None:
        """Show name, duration and problem of the selected pose."""
        card, view = self._chosen(), self._view
        for part in (self.name, self.duration, self.delete, self.duplicate):
            part.setEnabled(card is not None)
        self.music.show_card(card)
        if view is None:
            return
        with QSignalBlocker(self.name), QSignalBlocker(self.duration):
            if not self.name.hasFocus() or card is None or not self.name.isModified():
                self.name.setText("" if card is None else card.name)
            duration_s = self.duration.value() if card is None else round(card.duration_s, 1)
            if duration_s != self.duration.value():  # else it would replace what the user is typing
                self.duration.setValue(duration_s)

    # -- what the user does -------------------------------------------------------------------------

    def _about(self, kind: type[intents.DuplicatePose | intents.DeletePose]) -> None:
        card = self._chosen()
        if card is not None:
            self.intent.emit(kind(card.name))

    def _aim(self, number: int) -> None:
        """Make a pose the target of the pad; nothing is sent."""
        head = self.strip.cards[number].head
        if head is not None:
            self.intent.emit(intents.AimHead(head.yaw, head.pitch, head.roll))

    def _report_duration(self, seconds: float) -> None:
        card = self._chosen()
        if card is not None:
            self.intent.emit(intents.SetDuration(card.name, seconds))

    def _set_note(self, note: int) -> None:
        card = self._chosen()
        if card is not None:
            self.intent.emit(SetNote(card.name, note))

    def _rename(self) -> None:
        card, name = self._chosen(), self.name.text()
        self.name.setModified(False)
        if card is not None and name and name != card.name:
            self.intent.emit(intents.RenamePose(card.name, name))
