"""What each seat of the class has reached in the lessons, as a table."""

from __future__ import annotations

from html import escape

from PyQt5.QtWidgets import QFrame

from gui.console.state.intents import Theme
from gui.console.state.lessons import SYMBOLS, LessonRowView, LessonsView, Progress
from gui.console.texts import Texts
from gui.window.theme import style_of
from gui.window.widgets.controls import in_column, label, set_text
from gui.window.widgets.table import Table, TableRow

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
        set_text(self.empty, view.empty)
        set_text(self.notice, view.notice)
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
