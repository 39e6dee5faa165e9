"""The screen for a projector: whose turn it is at each robot, in large type."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Final

from PyQt5.QtCore import QRect, QSize, Qt
from PyQt5.QtGui import QFont, QFontMetrics, QPainter, QPaintEvent, QResizeEvent
from PyQt5.QtWidgets import QFrame, QGridLayout, QLabel, QSizePolicy, QVBoxLayout, QWidget

from gui.console.state.views import ProjectorRowView, ProjectorView
from gui.window.widgets.controls import NO_MARGINS, label, set_role, spaced

GAP_PX: Final = 8
LINE: Final = 1.2
"""Height of a line, in heights of its type."""
LINES: Final = 7.0
"""Height of a robot, in heights of its type: its name, two lines for the driver, which are larger, and two for the queue."""
CHARACTERS: Final = 11.0
"""Smallest width of a robot, in heights of its type."""
TOP_CHARACTERS: Final = 14.0
"""The same for the line with its name and the time left."""
DRIVER, STATE, SIDE = 1.27, 0.6, 0.42
"""Sizes of type, in heights of that of a robot's name."""
TOLERANCE: Final = 0.4
"""Part of a line that letters may reach out of their lines."""
LARGE: Final = 16
"""Height of the screen, in heights of the type of the sentence that replaces the robots."""
HINT: Final = 28
"""Height of the screen, in heights of the type of the sentence about STOP."""


def cut_in_middle(text: str, fits: Callable[[str], bool]) -> str:
    """Return a text without the middle part that does not fit: names that begin alike often differ at the end."""
    if fits(text):
        return text
    least, most, result = 1, len(text) - 1, "…"
    while least <= most:
        kept = (least + most) // 2
        cut = f"{text[: math.ceil(kept / 2)]}…{text[len(text) - kept // 2 :]}"
        if fits(cut):
            least, result = kept + 1, cut
        else:
            most = kept - 1
    return result


class FittedLabel(QLabel):
    """A text in type of any size that is cut in the middle if it needs more than `lines` lines; `text()` is whole."""

    def __init__(self, role: str = "", *, lines: int = 1, bold: bool = False, bottom: bool = False) -> None:
        super().__init__()
        self.setProperty("role", role)
        self.setTextFormat(Qt.TextFormat.PlainText)
        self._lines, self._bold = lines, bold
        vertical = Qt.AlignmentFlag.AlignBottom if bottom else Qt.AlignmentFlag.AlignTop
        self._flags = int(vertical | Qt.AlignmentFlag.AlignLeft)
        if lines > 1:
            self._flags |= int(Qt.TextFlag.TextWordWrap)
        self.size_px = 1.0

    def minimumSizeHint(self) -> QSize:  # noqa: N802
        return QSize(1, 1)

    @property
    def metrics(self) -> QFontMetrics:
        """The metrics of the type."""
        return QFontMetrics(self._font)

    @property
    def _font(self) -> QFont:
        font = QFont(self.font())
        font.setPixelSize(max(1, int(self.size_px)))
        font.setBold(self._bold)
        return font

    @property
    def shown(self) -> str:
        """The text as it is drawn."""
        metrics, room = self.metrics, QRect(0, 0, self.width(), 10 * self.height())
        most = (self._lines + TOLERANCE) * metrics.lineSpacing()

        def fits(text: str) -> bool:
            needed = metrics.boundingRect(room, self._flags, text)
            return needed.width() <= room.width() and needed.height() <= most

        return cut_in_middle(self.text(), fits)

    def paintEvent(self, _event: QPaintEvent) -> None:  # noqa: N802
        painter = QPainter(self)
        painter.setFont(self._font)
        painter.setPen(self.palette().color(self.foregroundRole()))
        painter.drawText(self.rect(), self._flags, self.shown)


