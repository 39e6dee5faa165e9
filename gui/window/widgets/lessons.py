"""What each seat of the class has reached in the lessons, as a table."""

from __future__ import annotations

from html import escape

from PyQt5.QtCore import Qt
from PyQt5.QtGui import QColor, QResizeEvent
from PyQt5.QtWidgets import QAbstractItemView, QFrame, QTreeWidget, QTreeWidgetItem, QVBoxLayout

from gui.console.state.intents import Theme
from gui.console.state.lessons import SYMBOLS, LessonRowView, LessonsView, Progress
from gui.console.texts import Texts
from gui.window.theme import style_of
from gui.window.widgets.controls import filled, label, set_text, spaced

COLUMNS = ("seat", "lesson", "progress", "passed")
PROGRESS = COLUMNS.index("progress")
PASSED = COLUMNS.index("passed")
WIDTHS_PX = (180, 150, 210, 84)
"""Widths (px) of COLUMNS at scale 1."""
MARK_PX = 34
"""Width (px) of the column of a lesson at scale 1."""
ROLES = {
    Progress.NONE: "dim",
    Progress.TRYING: "text",
    Progress.STUCK: "bad",
    Progress.NOT_MEASURED: "warn",
    Progress.PASSED: "good",
    Progress.IMPOSSIBLE: "bad",
}
"""Colour of a `Style` for each progress; symbol and words say the same."""
CENTRE = int(Qt.AlignmentFlag.AlignHCenter | Qt.AlignmentFlag.AlignVCenter)


def table(name: str) -> QTreeWidget:
    """Return an empty table with this accessible name; `key_of` returns the key of a row."""
    made = QTreeWidget()
    made.setRootIsDecorated(False)
    made.setUniformRowHeights(True)
    made.setAllColumnsShowFocus(True)
    made.setTabKeyNavigation(False)
    made.setAccessibleName(name)
    made.setMinimumHeight(60)
    return made


def key_of(item: QTreeWidgetItem | None) -> object:
    """Return what identifies the row of a table; None without a row."""
    return None if item is None else item.data(0, Qt.ItemDataRole.UserRole)


class LessonsTable(QFrame):
    """Shows a `LessonsView`: a row for each seat, and after its present lesson a mark for each lesson of the class."""

    def __init__(self, texts: Texts) -> None:
        super().__init__()
        self._texts = texts
        self._view: LessonsView | None = None
        self._style = style_of(Theme.DARK)
        self.list = table(texts("label.lessons"))
        self.list.setAlternatingRowColors(True)
        self.list.setEditTriggers(QAbstractItemView.EditTrigger.NoEditTriggers)
        self.empty, self.notice = label(role="dim", wrap=True), label(role="warn", wrap=True)
        # The table needs all of its width.
        filled(spaced(QVBoxLayout(self), None, (0, 6, 0, 6)), self.notice, (self.list, 1), (self.empty, 1))

    def show_theme(self, theme: Theme) -> None:
        """Use the colours and sizes of a theme."""
        self._style = style_of(theme)
        if self._view is not None:
            self._show_columns(self._view.columns)
            self._show_rows(self._view.rows)

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
            self._show_columns(view.columns)
        if old is None or (old.columns, old.rows) != (view.columns, view.rows):
            self._show_rows(view.rows)

    def _show_columns(self, numbers: tuple[str, ...]) -> None:
        self.list.setColumnCount(len(COLUMNS) + len(numbers))
        self.list.setHeaderLabels([*(self._texts(f"label.lessons_{name}") for name in COLUMNS), *numbers])
        for column, width in enumerate((*WIDTHS_PX, *(MARK_PX for _ in numbers))):
            self.list.setColumnWidth(column, self._style.px(width))
        self._widen()
        header, head = self.list.header(), self.list.headerItem()
        if header is not None:
            header.setSectionsMovable(False)
            header.setStretchLastSection(False)
            header.setMinimumSectionSize(self._style.px(MARK_PX))
        if head is not None:
            head.setToolTip(PROGRESS, self._texts("tip.lessons_progress"))
            for column in range(PASSED, head.columnCount()):
                head.setTextAlignment(column, CENTRE)

    def _widen(self) -> None:
        """Give the progress, which says what a seat is stuck at, the room that is left."""
        bar, columns = self.list.verticalScrollBar(), set(range(self.list.columnCount())) - {PROGRESS}
        frame = 2 * self.list.frameWidth() + bar.sizeHint().width()
        room = self.width() - frame - sum(map(self.list.columnWidth, columns))
        self.list.setColumnWidth(PROGRESS, max(room, self._style.px(WIDTHS_PX[PROGRESS])))

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802
        super().resizeEvent(event)
        self._widen()

    def _show_rows(self, rows: tuple[LessonRowView, ...]) -> None:
        """Show the rows in the existing items; create new items if there are more or fewer than before."""
        chosen = key_of(self.list.currentItem())
        if self.list.topLevelItemCount() != len(rows):
            self.list.clear()
            self.list.addTopLevelItems([QTreeWidgetItem() for _ in rows])
        for number, row in enumerate(rows):
            item = self.list.topLevelItem(number)
            if item is not None:
                self._fill(item, row)
                if row.seat == chosen:
                    self.list.setCurrentItem(item)

    def _fill(self, item: QTreeWidgetItem, row: LessonRowView) -> None:
        item.setData(0, Qt.ItemDataRole.UserRole, row.seat)
        cells = (*row.cells, *(SYMBOLS[mark] for mark in row.marks))
        details = f"<p style='white-space:pre'>{escape(row.details)}</p>" if row.details else ""
        for column, text in enumerate(cells):
            item.setText(column, text)
            item.setToolTip(column, details)
            if column >= PASSED:
                item.setTextAlignment(column, CENTRE)
        self._colour(item, PROGRESS, row.progress)
        for column, mark in enumerate(row.marks, len(COLUMNS)):
            self._colour(item, column, mark)

    def _colour(self, item: QTreeWidgetItem, column: int, progress: Progress) -> None:
        item.setForeground(column, QColor(getattr(self._style, ROLES[progress])))
