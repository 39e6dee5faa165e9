"""The pane Code: the program so far, to copy and to save."""

from __future__ import annotations

from PyQt5.QtCore import QSignalBlocker, Qt, pyqtSignal
from PyQt5.QtGui import QFontDatabase, QGuiApplication
from PyQt5.QtWidgets import QFileDialog, QHBoxLayout, QListWidget, QPushButton, QVBoxLayout

from gui.console.state.program import SaveProgram
from gui.console.state.views import CodeLine, CodeView
from gui.console.texts import Texts
from gui.window.widgets.controls import label, plain_button, spaced
from gui.window.widgets.files import FilePanel


class CodePanel(FilePanel):
    """The lines of the program; a line is tied to the row of the history that it sends."""

    row_chosen = pyqtSignal(int)
    """number of the row of the history whose line the user has selected"""

    def __init__(self, texts: Texts) -> None:
        super().__init__(texts)
        self._view = CodeView()
        self.list = QListWidget()
        self.list.setAccessibleName(texts("label.code"))
        self.list.setMinimumHeight(40)
        self.list.setWordWrap(True)  # a line is wider than the panel
        self.list.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.list.setFont(QFontDatabase.systemFont(QFontDatabase.SystemFont.FixedFont))
        self.list.currentRowChanged.connect(self._report_row)
        self.copy = self._button(texts, "copy")
        self.save = self._button(texts, "save")
        buttons = spaced(QHBoxLayout(), 4)
        buttons.addWidget(self.copy, 1)
        buttons.addWidget(self.save, 1)
        layout = spaced(QVBoxLayout(self), 4, (6, 6, 6, 6))
        layout.addWidget(label(texts("label.code_hint"), "dim", wrap=True))
        layout.addWidget(self.list, 1)
        layout.addLayout(buttons)
        self.copy.clicked.connect(self._copy)
        self.save.clicked.connect(self._choose_file)

    @staticmethod
    def _button(texts: Texts, name: str) -> QPushButton:
        return plain_button(texts(f"code.{name}"), texts(f"code.{name}_tip"), texts(f"code.{name}_name"))

    def show_view(self, view: CodeView) -> None:
        """Show the program; the lines of the selected row stay selected, and new lines at the end become visible."""
        if view == self._view:
            return
        chosen = self._chosen().row
        kept = _alike_at_the_start(self._view.lines, view.lines)
        self._view = view
        with QSignalBlocker(self.list):
            while self.list.count() > kept:
                self.list.takeItem(self.list.count() - 1)
            for line in view.lines[kept:]:
                self.list.addItem(line.text)
                added = self.list.item(self.list.count() - 1)
                if added is not None:
                    added.setToolTip(line.text.strip())
        self.list.scrollToBottom()
        self.choose(chosen)

    def choose(self, row: int) -> None:
        """Select the first line of a row of the history; none if the program has no such line."""
        numbers = [number for number, line in enumerate(self._view.lines) if row > 0 and line.row == row]
        with QSignalBlocker(self.list):
            self.list.setCurrentRow(numbers[0] if numbers else -1)

    def _chosen(self) -> CodeLine:
        number = self.list.currentRow()
        return self._view.lines[number] if 0 <= number < len(self._view.lines) else CodeLine("")

    def _report_row(self) -> None:
        if self._chosen().row:
            self.row_chosen.emit(self._chosen().row)

    def _copy(self) -> None:
        clipboard = QGuiApplication.clipboard()
        if clipboard is not None:
            clipboard.setText(self._view.text)

    def _choose_file(self) -> None:
        save = QFileDialog.AcceptMode.AcceptSave
        self.choose_file(self._texts("code.save_name"), save, "py", SaveProgram)


def _alike_at_the_start(one: tuple[CodeLine, ...], other: tuple[CodeLine, ...]) -> int:
    """Return how many lines at the start of both are equal."""
    pairs = zip(one, other, strict=False)
    return next((count for count, (a, b) in enumerate(pairs) if a != b), min(len(one), len(other)))
