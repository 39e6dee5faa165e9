"""The page of the class: a row for each robot with requests to one or all of them, and the lessons of each seat."""

from __future__ import annotations

from PyQt5.QtCore import Qt, QTimer, pyqtSignal
from PyQt5.QtGui import QResizeEvent
from PyQt5.QtWidgets import QComboBox, QHBoxLayout, QLineEdit, QTabWidget, QVBoxLayout, QWidget

from gui.console.state.intents import LimitClass, Theme
from gui.console.state.views import ClassRowView, ClassView, SeatView
from gui.console.texts import Texts
from gui.window.theme import style_of
from gui.window.widgets.controls import (
    NO_MARGINS,
    IntentButton,
    Panel,
    filled,
    label,
    plain_button,
    set_role,
    set_text,
    spaced,
)
from gui.window.widgets.lessons import LessonsTable
from gui.window.widgets.table import Table, TableRow

COLUMNS = ("robot", "side", "state", "driver", "turn", "waiting", "rate", "age", "remarks")
STATE = COLUMNS.index("state")
NUMBERS = ("turn", "rate", "age")
"""Columns of numbers, whose headings have a tooltip."""
WIDE = ("driver", "waiting", "remarks")
"""Columns that share the width which the others do not need."""
LIMIT_PX = 70
LARGE = ("robot", "side", "state", "driver", "turn", "waiting")
"""Columns in large type, for a projector."""
LARGE_WIDTH, LARGE_LINE, LARGEST = 60, 1.7, 16
"""Width of the page, height of a row, and height of the page, all in heights of the large type."""
NAMES_PX = 240
"""Least width (px) of its list, at scale 1, which shows whole names."""


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
        self.freeze_all, self.unfreeze_all = IntentButton(main=True), IntentButton()
        self.limit_now = label()
        self.limit, self.set_limit = QLineEdit(), IntentButton()
        self.limit.setAccessibleName(texts("label.class_limit"))
        self.limit.returnPressed.connect(self._report_limit)
        self.set_limit.intent.connect(self._report_limit)
        self.list, self.lessons = self._list(texts), LessonsTable(texts)
        self.tabs = QTabWidget()
        self.empty = label(role="dim", wrap=True)
        self.result = label(wrap=True)
        self.selected = label(role="title")
        self.freeze, self.take, self.show_robot = IntentButton(), IntentButton(), IntentButton()
        self.seats, self.mute = QComboBox(), IntentButton()
        self.seats.setSizeAdjustPolicy(QComboBox.SizeAdjustPolicy.AdjustToMinimumContentsLengthWithIcon)
        self.seats.setMinimumContentsLength(10)
        self.seats.setAccessibleName(texts("label.class_seat"))
        self.seats.currentIndexChanged.connect(lambda *_: self._show_seat())
        self.seat_label = label(texts("label.class_seat"), "title")
        for button in (
            *(self.freeze_all, self.unfreeze_all, self.freeze, self.take, self.show_robot),
            self.mute,
        ):
            button.intent.connect(self.intent)
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
        self._lines = QWidget(), QWidget(), QWidget()
        top, every, one = (spaced(QHBoxLayout(line), 6, NO_MARGINS) for line in self._lines)
        filled(top, (self.summary, 1), self.project)
        filled(every, label(texts("label.class_all"), "title"), self.freeze_all, self.unfreeze_all)
        every.addSpacing(12)
        limit = label(texts("label.class_limit"))
        filled(every, limit, self.limit, self.set_limit, (self.limit_now, 1))
        filled(one, label(texts("label.class_one"), "title"), self.selected, self.freeze, self.take)
        filled(one, self.show_robot, None, self.seat_label, self.seats, self.mute)
        robots = QWidget()
        inner = spaced(QVBoxLayout(robots), 6, (0, 0, 0, 4))
        filled(inner, (self.list, 1), (self.empty, 1), self._lines[2])
        layout = spaced(QVBoxLayout(self), 6, (8, 8, 8, 8))
        filled(layout, *self._lines[:2], (self.tabs, 1), self.result)
        self.tabs.addTab(robots, texts("label.class_robots"))
        self.tabs.addTab(self.lessons, "")

    def show_theme(self, theme: Theme) -> None:
        """Use the colours and sizes of a theme."""
        self._style = style_of(theme)
        self.limit.setFixedWidth(self._style.px(LIMIT_PX))
        names = self.seats.view()
        if names is not None:
            names.setMinimumWidth(self._style.px(NAMES_PX))
            names.setVerticalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAsNeeded)
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
        set_text(self.summary, view.summary)
        set_text(self.limit_now, view.limit_now)
        self.freeze_all.show_view(view.freeze_all)
        self.unfreeze_all.show_view(view.unfreeze_all)
        self.set_limit.show_view(view.limit)
        self.limit.setToolTip(view.limit.tooltip)
        set_text(self.empty, view.empty)
        self.empty.setVisible(not view.rows)
        self.list.setVisible(bool(view.rows))
        set_role(self.result, "role", {True: "good", False: "bad", None: "dim"}[view.good])
        set_text(self.result, view.result)
        if old is None or old.rows != view.rows:
            self._show_rows(view.rows)
        self._show_selected()
        self.tabs.setTabText(1, view.lessons.title)
        self.lessons.show_view(view.lessons)
        if old is None or old.seats != view.seats:
            self._show_seats(view.seats)

    def _show_rows(self, rows: tuple[ClassRowView, ...]) -> None:
        colours = [{STATE: self._style.condition(row.condition)} for row in rows]
        shown = [
            TableRow(row.place, row.cells, row.details, of) for row, of in zip(rows, colours, strict=True)
        ]
        self.list.show_rows(shown)
        if self.large:
            self._fit_type()

    def _show_seats(self, seats: tuple[SeatView, ...]) -> None:
        """List the seats; the chosen one stays chosen while it is listed."""
        chosen = self.seats.currentData()
        self.seats.blockSignals(True)  # noqa: FBT003
        self.seats.clear()
        for view in seats:
            self.seats.addItem(view.text, getattr(view.mute.intent, "seat", None))
        self.seats.setCurrentIndex(max(0, self.seats.findData(chosen)) if seats else -1)
        self.seats.blockSignals(False)  # noqa: FBT003
        self._show_seat()

    def _show_seat(self) -> None:
        """Show the button of the chosen seat."""
        seats, index = () if self._view is None else self._view.seats, self.seats.currentIndex()
        for part in (self.seat_label, self.seats, self.mute):
            part.setVisible(bool(seats))
        if 0 <= index < len(seats):
            self.mute.show_view(seats[index].mute)

    def _show_selected(self) -> None:
        """Show the buttons of the selected robot."""
        rows = () if self._view is None else self._view.rows
        row = next((found for found in rows if found.place == self.list.chosen), None)
        for part in (self.selected, self.freeze, self.take, self.show_robot):
            part.setVisible(row is not None)
        if row is not None:
            set_text(self.selected, f"{row.cells[0]}, {row.cells[1]}")
            self.freeze.show_view(row.freeze)
            self.take.show_view(row.take)
            self.show_robot.show_view(row.show)

    def _report_limit(self) -> None:
        self.intent.emit(LimitClass(self.limit.text()))
