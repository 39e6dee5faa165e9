"""Requests of this window and of other seats, to send again."""

from __future__ import annotations

from PyQt5.QtCore import QSignalBlocker, Qt
from PyQt5.QtGui import QColor
from PyQt5.QtWidgets import QListWidget, QListWidgetItem, QSizePolicy, QWidget

from gui.console.state.intents import Repeat, Theme
from gui.console.state.views import HistoryRowView
from gui.console.texts import Texts
from gui.window.theme import style_of
from gui.window.widgets.controls import (
    NO_MARGINS,
    Panel,
    in_column,
    label,
    named,
    plain_button,
    set_role,
)


class HistoryPanel(Panel):
    """The list of requests, newest first."""

    def __init__(self, texts: Texts) -> None:
        super().__init__()
        self._rows: tuple[HistoryRowView, ...] = ()
        self._style = style_of(Theme.DARK)
        self._hint = texts("label.history_hint")
        self.list = named(QListWidget(), texts("label.history"), "")
        self.list.setMinimumHeight(40)
        self.list.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.empty = label(texts("label.history_empty"), "dim", wrap=True)
        self.details = label(wrap=True)
        """time, seat and result of the selected row"""
        self.details.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Preferred)
        self.repeat = plain_button(texts("label.repeat"), texts("tip.repeat"))
        self.uses = QWidget()
        """what can be done with the selected row"""
        in_column(self.details, self.repeat, gap=4, margins=NO_MARGINS, inside=self.uses)
        in_column(self.empty, (self.list, 1), self.uses, gap=4, margins=(6, 6, 6, 6), inside=self)
        self.repeat.clicked.connect(self._repeat)
        self.list.currentRowChanged.connect(self._show_buttons)
        self.list.itemActivated.connect(self._repeat)
        self._fill()

    def show_view(self, rows: tuple[HistoryRowView, ...]) -> None:
        """Show the rows; the selected one stays selected while it exists."""
        chosen, self._rows = self._chosen(), rows
        self._fill(chosen)

    def show_theme(self, theme: Theme) -> None:
        """Use the colours of a theme."""
        self._style = style_of(theme)
        self._fill(self._chosen())

    def _fill(self, chosen: HistoryRowView | None = None) -> None:
        same = None if chosen is None else (chosen.row, chosen.time, chosen.what)
        with QSignalBlocker(self.list):
            self.list.clear()
            for row in self._rows:
                self.list.addItem(self._item(row))
            rows = [(row.row, row.time, row.what) for row in self._rows]
            self.list.setCurrentRow(rows.index(same) if same in rows else -1)
        self.empty.setVisible(not self._rows)
        self.list.setVisible(bool(self._rows))
        self.uses.setVisible(bool(self._rows))
        self._show_buttons()

    def _item(self, row: HistoryRowView) -> QListWidgetItem:
        who = "" if row.row >= 0 else f"{row.who}: "
        item = QListWidgetItem(f"{row.symbol} {who}{row.what}")
        colours = {True: self._style.text, False: self._style.bad, None: self._style.dim}
        item.setForeground(QColor(colours[None if row.on_purpose else row.good]))
        item.setToolTip(_details(row))
        return item

    def _chosen(self) -> HistoryRowView | None:
        number = self.list.currentRow()
        return self._rows[number] if 0 <= number < len(self._rows) else None

    def _show_buttons(self) -> None:
        chosen = self._chosen()
        self.details.setText(self._hint if chosen is None else _details(chosen))
        set_role(self.details, "role", "dim" if chosen is None else "")
        self.repeat.setEnabled(chosen is not None and chosen.row >= 0)

    def _repeat(self) -> None:
        chosen = self._chosen()
        if chosen is not None and chosen.row >= 0:
            self.intent.emit(Repeat(chosen.row))


def _details(row: HistoryRowView) -> str:
    return f"{row.time}  {row.who}: {row.what}\n{row.symbol} {row.result}"
