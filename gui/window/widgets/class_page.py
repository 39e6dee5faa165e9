"""The page of the class: a row for each robot with requests to one or all of them, and the lessons of each seat."""

from __future__ import annotations

from PyQt5.QtCore import QSignalBlocker, QTimer, pyqtSignal
from PyQt5.QtGui import QResizeEvent
from PyQt5.QtWidgets import QLineEdit, QTabWidget, QWidget

from gui.console.state.intents import LimitClass, Theme
from gui.console.state.views import ClassRowView, ClassView, SeatView
from gui.console.texts import Texts
from gui.window.theme import style_of
from gui.window.widgets.controls import (
    NO_MARGINS,
    IntentButton,
    NameBox,
    Panel,
    Part,
    in_column,
    in_row,
    label,
    plain_button,
    set_role,
)
from gui.window.widgets.table import LessonsTable, Table, TableRow

COLUMNS = ("robot", "side", "state", "driver", "turn", "waiting", "rate", "age", "remarks")
STATE = COLUMNS.index("state")
NUMBERS = ("turn", "rate", "age")
"""Columns of numbers, whose headings have a tooltip."""
WIDE = ("driver", "waiting", "remarks")
"""Columns that share the width which the others do not need."""
LARGE = ("robot", "side", "state", "driver", "turn", "waiting")
"""Columns in large type, for a projector."""
LARGE_WIDTH, LARGE_LINE, LARGEST = 60, 1.7, 16
"""Width of the page, height of a row, and height of the page, all in heights of the large type."""


