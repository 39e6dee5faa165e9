"""The sequence editor: the strip of poses with its buttons, and the dialogs for its files."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from PyQt5.QtCore import QSignalBlocker
from PyQt5.QtWidgets import QAction, QFileDialog, QGridLayout, QLineEdit, QMenu, QSizePolicy

from beatrix_zenoh import files
from beatrix_zenoh.contract.errors import WrongUsage
from gui.console.state.actions import LARGEST_BYTES, NEW, Play
from gui.console.state.intents import (
    AimHead,
    DeletePose,
    DuplicatePose,
    Intent,
    MovePose,
    OpenSequence,
    RenamePose,
    SaveSequence,
    SetDuration,
    Theme,
    UndoSequence,
)
from gui.console.state.saved import DURATION_MAX_S
from gui.console.state.views import CardView, SequenceView
from gui.console.texts import Texts
from gui.window.widgets.controls import ChoiceCheck, in_row, named, plain_button, spaced
from gui.window.widgets.files import FilePanel
from gui.window.widgets.number_box import NumberBox
from gui.window.widgets.strip import Strip

NAME_LONGEST = 24
NAME_PX = 90


class SequencePanel(FilePanel):
    """Poses with durations: to add, order, change, play, open and save."""

    def __init__(self, texts: Texts) -> None:
        super().__init__(texts)
        self._view: SequenceView | None = None
        self._shown: tuple[str, float] | None = None
        """the selected pose that the number box shows, and its duration (s)"""
        self.strip = Strip(texts("label.sequence"), texts("label.sequence_empty"))
        self.name = named(QLineEdit(), texts("label.pose_name"), texts("tip.pose_name"))
        self.name.setMaxLength(NAME_LONGEST)
        self.name.setPlaceholderText(texts("label.pose_name"))
        self.name.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Fixed)  # cards need the width
        box = NumberBox(texts, texts("label.lead_unit"), 0.1)
        self.duration = named(box, texts("label.duration"), texts("tip.duration"))
        self.duration.setMaximum(DURATION_MAX_S)
        self.duration.setSingleStep(0.5)
        self.add, self.play, self.hardware = self.button(), self.button(main=True), self.button()
        self.delete, self.more = (
            plain_button(texts(f"sequence.{name}"), texts(f"sequence.{name}_tip"))
            for name in ("delete", "more")
        )
        self.loop = ChoiceCheck(texts, "loop")
        self.entries: dict[str, QAction] = {}
        """entries of the menu More"""
        pairs = (
            (self.name, self.duration),
            (self.add, self.delete),
            (self.loop, self.more),
            (self.play, self.hardware),
        )
        grid = spaced(QGridLayout(), 3)
        grid.setColumnMinimumWidth(0, NAME_PX)
        for line, (left, right) in enumerate(pairs):
            grid.addWidget(left, line, 0)
            grid.addWidget(right, line, 1)
        in_row((self.strip, 1), grid, gap=6, margins=(4, 4, 4, 4), inside=self)
        self._connect()

    def _connect(self) -> None:
        self.reports(self.loop)
        self.delete.clicked.connect(lambda: self._about(DeletePose))
        self.strip.currentRowChanged.connect(self._show_chosen)
        self.strip.used.connect(self._aim)
        self.strip.moved.connect(
            lambda number, to: self.intent.emit(MovePose(self.strip.cards[number].name, to))
        )
        self.strip.deleted.connect(lambda: self._about(DeletePose))
        self.duration.valueChanged.connect(self._report_duration)
        self.name.editingFinished.connect(self._rename)
        self._add_entry("duplicate", lambda: self._about(DuplicatePose))
        self._add_entry("undo", lambda: self.intent.emit(UndoSequence()))
        opens, saves = QFileDialog.AcceptMode.AcceptOpen, QFileDialog.AcceptMode.AcceptSave
        self._add_file("open", opens, "csv", _opened)
        self._add_file("save_file", saves, "csv", SaveSequence)
        self._add_file("save_program", saves, "py", lambda file: SaveSequence(file, program=True))
        self._add_file("play_file", opens, "csv", lambda file: Play(NEW, (), file))
        menu = QMenu(self.more)
        menu.addActions(self.entries.values())
        self.more.setMenu(menu)

    def _add_entry(self, name: str, do: Callable[[], None]) -> None:
        entry = self.entries[name] = QAction(self._texts(f"sequence.{name}"), self)
        entry.triggered.connect(do)

    def _add_file(
        self, name: str, mode: QFileDialog.AcceptMode, suffix: str, made: Callable[[Path], Intent]
    ) -> None:
        """Add an entry that asks for a file, and reports the intent made of it."""
        title = self._texts(f"sequence.{name}")
        self._add_entry(name, lambda: self.choose_file(title, mode, suffix, made))

    # -- what it shows ------------------------------------------------------------------------------

    def show_view(self, view: SequenceView) -> None:
        """Show the poses; the selected one stays selected while it exists, and a new one is selected."""
        if view == self._view:
            return
        before, self._view = self._view, view
        self.strip.show_cards(view.cards, self._selection(before, view), view.played)
        self.add.show_view(view.add)
        self.play.show_view(view.play)
        self.hardware.show_view(view.hardware)
        self.loop.setEnabled(view.played < 0)
        self.entries["undo"].setEnabled(view.undo.enabled)
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
        for part in (self.name, self.duration, self.delete, self.entries["duplicate"]):
            part.setEnabled(card is not None)
        if view is None:
            return
        with QSignalBlocker(self.name), QSignalBlocker(self.duration):
            if not self.name.hasFocus() or card is None or not self.name.isModified():
                self.name.setText("" if card is None else card.name)
            shown = None if card is None else (card.name, card.duration_s)
            if card is not None and shown != self._shown:  # else it would replace what the user is typing
                self.duration.setValue(card.duration_s)
            self._shown = shown

    # -- what the user does -------------------------------------------------------------------------

    def _about(self, kind: type[DuplicatePose | DeletePose]) -> None:
        card = self._chosen()
        if card is not None:
            self.intent.emit(kind(card.name))

    def _aim(self, number: int) -> None:
        """Make a pose the target of the pad; nothing is sent."""
        head = self.strip.cards[number].head
        if head is not None:
            self.intent.emit(AimHead(head.yaw, head.pitch, head.roll))

    def _report_duration(self, seconds: float) -> None:
        card = self._chosen()
        if card is not None:
            self.intent.emit(SetDuration(card.name, seconds))

    def _rename(self) -> None:
        card, name = self._chosen(), self.name.text()
        self.name.setModified(False)
        if card is not None and name and name != card.name:
            self.intent.emit(RenamePose(card.name, name))


def _opened(file: Path) -> OpenSequence:
    """Read a choreography; a file that cannot be read is reported in the intent."""
    try:
        return OpenSequence(file, files.text(file, LARGEST_BYTES, "CSV"))
    except OSError as error:
        return OpenSequence(file, "", error.strerror or str(error))
    except WrongUsage as error:
        return OpenSequence(file, "", error.message.removesuffix("."))
