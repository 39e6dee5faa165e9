"""The page of the class: a row for each robot with requests to one or all of them, and the lessons of each seat."""

from __future__ import annotations

from PyQt5.QtCore import Qt, QTimer, pyqtSignal
from PyQt5.QtGui import QColor, QResizeEvent
from PyQt5.QtWidgets import (
    QComboBox,
    QHBoxLayout,
    QHeaderView,
    QLineEdit,
    QTabWidget,
    QTreeWidget,
    QTreeWidgetItem,
    QVBoxLayout,
    QWidget,
)

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
from gui.window.widgets.lessons import LessonsTable, key_of, table

COLUMNS = ("robot", "side", "state", "driver", "turn", "waiting", "rate", "age", "remarks")
STATE = COLUMNS.index("state")
TIPS = ("turn", "rate", "age")
"""Columns of numbers, whose headings have a tooltip."""
RIGHT = tuple(COLUMNS.index(name) for name in TIPS)
WIDTHS_PX = (90, 84, 124, 130, 46, 120, 56, 50)
"""Least widths (px) of all columns but the last, at scale 1."""
NAME_PADDING_PX = 14
WIDER_PX = {"driver": 130, "waiting": 150}
"""What these columns get (px at scale 1) in a wide window, of the room that the last one does not need."""
REMARKS_PX = 200
"""Room (px) at scale 1 that the last column keeps."""
NO_REMARKS_PX = 130
"""The same while it contains only its heading."""
LIMIT_PX = 70
LARGE = {"robot": 0.18, "side": 0.11, "state": 0.17, "driver": 0.24, "turn": 0.08, "waiting": 0.22}
"""Columns in large type, for a projector, and their parts of the width."""
LARGE_WIDTH, LARGE_LINE, LARGEST = 60, 1.7, 16
"""Width of the page, height of a row, and height of the page, all in heights of the large type."""
SEAT_CHARACTERS = 10
"""Width of the box of seats."""
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
        self.set_limit.clicked.disconnect()
        self.set_limit.clicked.connect(lambda: self._report_limit())  # noqa: PLW0108 - `clicked` has an argument
        self.list, self.lessons = self._list(texts), LessonsTable(texts)
        self.tabs = QTabWidget()
        self.empty = label(role="dim", wrap=True)
        self.result = label(wrap=True)
        self.selected = label(role="title")
        self.freeze, self.take, self.show_robot = IntentButton(), IntentButton(), IntentButton()
        self.seats, self.mute = QComboBox(), IntentButton()
        self.seats.setSizeAdjustPolicy(QComboBox.SizeAdjustPolicy.AdjustToMinimumContentsLengthWithIcon)
        self.seats.setMinimumContentsLength(SEAT_CHARACTERS)
        self.seats.setAccessibleName(texts("label.class_seat"))
        self.seats.currentIndexChanged.connect(lambda *_: self._show_seat())
        self.seat_label = label(texts("label.class_seat"), "title")
        self.mute.intent.connect(self.intent)
        for button in (self.freeze_all, self.unfreeze_all, self.freeze, self.take, self.show_robot):
            button.intent.connect(self.intent)
        self._lay_out(texts)

    def _list(self, texts: Texts) -> QTreeWidget:
        found = table(texts("label.class"))
        found.setHeaderLabels([texts(f"label.class_{name}") for name in COLUMNS])
        header = found.header()
        if header is not None:
            header.setSectionResizeMode(QHeaderView.ResizeMode.Interactive)
            header.setSectionsMovable(False)
        head = found.headerItem()
        if head is not None:
            for name in TIPS:
                head.setToolTip(COLUMNS.index(name), texts(f"tip.class_{name}"))
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
        self._widen()
        names = self.seats.view()
        if names is not None:
            names.setMinimumWidth(self._style.px(NAMES_PX))
            names.setVerticalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAsNeeded)
        self.lessons.show_theme(theme)
        if self._view is not None:
            self._show_rows(self._view.rows)

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802
        super().resizeEvent(event)
        self._widen()

    def show_large(self, *, on: bool) -> None:
        """Show the robots alone, in large type for a projector, or again the whole page."""
        self.large = on
        for part in (*self._lines, self.result):
            part.setVisible(not on)
        self.tabs.setCurrentIndex(0)
        self.tabs.tabBar().setVisible(not on)
        for column, name in enumerate(COLUMNS):
            self.list.setColumnHidden(column, on and name not in LARGE)
        self.list.setStyleSheet("")
        self._widen()

    def _enlarge(self) -> None:
        """Let the type follow the size of the page; texts that are too long are cut."""
        lines = LARGE_LINE * (self.list.topLevelItemCount() + 1)
        px = min(self.width() / LARGE_WIDTH, self.height() / max(lines, LARGEST))
        self.list.setStyleSheet(f"* {{ font-size: {int(px)}px }}")
        for name, part in LARGE.items():
            self.list.setColumnWidth(COLUMNS.index(name), int(part * self.list.width()))

    def _widen(self) -> None:
        """Show the names whole, in a narrow window at the cost of the last columns; share the rest of the width."""
        if self.large:
            self._enlarge()
            return
        least, *widths = map(self._style.px, WIDTHS_PX)
        advance, rows = (
            self.list.fontMetrics().horizontalAdvance,
            () if self._view is None else self._view.rows,
        )
        padding = self._style.px(NAME_PADDING_PX)
        names = max([least, *(advance(row.place[0]) + padding for row in rows)])
        remarks = REMARKS_PX if any(row.cells[-1] for row in rows) else NO_REMARKS_PX
        free = self.width() - names - sum(widths) - self._style.px(remarks)
        share = min(1.0, max(0.0, free / self._style.px(sum(WIDER_PX.values()))))
        self.list.setColumnWidth(0, names)
        for column, (name, width) in enumerate(zip(COLUMNS[1:], widths, strict=False), 1):
            self.list.setColumnWidth(column, width + self._style.px(share * WIDER_PX.get(name, 0)))

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
        """Show the rows in the existing items; create new items if the robots are not the same as before."""
        chosen = key_of(self.list.currentItem())
        places = [key_of(self.list.topLevelItem(i)) for i in range(self.list.topLevelItemCount())]
        if places != [row.place for row in rows]:
            self.list.blockSignals(True)  # noqa: FBT003
            self.list.clear()
            self.list.addTopLevelItems([self._item(row) for row in rows])
            again = next((i for i, row in enumerate(rows) if row.place == chosen), 0)
            self.list.setCurrentItem(self.list.topLevelItem(again))
            self.list.blockSignals(False)  # noqa: FBT003
            self._widen()
        for number, row in enumerate(rows):
            item = self.list.topLevelItem(number)
            if item is not None:
                self._fill(item, row)

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

    @staticmethod
    def _item(row: ClassRowView) -> QTreeWidgetItem:
        item = QTreeWidgetItem()
        item.setData(0, Qt.ItemDataRole.UserRole, row.place)
        for column in RIGHT:
            item.setTextAlignment(column, int(Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter))
        return item

    def _fill(self, item: QTreeWidgetItem, row: ClassRowView) -> None:
        for column, text in enumerate(row.cells):
            if item.text(column) != text:
                item.setText(column, text)
            if item.toolTip(column) != (tip := row.details or text):
                item.setToolTip(column, tip)
        colour = QColor(self._style.condition(row.condition))
        if item.foreground(STATE).color() != colour:
            item.setForeground(STATE, colour)

    def _show_selected(self) -> None:
        """Show the buttons of the selected robot."""
        place = key_of(self.list.currentItem())
        rows = () if self._view is None else self._view.rows
        row = next((found for found in rows if found.place == place), None)
        for part in (self.selected, self.freeze, self.take, self.show_robot):
            part.setVisible(row is not None)
        if row is not None:
            set_text(self.selected, f"{row.cells[0]}, {row.cells[1]}")
            self.freeze.show_view(row.freeze)
            self.take.show_view(row.take)
            self.show_robot.show_view(row.show)

    def _report_limit(self) -> None:
        self.intent.emit(LimitClass(self.limit.text()))
