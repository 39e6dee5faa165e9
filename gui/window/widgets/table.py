"""A table of robots or seats, and that of the lessons: what each seat of the class has reached."""

from __future__ import annotations

from collections.abc import Container, Mapping, Sequence
from dataclasses import dataclass, field
from html import escape

from PyQt5.QtCore import QSignalBlocker, Qt
from PyQt5.QtGui import QColor
from PyQt5.QtWidgets import QFrame, QHeaderView, QTreeWidget, QTreeWidgetItem

from gui.console.state.intents import Theme
from gui.console.state.lessons import SYMBOLS, LessonRowView, LessonsView, Progress
from gui.console.texts import Texts
from gui.window.theme import style_of
from gui.window.widgets.controls import in_column, label

CENTRE = int(Qt.AlignmentFlag.AlignHCenter | Qt.AlignmentFlag.AlignVCenter)


@dataclass(frozen=True)
class TableRow:
    """One row of a table."""

    key: object
    """what identifies the row"""
    cells: tuple[str, ...]
    tip: str = ""
    """tooltip of all cells; empty: each shows its own text"""
    colours: Mapping[int, str] = field(default_factory=dict)
    """colour of the text, as `#rrggbb`, by column"""


class Table(QTreeWidget):
    """Columns are as wide as their texts; the stretched ones share the rest. A selected row stays selected."""

    def __init__(self, name: str) -> None:
        super().__init__()
        self._header = QHeaderView(Qt.Orientation.Horizontal, self)
        self._header.setStretchLastSection(False)
        self.setHeader(self._header)
        self.setRootIsDecorated(False)
        self.setUniformRowHeights(True)
        self.setAllColumnsShowFocus(True)
        self.setTabKeyNavigation(False)
        self.setAccessibleName(name)
        self.setMinimumHeight(60)
        self._rows: tuple[TableRow, ...] = ()
        self._items: list[QTreeWidgetItem] = []
        self._centred: Container[int] = ()

    @property
    def chosen(self) -> object:
        """The key of the selected row; None: no row is selected."""
        number = self.currentIndex().row()
        return self._rows[number].key if 0 <= number < len(self._rows) else None

    def show_columns(
        self, headings: Sequence[str], tips: Sequence[str], stretched: Container[int], centred: Container[int]
    ) -> None:
        """Show other headings, with their tooltips."""
        heads, self._centred = QTreeWidgetItem(headings), centred
        self.setHeaderItem(heads)
        modes = QHeaderView.ResizeMode
        for column, tip in enumerate(tips):
            heads.setToolTip(column, tip)
            mode = modes.Stretch if column in stretched else modes.ResizeToContents
            self._header.setSectionResizeMode(column, mode)

    def show_rows(self, rows: Sequence[TableRow]) -> None:
        """Show other rows; if the selected one is gone, the first is selected."""
        chosen, keys = self.chosen, [row.key for row in rows]
        with QSignalBlocker(self):
            if keys != [row.key for row in self._rows]:
                self.clear()
                self._items = [QTreeWidgetItem() for _ in rows]
                self.addTopLevelItems(self._items)
                if rows:
                    self.setCurrentItem(self._items[keys.index(chosen) if chosen in keys else 0])
            self._rows = tuple(rows)
            for item, row in zip(self._items, rows, strict=True):
                self._fill(item, row)

    def _fill(self, item: QTreeWidgetItem, row: TableRow) -> None:
        for column, text in enumerate(row.cells):
            item.setText(column, text)
            item.setToolTip(column, row.tip or text)
            if column in self._centred:
                item.setTextAlignment(column, CENTRE)
            if column in row.colours:
                item.setForeground(column, QColor(row.colours[column]))


COLUMNS = ("seat", "lesson", "progress", "passed")
PROGRESS = COLUMNS.index("progress")
PASSED = COLUMNS.index("passed")
ROLES = {
    Progress.NONE: "dim",
    Progress.TRYING: "text",
    Progress.STUCK: "bad",
    Progress.NOT_MEASURED: "warn",
    Progress.PASSED: "good",
    Progress.IMPOSSIBLE: "bad",
}
"""Colour of a `Style` for each progress; symbol and words say the same."""


class LessonsTable(QFrame):
    """Shows a `LessonsView`: a row for each seat, and after its present lesson a mark for each lesson of the class."""

    def __init__(self, texts: Texts) -> None:
        super().__init__()
        self._texts = texts
        self._view: LessonsView | None = None
        self._style = style_of(Theme.DARK)
        self.list = Table(texts("label.lessons"))
        self.list.setAlternatingRowColors(True)
        self.empty, self.notice = label(role="dim", wrap=True), label(role="warn", wrap=True)
        # The table needs all of its width.
        in_column(self.notice, (self.list, 1), (self.empty, 1), margins=(0, 6, 0, 6), inside=self)

    def show_theme(self, theme: Theme) -> None:
        """Use the colours and sizes of a theme."""
        self._style = style_of(theme)
        if self._view is not None:
            self.list.show_rows([self._row(row) for row in self._view.rows])

    def show_view(self, view: LessonsView) -> None:
        """Show the seats; the selected one stays selected."""
        if view == self._view:
            return
        old, self._view = self._view, view
        self.empty.setText(view.empty)
        self.notice.setText(view.notice)
        self.empty.setVisible(not view.rows)
        self.notice.setVisible(bool(view.notice))
        self.list.setVisible(bool(view.rows))
        if old is None or old.columns != view.columns:
            headings = [*(self._texts(f"label.lessons_{name}") for name in COLUMNS), *view.columns]
            tips = ["" for _ in headings]
            tips[PROGRESS] = self._texts("tip.lessons_progress")
            self.list.show_columns(headings, tips, {PROGRESS}, range(PASSED, len(headings)))
        self.list.show_rows([self._row(row) for row in view.rows])

    def _row(self, row: LessonRowView) -> TableRow:
        marks = dict(enumerate(row.marks, len(COLUMNS)))
        colours = {
            column: getattr(self._style, ROLES[mark])
            for column, mark in {PROGRESS: row.progress, **marks}.items()
        }
        details = f"<p style='white-space:pre'>{escape(row.details)}</p>" if row.details else ""
        return TableRow(row.seat, (*row.cells, *(SYMBOLS[mark] for mark in row.marks)), details, colours)
