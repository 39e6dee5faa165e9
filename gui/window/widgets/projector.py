"""The screen for a projector: whose turn it is at each robot, in large type."""

from __future__ import annotations

from html import escape
from typing import Final

from PyQt5.QtCore import Qt
from PyQt5.QtGui import QResizeEvent, QTextDocument
from PyQt5.QtWidgets import QFrame, QVBoxLayout

from gui.console.state.views import ProjectorRowView, ProjectorView
from gui.window.widgets.controls import label

COLUMNS: Final = (3, 8)
"""Largest number of robots in one column, and in two columns; more are shown in three."""
LINES: Final = 8.0
"""Height of a robot with the space around it, in heights of the smallest type."""
CHARACTERS: Final = 44
"""Width of the screen, in heights of the smallest type."""
SMALLEST_PX: Final = 8
SHRINK: Final = 0.93
"""Factor of the type as long as long names need more lines than the screen has."""


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
        columns = 1 + sum(len(view.rows) > most for most in COLUMNS)
        lines = -(-len(view.rows) // columns)
        room = self.text.contentsRect()
        size = min(self.width() / CHARACTERS, self.height() / (LINES * max(lines, 2) + 2))
        document = QTextDocument()
        document.setDefaultFont(self.text.font())
        document.setTextWidth(room.width())
        while True:
            px = max(SMALLEST_PX, int(size))
            text = _page(view, columns, px)
            document.setHtml(text)
            if px == SMALLEST_PX or document.size().height() <= room.height():
                break
            size = min(size * SHRINK, px - 1)
        self.text.setText(text)


def _page(view: ProjectorView, columns: int, px: int) -> str:
    """Return the whole screen as rich text; `px` is the size of the smallest type."""
    cells = [f'<td width="{100 // columns}%">{_cell(row, px)}</td>' for row in view.rows]
    rows = ("".join(cells[first : first + columns]) for first in range(0, len(cells), columns))
    table = "".join(f"<tr>{row}</tr>" for row in rows)
    last = f'<p style="font-size:{px}px"><b>{escape(view.stop)}</b></p>'
    empty = f'<p style="font-size:{2 * px}px">{escape(view.empty)}</p>' if view.empty else ""
    return f'{empty}<table width="100%" cellpadding="{px // 3}">{table}</table>{last}'


def _cell(row: ProjectorRowView, px: int) -> str:
    """Return one robot as rich text; `px` is the size of the smallest type."""
    top = " · ".join(escape(text) for text in (row.robot, row.state) if text)
    left = escape(row.left).replace(" ", "&nbsp;")
    turn = f"<b>{escape(row.driver)}</b> {left}"
    sizes = ((px, top), (px * 5 // 2, turn), (px * 3 // 2, escape(row.waiting)))
    return "<br>".join(f'<span style="font-size:{size}px">{text}</span>' for size, text in sizes)
