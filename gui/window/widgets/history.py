"""Requests of this window and of other seats, to send again or to copy as Python; and the program made of them."""

from __future__ import annotations

from PyQt5.QtCore import QSignalBlocker, Qt, pyqtSignal
from PyQt5.QtGui import QColor, QFontDatabase, QGuiApplication
from PyQt5.QtWidgets import QFileDialog, QListWidget, QListWidgetItem, QSizePolicy, QWidget

from gui.console.state.actions import NEW, WriteFile
from gui.console.state.intents import Repeat, Theme
from gui.console.state.views import CodeLine, CodeView, HistoryRowView
from gui.console.texts import Texts
from gui.window.theme import style_of
from gui.window.widgets.controls import (
    NO_MARGINS,
    Panel,
    in_column,
    in_row,
    label,
    plain_button,
    set_role,
)
from gui.window.widgets.files import FilePanel


class HistoryPanel(Panel):
    """The list of requests, newest first."""

    row_chosen = pyqtSignal(int)
    """number of the row that the user has selected"""

    def __init__(self, texts: Texts) -> None:
        super().__init__()
        self._rows: tuple[HistoryRowView, ...] = ()
        self._style = style_of(Theme.DARK)
        self._hint = texts("label.history_hint")
        self.list = rows_list(texts("label.history"))
        self.empty = label(texts("label.history_empty"), "dim", wrap=True)
        self.details = label(wrap=True)
        """time, seat and result of the selected row"""
        self.details.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Preferred)
        self.repeat = plain_button(texts("label.repeat"), texts("tip.repeat"))
        self.python = plain_button(texts("label.copy_python"), texts("tip.copy_python"))
        self.uses = QWidget()
        """what can be done with the selected row"""
        in_column(self.details, self.repeat, self.python, gap=4, margins=NO_MARGINS, inside=self.uses)
        in_column(self.empty, (self.list, 1), self.uses, gap=4, margins=(6, 6, 6, 6), inside=self)
        self.repeat.clicked.connect(self._repeat)
        self.python.clicked.connect(self._copy)
        self.list.currentRowChanged.connect(self._report_row)
        self.list.itemActivated.connect(self._repeat)
        self._fill()

    def show_view(self, rows: tuple[HistoryRowView, ...]) -> None:
        """Show the rows; the selected one stays selected while it exists."""
        if rows != self._rows:
            chosen, self._rows = self._chosen(), rows
            self._fill(chosen)

    def show_theme(self, theme: Theme) -> None:
        """Use the colours of a theme."""
        self._style = style_of(theme)
        self._fill(self._chosen())

    def choose(self, number: int) -> None:
        """Select the row of this number, unless it is no longer shown."""
        select(self.list, [row.row == number >= 0 for row in self._rows])
        self._show_buttons()

    def _report_row(self) -> None:
        self._show_buttons()
        chosen = self._chosen()
        if chosen is not None:
            self.row_chosen.emit(chosen.row)

    def _fill(self, chosen: HistoryRowView | None = None) -> None:
        with QSignalBlocker(self.list):
            self.list.clear()
            for row in self._rows:
                self.list.addItem(self._item(row))
        same = None if chosen is None else (chosen.row, chosen.time, chosen.what)
        select(self.list, [(row.row, row.time, row.what) == same for row in self._rows])
        self.empty.setVisible(not self._rows)
        self.list.setVisible(bool(self._rows))
        self.uses.setVisible(bool(self._rows))
        self._show_buttons()

    def _item(self, row: HistoryRowView) -> QListWidgetItem:
        who = "" if row.row >= 0 else f"{row.who}: "
        item = QListWidgetItem(f"{row.symbol} {who}{row.what}")
        colours = {True: self._style.text, False: self._style.bad, None: self._style.dim}
        item.setForeground(QColor(colours[None if row.on_purpose else row.good]))
        item.setToolTip("\n".join(line for line in (_details(row), row.python) if line))
        return item

    def _chosen(self) -> HistoryRowView | None:
        number = self.list.currentRow()
        return self._rows[number] if 0 <= number < len(self._rows) else None

    def _show_buttons(self) -> None:
        chosen = self._chosen()
        self.details.setText(self._hint if chosen is None else _details(chosen))
        set_role(self.details, "role", "dim" if chosen is None else "")
        self.repeat.setEnabled(chosen is not None and chosen.row >= 0)
        self.python.setEnabled(chosen is not None and bool(chosen.python))

    def _repeat(self) -> None:
        chosen = self._chosen()
        if chosen is not None and chosen.row >= 0:
            self.intent.emit(Repeat(chosen.row))

    def _copy(self) -> None:
        chosen = self._chosen()
        if chosen is not None:
            copy(chosen.python)


def rows_list(name: str) -> QListWidget:
    """Return an empty list of rows."""
    made = QListWidget()
    made.setAccessibleName(name)
    made.setMinimumHeight(40)
    made.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
    return made


def select(rows: QListWidget, wanted: list[bool]) -> None:
    """Select the first wanted row, or none, without a signal."""
    with QSignalBlocker(rows):
        rows.setCurrentRow(wanted.index(True) if True in wanted else -1)


def copy(text: str) -> None:
    """Put a text into the clipboard."""
    clipboard = QGuiApplication.clipboard()
    if clipboard is not None:
        clipboard.setText(text)


def _details(row: HistoryRowView) -> str:
    return f"{row.time}  {row.who}: {row.what}\n{row.symbol} {row.result}"


class CodePanel(FilePanel):
    """The lines of the program; a line is tied to the row of the history that it sends."""

    row_chosen = pyqtSignal(int)
    """number of the row of the history whose line the user has selected"""

    def __init__(self, texts: Texts) -> None:
        super().__init__(texts)
        self._view = CodeView()
        self.list = rows_list(texts("label.code"))
        self.list.setWordWrap(True)  # a line is wider than the panel
        self.list.setFont(QFontDatabase.systemFont(QFontDatabase.SystemFont.FixedFont))
        self.list.currentRowChanged.connect(self._report_row)
        self.copy, self.save = (
            plain_button(texts(f"code.{name}"), texts(f"code.{name}_tip"), texts(f"code.{name}_name"))
            for name in ("copy", "save")
        )
        self.copy.clicked.connect(lambda: copy(self._view.text))
        self.save.clicked.connect(self._choose_file)
        buttons = in_row((self.copy, 1), (self.save, 1), gap=4)
        hint = label(texts("label.code_hint"), "dim", wrap=True)
        in_column(hint, (self.list, 1), buttons, gap=4, margins=(6, 6, 6, 6), inside=self)

    def show_view(self, view: CodeView) -> None:
        """Show the program; the lines of the selected row stay selected, and new lines at the end become visible."""
        chosen, self._view = self._chosen().row, view
        with QSignalBlocker(self.list):
            self.list.clear()
            self.list.addItems([line.text for line in view.lines])
        self.list.scrollToBottom()
        self.choose(chosen)

    def choose(self, row: int) -> None:
        """Select the first line of a row of the history; none if the program has no such line."""
        select(self.list, [line.row == row > 0 for line in self._view.lines])

    def _chosen(self) -> CodeLine:
        number = self.list.currentRow()
        return self._view.lines[number] if 0 <= number < len(self._view.lines) else CodeLine("")

    def _report_row(self) -> None:
        if self._chosen().row:
            self.row_chosen.emit(self._chosen().row)

    def _choose_file(self) -> None:
        save = QFileDialog.AcceptMode.AcceptSave
        self.choose_file(
            self._texts("code.save_name"), save, "py", lambda file: WriteFile(NEW, file, self._view.text)
        )