class RobotCard(QFrame):
    """One robot: its name and the time left, the seat that drives, and the next seats."""

    def __init__(self) -> None:
        super().__init__()
        self.setProperty("card", "ready")
        self.robot, self.left = FittedLabel("dim"), FittedLabel(bold=True)
        self.side, self.state = FittedLabel("dim"), FittedLabel("warn", bold=True)
        self.driver = FittedLabel(lines=2, bold=True)
        self.waiting = FittedLabel(lines=2, bottom=True)
        for part in (self.robot, self.left, self.side, self.state, self.driver, self.waiting):
            part.setParent(self)
        self.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Ignored)

    def show_row(self, row: ProjectorRowView) -> None:
        """Show the texts of one robot."""
        set_role(self, "card", "unready" if row.state else "ready")
        for part, text in (
            (self.robot, row.robot),
            (self.side, row.side),
            (self.state, row.state),
            (self.left, row.left),
            (self.driver, row.driver),
            (self.waiting, row.waiting),
        ):
            part.setText(text)
        self._arrange()

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802
        super().resizeEvent(event)
        self._arrange()

    def _arrange(self) -> None:
        """Set the sizes of the type and the places of the texts."""
        px = min(self.height() / LINES, self.width() / CHARACTERS)
        top = min(px, self.width() / TOP_CHARACTERS)
        self.driver.size_px, self.waiting.size_px = px * DRIVER, px
        self.robot.size_px = self.left.size_px = top
        self.state.size_px, self.side.size_px = top * STATE, top * SIDE
        inner = self.contentsRect().adjusted(int(px * 0.4), int(px * 0.1), -int(px * 0.4), -int(px * 0.2))
        line, gap = int(px * LINE), int(px * 0.4)
        left = _width(self.left)
        notes = max(_width(self.side), _width(self.state))
        room = inner.width() - left - notes - 2 * gap
        name = max(1, min(_width(self.robot), room))
        self.robot.setGeometry(inner.x(), inner.y(), name, line)
        self.left.setGeometry(inner.right() - left, inner.y(), left, line)
        self._arrange_notes(QRect(inner.x() + name + gap, inner.y(), notes, line))
        driver = int(2 * self.driver.metrics.lineSpacing())
        self.driver.setGeometry(inner.x(), inner.y() + line, inner.width(), driver)
        waiting = 2 * self.waiting.metrics.lineSpacing()
        self.waiting.setGeometry(inner.x(), inner.bottom() - waiting, inner.width(), waiting)

    def _arrange_notes(self, room: QRect) -> None:
        """Place the side above the state; one of them alone is in the middle of the line."""
        heights = [part.metrics.height() if part.text() else 0 for part in (self.side, self.state)]
        y = room.y() + (room.height() - sum(heights)) // 2
        self.side.setGeometry(room.x(), y, room.width(), heights[0])
        self.state.setGeometry(room.x(), y + heights[0], room.width(), heights[1])


def _width(part: FittedLabel) -> int:
    """Return the width (px) of a text in one line."""
    return part.metrics.horizontalAdvance(part.text()) + 2 if part.text() else 0


class ProjectorScreen(QFrame):
    """Shows a `ProjectorView`; the robots fill the screen, and the size of the type follows its size."""

    def __init__(self) -> None:
        super().__init__()
        self._view: ProjectorView | None = None
        self.cards: list[RobotCard] = []
        self._robots = QWidget()
        self._grid = spaced(QGridLayout(self._robots), GAP_PX, NO_MARGINS)
        self.empty, self.hint = label(wrap=True), FittedLabel(bold=True)
        layout = spaced(QVBoxLayout(self), None, NO_MARGINS)
        layout.addWidget(self.empty)
        layout.addWidget(self._robots, 1)
        layout.addWidget(self.hint)
        self.hide()

    def show_view(self, view: ProjectorView) -> None:
        """Show the robots, if they have changed."""
        if view == self._view:
            return
        old, self._view = self._view, view
        if old is None or (len(old.rows), old.columns) != (len(view.rows), view.columns):
            self._lay_out(view)
        for card, row in zip(self.cards, view.rows, strict=True):
            card.show_row(row)
        self.empty.setText(view.empty)
        self.empty.setVisible(bool(view.empty))
        self._robots.setVisible(not view.empty)
        self.hint.setText(view.stop)

    def _lay_out(self, view: ProjectorView) -> None:
        """Create a card for each robot; a grid keeps the stretch of columns and rows that it no longer has."""
        for card in self.cards:
            self._grid.removeWidget(card)
            card.deleteLater()
        for number in range(self._grid.columnCount()):
            self._grid.setColumnStretch(number, int(number < view.columns))
        for number in range(self._grid.rowCount()):
            self._grid.setRowStretch(number, int(number < view.lines))
        self.cards = [RobotCard() for _ in view.rows]
        for number, card in enumerate(self.cards):
            self._grid.addWidget(card, *divmod(number, view.columns))
            self._grid.setColumnStretch(number % view.columns, 1)
            self._grid.setRowStretch(number // view.columns, 1)

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802
        super().resizeEvent(event)
        size = min(self.height() / HINT, self.width() / (2 * HINT))
        self.hint.size_px = size
        self.hint.setFixedHeight(int(size * 1.4))
        self.empty.setStyleSheet(f"font-size: {max(1, self.height() // LARGE)}px")
