"""A table of robots or seats."""

from __future__ import annotations

from collections.abc import Container, Mapping, Sequence
from dataclasses import dataclass, field

from PyQt5.QtCore import QSignalBlocker, Qt
from PyQt5.QtGui import QColor
from PyQt5.QtWidgets import QHeaderView, QTreeWidget, QTreeWidgetItem

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