class ClassPage(Panel):
    """All robots and seats at the router."""

    projector_asked = pyqtSignal()

    def __init__(self, texts: Texts) -> None:
        super().__init__("panel")
        self._view: ClassView | None = None
        self._style = style_of(Theme.DARK)
        self.large = False
        self.summary = label(role="title", wrap=True)
        self.project = plain_button(texts("label.projector"), texts("tip.projector"))
        self.project.clicked.connect(lambda: self.projector_asked.emit())  # noqa: PLW0108 - `clicked` has an argument
        self.freeze_all, self.unfreeze_all = self.button(main=True), self.button()
        self.limit_now = label()
        self.limit, self.set_limit = QLineEdit(), IntentButton()
        self.limit.setObjectName("limit")
        self.limit.setAccessibleName(texts("label.class_limit"))
        self.limit.returnPressed.connect(self._report_limit)
        self.set_limit.intent.connect(self._report_limit)
        self.list, self.lessons = self._list(texts), LessonsTable(texts)
        self.tabs = QTabWidget()
        self.empty, self.result = label(role="dim", wrap=True), label(wrap=True)
        self.selected = label(role="title")
        self.freeze, self.take, self.show_robot = self.button(), self.button(), self.button()
        self.seat_label, self.seats, self.mute = (
            label(texts("label.class_seat"), "title"),
            NameBox(),
            self.button(),
        )
        self.seats.setAccessibleName(self.seat_label.text())
        self.seats.currentIndexChanged.connect(lambda *_: self._show_seat())
        self._lay_out(texts)

    def _list(self, texts: Texts) -> Table:
        found = Table(texts("label.class"))
        headings = [texts(f"label.class_{name}") for name in COLUMNS]
        tips = [texts(f"tip.class_{name}") if name in NUMBERS else "" for name in COLUMNS]
        wide, numbers = (set(map(COLUMNS.index, names)) for names in (WIDE, NUMBERS))
        found.show_columns(headings, tips, wide, numbers)
        found.currentItemChanged.connect(lambda *_: self._show_selected())
        # The button is clicked later, because Qt passes the same Enter on to the parent widgets: if the pad already had
        # the focus, this Enter would send a motion.
        found.itemActivated.connect(lambda *_: QTimer.singleShot(0, self.show_robot.click))
        return found

    def _lay_out(self, texts: Texts) -> None:
        every, one = (label(texts(f"label.class_{name}"), "title") for name in ("all", "one"))
        limit = label(texts("label.class_limit")), self.limit, self.set_limit, (self.limit_now, 1)
        chosen = self.selected, self.freeze, self.take, self.show_robot
        self._lines = (
            self._line((self.summary, 1), self.project),
            self._line(every, self.freeze_all, self.unfreeze_all, label("  "), *limit),
            self._line(one, *chosen, None, self.seat_label, self.seats, self.mute),
        )
        robots = QWidget()
        inner = (self.list, 1), (self.empty, 1), self._lines[2]
        in_column(*inner, gap=6, margins=(0, 0, 0, 4), inside=robots)
        whole = *self._lines[:2], (self.tabs, 1), self.result
        in_column(*whole, gap=6, margins=(8, 8, 8, 8), inside=self)
        self.tabs.addTab(robots, texts("label.class_robots"))
        self.tabs.addTab(self.lessons, "")

    @staticmethod
    def _line(*parts: Part) -> QWidget:
        line = QWidget()
        in_row(*parts, gap=6, margins=NO_MARGINS, inside=line)
        return line

    def show_theme(self, theme: Theme) -> None:
        """Use the colours and sizes of a theme."""
        self._style = style_of(theme)
        self.lessons.show_theme(theme)
        if self._view is not None:
            self._show_rows(self._view.rows)

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802
        super().resizeEvent(event)
        self._fit_type()

    def show_large(self, *, on: bool) -> None:
        """Show the robots alone, in large type for a projector, or again the whole page."""
        self.large = on
        for part in (*self._lines, self.result):
            part.setVisible(not on)
        self.tabs.setCurrentIndex(0)
        self.tabs.tabBar().setVisible(not on)
        for column, name in enumerate(COLUMNS):
            self.list.setColumnHidden(column, on and name not in LARGE)
        self._fit_type()

    def _fit_type(self) -> None:
        """Let large type follow the size of the page."""
        lines = LARGE_LINE * (self.list.topLevelItemCount() + 1)
        px = min(self.width() / LARGE_WIDTH, self.height() / max(lines, LARGEST))
        self.list.setStyleSheet(f"* {{ font-size: {int(px)}px }}" if self.large else "")

    def show_view(self, view: ClassView | None) -> None:
        """Show all robots; the selected one stays selected while it is online."""
        if view is None or view == self._view:
            return
        old, self._view = self._view, view
        self.summary.setText(view.summary)
        self.limit_now.setText(view.limit_now)
        self.freeze_all.show_view(view.freeze_all)
        self.unfreeze_all.show_view(view.unfreeze_all)
        self.set_limit.show_view(view.limit)
        self.limit.setToolTip(view.limit.tooltip)
        self.empty.setText(view.empty)
        self.empty.setVisible(not view.rows)
        self.list.setVisible(bool(view.rows))
        set_role(self.result, "role", {True: "good", False: "bad", None: "dim"}[view.good])
        self.result.setText(view.result)
        self._show_rows(view.rows)
        self._show_selected()
        self.tabs.setTabText(1, view.lessons.title)
        self.lessons.show_view(view.lessons)
        if old is None or old.seats != view.seats:
            self._show_seats(view.seats)

    def _show_rows(self, rows: tuple[ClassRowView, ...]) -> None:
        colour = self._style.condition
        self.list.show_rows(
            [TableRow(row.place, row.cells, row.details, {STATE: colour(row.condition)}) for row in rows]
        )
        if self.large:
            self._fit_type()

    def _show_seats(self, seats: tuple[SeatView, ...]) -> None:
        """List the seats; the chosen one stays chosen while it is listed."""
        chosen = self.seats.currentData()
        with QSignalBlocker(self.seats):
            self.seats.clear()
            for view in seats:
                self.seats.addItem(view.text, getattr(view.mute.intent, "seat", None))
            self.seats.setCurrentIndex(max(0, self.seats.findData(chosen)) if seats else -1)
        self.seat_label.setVisible(bool(seats))
        self.seats.setVisible(bool(seats))
        self._show_seat()

    def _show_seat(self) -> None:
        """Show the button of the chosen seat."""
        index = self.seats.currentIndex()
        self.mute.show_view(None if self._view is None or index < 0 else self._view.seats[index].mute)

    def _show_selected(self) -> None:
        """Show the buttons of the selected robot."""
        rows = () if self._view is None else self._view.rows
        row = next((found for found in rows if found.place == self.list.chosen), None)
        self.selected.setVisible(row is not None)
        self.selected.setText("" if row is None else f"{row.cells[0]}, {row.cells[1]}")
        for name, button in (("freeze", self.freeze), ("take", self.take), ("show", self.show_robot)):
            button.show_view(getattr(row, name, None))

    def _report_limit(self) -> None:
        self.intent.emit(LimitClass(self.limit.text()))
