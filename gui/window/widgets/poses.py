"""Saved poses and choreographies."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from PyQt5.QtCore import pyqtSignal
from PyQt5.QtWidgets import (
    QFileDialog,
    QGridLayout,
    QLineEdit,
    QListWidget,
    QVBoxLayout,
    QWidget,
)

from gui.console.state.intents import DeletePose, GoToPose, PlayFile, SaveChoreography, SavePose
from gui.console.state.views import ButtonView, PosesView
from gui.console.texts import Texts
from gui.window.widgets.controls import IntentButton, label, set_text
from gui.window.widgets.files import FileDialog


class AskingButton(IntentButton):
    """A button whose intent needs a name or a file: it calls `ask` instead of reporting the intent of its view."""

    def __init__(self, ask: Callable[[], None]) -> None:
        super().__init__()
        self.clicked.disconnect()
        self.clicked.connect(lambda: ask())  # noqa: PLW0108 - `clicked` has an argument


class PosesPanel(QWidget):
    """The list of poses, with buttons to go to, save and delete a pose, to play all or a file, and to write a file."""

    intent = pyqtSignal(object)

    def __init__(self, texts: Texts) -> None:
        super().__init__()
        self._texts = texts
        self._view: PosesView | None = None
        self.dialog: FileDialog | None = None
        self.list = QListWidget()
        self.list.setAccessibleName(texts("label.poses"))
        self.list.setMinimumHeight(40)
        self.list.itemActivated.connect(self._go)
        self.empty = label(texts("label.poses_empty"), "dim", wrap=True)
        self.name = QLineEdit()
        self.name.setPlaceholderText(texts("label.pose_name"))
        self.name.setAccessibleName(texts("label.pose_name"))
        self.name.setToolTip(texts("tip.pose_name"))
        self.name.returnPressed.connect(self._save)
        self.go, self.delete = AskingButton(self._go), AskingButton(self._delete)
        self.save = AskingButton(self._save)
        self.play = IntentButton()
        self.play_file, self.save_file = AskingButton(self._choose_file), AskingButton(self._choose_target)
        self.play.intent.connect(self.intent)
        self.playing = label(role="title", wrap=True)
        self._lay_out()

    def _lay_out(self) -> None:
        grid = QGridLayout()
        grid.setSpacing(4)
        grid.addWidget(self.name, 0, 0)
        grid.addWidget(self.save, 0, 1)
        grid.addWidget(self.go, 1, 0)
        grid.addWidget(self.delete, 1, 1)
        grid.addWidget(self.play, 2, 0)
        grid.addWidget(self.play_file, 2, 1)
        grid.addWidget(self.save_file, 3, 0, 1, 2)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(6, 6, 6, 6)
        layout.setSpacing(4)
        layout.addWidget(self.playing)
        layout.addWidget(self.empty)
        layout.addWidget(self.list, 1)
        layout.addLayout(grid)

    def show_view(self, view: PosesView) -> None:
        """Show the poses; the selected one stays selected while it exists."""
        if view == self._view:
            return
        if self._view is None or view.names != self._view.names:
            self._fill(view.names)
        self._view = view
        self.empty.setVisible(not view.names)
        self.list.setVisible(bool(view.names))
        set_text(self.playing, view.playing)
        self.playing.setVisible(bool(view.playing))
        shown: list[tuple[IntentButton, ButtonView]] = [
            (self.go, view.go),
            (self.save, view.save),
            (self.delete, view.delete),
            (self.play, view.play),
            (self.play_file, view.play_file),
            (self.save_file, view.save_file),
        ]
        for button, button_view in shown:
            button.show_view(button_view)

    def _fill(self, names: tuple[str, ...]) -> None:
        chosen = self._chosen()
        self.list.clear()
        self.list.addItems(list(names))
        if names:
            self.list.setCurrentRow(names.index(chosen) if chosen in names else 0)

    def _chosen(self) -> str:
        item = self.list.currentItem()
        return "" if item is None else item.text()

    def _go(self) -> None:
        if self._chosen():
            self.intent.emit(GoToPose(self._chosen()))

    def _delete(self) -> None:
        if self._chosen():
            self.intent.emit(DeletePose(self._chosen()))

    def _save(self) -> None:
        self.intent.emit(SavePose(self.name.text()))
        self.name.clear()

    def _choose_file(self) -> None:
        self._open_dialog("choose_file", QFileDialog.AcceptMode.AcceptOpen, PlayFile)

    def _choose_target(self) -> None:
        self._open_dialog("save_file", QFileDialog.AcceptMode.AcceptSave, SaveChoreography)

    def _open_dialog(
        self,
        title: str,
        mode: QFileDialog.AcceptMode,
        intent: Callable[[Path], PlayFile | SaveChoreography],
    ) -> None:
        """Open a file dialog, which closes with this widget; STOP works while it is open."""
        if self.dialog is not None:
            self.dialog.destroyed.disconnect(self._forget_dialog)
            self.dialog.close()
        dialog = FileDialog(self._texts, self, self._texts(f"label.{title}"), mode)
        dialog.fileSelected.connect(lambda file: self.intent.emit(intent(Path(file))))
        dialog.destroyed.connect(self._forget_dialog)
        self.dialog = dialog
        dialog.show()

    def _forget_dialog(self) -> None:
        self.dialog = None
