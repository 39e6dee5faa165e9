"""The sequence editor: the strip of poses with its buttons, and the dialogs for its files."""

from __future__ import annotations

from pathlib import Path

from PyQt5.QtCore import QSignalBlocker
from PyQt5.QtWidgets import (
    QAction,
    QFileDialog,
    QGridLayout,
    QHBoxLayout,
    QLineEdit,
    QMenu,
    QPushButton,
    QSizePolicy,
)

from beatrix_zenoh import files
from beatrix_zenoh.contract.errors import WrongUsage
from gui.console.state.actions import LARGEST_BYTES, NEW, Play
from gui.console.state.intents import (
    AimHead,
    DeletePose,
    DuplicatePose,
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
from gui.window.widgets.controls import ChoiceCheck, IntentButton, filled, plain_button, spaced
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
        self.name = QLineEdit()
        self.name.setMaxLength(NAME_LONGEST)
        self.name.setPlaceholderText(texts("label.pose_name"))
        self.name.setAccessibleName(texts("label.pose_name"))
        self.name.setToolTip(texts("tip.pose_name"))
        self.duration = NumberBox(texts, texts("label.lead_unit"), 0.1)
        self.duration.setMaximum(DURATION_MAX_S)
        self.duration.setSingleStep(0.5)
        self.duration.setAccessibleName(texts("label.duration"))
        self.duration.setToolTip(texts("tip.duration"))
        self.add, self.play, self.hardware = IntentButton(), IntentButton(main=True), IntentButton()
        self.delete, self.more = self._button("delete"), self._button("more")
        self.loop = ChoiceCheck(texts, "loop")
        self.entries: dict[str, QAction] = {}
        """entries of the menu More"""
        self._lay_out()
        self._connect()

    def _button(self, name: str) -> QPushButton:
        return plain_button(self._texts(f"sequence.{name}"), self._texts(f"sequence.{name}_tip"))

    def _lay_out(self) -> None:
        self.name.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Fixed)  # cards need the width
        grid = spaced(QGridLayout(), 3)
        grid.setColumnMinimumWidth(0, NAME_PX)
        for row, pair in enumerate(
            (
                (self.name, self.duration),
                (self.add, self.delete),
                (self.loop, self.more),
                (self.play, self.hardware),
            )
        ):
            for column, part in enumerate(pair):
                grid.addWidget(part, row, column)
        filled(spaced(QHBoxLayout(self), 6, (4, 4, 4, 4)), (self.strip, 1), grid)

    def _connect(self) -> None:
        for button in (self.add, self.play, self.hardware):
            button.intent.connect(self.intent)
        self.loop.intent.connect(self.intent)
        self.delete.clicked.connect(lambda: self._about(DeletePose))
        self.strip.currentRowChanged.connect(self._show_chosen)
        self.strip.used.connect(self._aim)
        self.strip.moved.connect(self._move)
        self.strip.deleted.connect(lambda: self._about(DeletePose))
        self.duration.valueChanged.connect(self._report_duration)
        self.name.editingFinished.connect(self._rename)
        for name, do in (
            ("duplicate", lambda: self._about(DuplicatePose)),
            ("undo", lambda: self.intent.emit(UndoSequence())),
        ):
            entry = self.entries[name] = QAction(self._texts(f"sequence.{name}"), self)
            entry.triggered.connect(do)
        save = QFileDialog.AcceptMode.AcceptSave
        for name, mode, suffix, made in (
            ("open", QFileDialog.AcceptMode.AcceptOpen, "csv", _opened),
            ("save_file", save, "csv", SaveSequence),
            ("save_program", save, "py", lambda file: SaveSequence(file, program=True)),
            ("play_file", QFileDialog.AcceptMode.AcceptOpen, "csv", lambda file: Play(NEW, (), file)),
        ):
            entry = self.entries[name] = QAction(self._texts(f"sequence.{name}"), self)
            entry.triggered.connect(
                lambda _checked, name=name, mode=mode, suffix=suffix, made=made: self.choose_file(
                    self._texts(f"sequence.{name}"), mode, suffix, made
                )
            )
        menu = QMenu(self.more)
        menu.addActions(self.entries.values())
        self.more.setMenu(menu)

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
        if before is None:
            return 0 if names else -1
        known = [card.name for card in before.cards]
        new = [number for number, name in enumerate(names) if name not in known]
        if len(new) == 1:
            return new[0]
        chosen = self._chosen()
        if chosen is not None and chosen.name in names:
            return names.index(chosen.name)
        return max(0, min(self.strip.currentRow(), len(names) - 1)) if names else -1

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

    def _move(self, number: int, to: int) -> None:
        self.intent.emit(MovePose(self.strip.cards[number].name, to))

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
