"""The screen for a projector: whose turn it is at each robot, in large type."""

from __future__ import annotations

from html import escape
from typing import Final

from PyQt5.QtCore import Qt
from PyQt5.QtGui import QResizeEvent
from PyQt5.QtWidgets import QFrame, QVBoxLayout

from gui.console.state.views import ProjectorRowView, ProjectorView
from gui.window.widgets.controls import label

ONE_COLUMN: Final = 3
"""Largest number of robots in one column; more are shown in two."""
LINES: Final = 8.0
"""Height of a robot with the space around it, in heights of the smallest type."""
CHARACTERS: Final = 44
"""Width of the screen, in heights of the smallest type."""


class ProjectorScreen(QFrame):
    """Shows a `ProjectorView`; the size of its type follows the size of the screen."""

    def __init__(self) -> None:
        super().__init__()
        self._view: ProjectorView | None = None
        self.text = label(wrap=True)
        self.text.setTextFormat(Qt.TextFormat.RichText)
        self.text.setAlignment(Qt.AlignmentFlag.AlignTop)
        self.text.setMinimumSize(1, 1)
        layout = QVBoxLayout(self)
        layout.addWidget(self.text)
        self.hide()

    def show_view(self, view: ProjectorView) -> None:
        """Show the robots, if they have changed."""
        if view != self._view:
            self._view = view
            self._draw()

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802
        super().resizeEvent(event)
        self._draw()

    def _draw(self) -> None:
        view = self._view
        if view is None:
            return
        columns = 1 if len(view.rows) <= ONE_COLUMN else 2
        lines = -(-len(view.rows) // columns)
        px = max(8, int(min(self.width() / CHARACTERS, self.height() / (LINES * max(lines, 2) + 2))))
        cells = [f'<td width="{100 // columns}%">{_cell(row, px)}</td>' for row in view.rows]
        rows = ("".join(cells[first : first + columns]) for first in range(0, len(cells), columns))
        table = "".join(f"<tr>{row}</tr>" for row in rows)
        last = f'<p style="font-size:{px}px"><b>{escape(view.stop)}</b></p>'
        empty = f'<p style="font-size:{2 * px}px">{escape(view.empty)}</p>' if view.empty else ""
        self.text.setText(f'{empty}<table width="100%" cellpadding="{px // 3}">{table}</table>{last}')


def _cell(row: ProjectorRowView, px: int) -> str:
    """Return one robot as rich text; `px` is the size of the smallest type."""
    top = " · ".join(escape(text) for text in (row.robot, row.state) if text)
    turn = f"<b>{escape(row.driver)}</b> {escape(row.left)}"
    sizes = ((px, top), (px * 5 // 2, turn), (px * 3 // 2, escape(row.waiting)))
    return "<br>".join(f'<span style="font-size:{size}px">{text}</span>' for size, text in sizes)
