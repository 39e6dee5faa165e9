"""The dialog for files to open and to write, and panels that use it."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from PyQt5.QtWidgets import QFileDialog, QGridLayout, QLineEdit, QWidget

from gui.console.state.intents import Intent
from gui.console.texts import Texts
from gui.window.widgets.controls import Panel, label


class FileDialog(QFileDialog):
    """Qt's own dialog, not modal; shows messages in a line, because a modal box would block clicks on STOP."""

    def __init__(
        self,
        texts: Texts,
        parent: QWidget,
        title: str,
        mode: QFileDialog.AcceptMode,
        suffix: str,
    ) -> None:
        """Create a hidden dialog for files with this suffix."""
        super().__init__(parent, title, ".", texts(f"label.{suffix}_files"))
        self._texts = texts
        self.setOption(QFileDialog.Option.DontUseNativeDialog)
        self.setOption(QFileDialog.Option.DontConfirmOverwrite)
        self.setOption(QFileDialog.Option.ReadOnly)  # no renaming or deleting: they would open modal boxes
        self.setModal(False)
        self.setAcceptMode(mode)
        if mode == QFileDialog.AcceptMode.AcceptOpen:
            self.setFileMode(QFileDialog.FileMode.ExistingFile)
        else:
            self.setDefaultSuffix(suffix)  # Qt adds it only to a name without a dot
            self.selectFile(f"beatrix.{suffix}")
        self.notice = label(role="warn", wrap=True)
        self._overwrites: Path | None = None
        """the existing file that the next press of Overwrite replaces"""
        layout = self.layout()
        if isinstance(layout, QGridLayout):
            layout.addWidget(self.notice, layout.rowCount(), 0, 1, layout.columnCount())
        for field in self.findChildren(QLineEdit):
            field.textChanged.connect(self._clear_notice)
        self._clear_notice()

    def accept(self) -> None:
        """Report the file.

        An existing file is overwritten only at the second press; a missing file cannot be opened.
        """
        writes = self.acceptMode() == QFileDialog.AcceptMode.AcceptSave
        file = Path(next(iter(self.selectedFiles()), ""))
        if file.is_dir() or file.exists() != writes or file == self._overwrites:
            super().accept()
            return
        self.notice.setText(
            self._texts("label.file_exists" if writes else "label.file_missing", file=file.name)
        )
        self.notice.show()
        if writes:
            self._overwrites = file
            self.setLabelText(QFileDialog.DialogLabel.Accept, self._texts("label.file_overwrite"))

    def _clear_notice(self) -> None:
        self._overwrites = None
        self.notice.hide()
        writes = self.acceptMode() == QFileDialog.AcceptMode.AcceptSave
        text = self._texts("label.file_save" if writes else "label.file_open")
        self.setLabelText(QFileDialog.DialogLabel.Accept, text)


class FilePanel(Panel):
    """A panel some of whose intents need a file."""

    def __init__(self, texts: Texts) -> None:
        super().__init__()
        self._texts = texts
        self.dialog: FileDialog | None = None
        """the newest dialog"""

    def choose_file(
        self,
        title: str,
        mode: QFileDialog.AcceptMode,
        suffix: str,
        made: Callable[[Path], Intent],
        folder: Path = Path(),
    ) -> None:
        """Open a file dialog, and report the intent made of its file.

        It closes with this panel, and replaces an open one. STOP works while it is open.
        """
        if self.dialog is not None:
            self.dialog.deleteLater()
        self.dialog = FileDialog(self._texts, self, title, mode, suffix)
        if folder != Path():
            self.dialog.setDirectory(str(folder))
        self.dialog.fileSelected.connect(lambda file: self.intent.emit(made(Path(file))))
        self.dialog.show()
