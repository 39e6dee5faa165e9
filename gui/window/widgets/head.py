"""The head: the pad, which shows and moves the target, and the angles of both robots."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import replace

from PyQt5.QtCore import QPointF, QRectF, Qt, QTimer
from PyQt5.QtGui import QBrush, QColor, QKeyEvent, QMouseEvent, QPainter, QPaintEvent, QPolygonF, QResizeEvent
from PyQt5.QtWidgets import QBoxLayout, QGridLayout, QSizePolicy, QWidget

from gui.console.state.intents import AimHead, GrabHead, HeadOrientation, LiveHead, ReleaseHead, Theme
from gui.console.state.views import HeadView
from gui.console.texts import Texts
from gui.window.theme import Style, style_of
from gui.window.widgets.controls import NO_MARGINS, Panel, in_column, label, named, spaced
from gui.window.widgets.head3d_drag import BEYOND, furthest
from gui.window.widgets.head3d_paint import draw_lines

RING = 0.13
"""Width of the ring, divided by the radius of the pad."""
KEYS = {
    Qt.Key.Key_Left: (0.0, 0.0, -1.0),
    Qt.Key.Key_Right: (0.0, 0.0, 1.0),
    Qt.Key.Key_Up: (0.0, -1.0, 0.0),
    Qt.Key.Key_Down: (0.0, 1.0, 0.0),
    Qt.Key.Key_PageUp: (1.0, 0.0, 0.0),
    Qt.Key.Key_PageDown: (-1.0, 0.0, 0.0),
}
"""Step of each key in yaw, pitch and roll (deg)."""
COARSE_DEG = 5.0
"""The step with Shift."""
LIVE_MS = 50
"""Time between two targets for a simulation that follows a drag."""
LINE_PX = 14
"""Height of a line of the captions at scale 1."""
UP, DOWN = Qt.AlignmentFlag.AlignTop, Qt.AlignmentFlag.AlignBottom
LEFT, RIGHT, MIDDLE = Qt.AlignmentFlag.AlignLeft, Qt.AlignmentFlag.AlignRight, Qt.AlignmentFlag.AlignHCenter
CAPTIONS = {
    "up": UP | MIDDLE,
    "down": DOWN | MIDDLE,
    "yaw_left": UP | LEFT,
    "yaw_right": UP | RIGHT,
    "left": DOWN | LEFT,
    "right": DOWN | RIGHT,
}
"""Place of each caption."""
FACING = {"left": "right", "right": "left", "yaw_left": "facing_left", "yaw_right": "facing_right"}
"""The captions there if the user faces the robot."""


AXES = ("yaw", "pitch", "roll")
COLUMNS = {"target": "title", "sim": "sim", "hw": "hw"}
"""Columns of the numbers, with their roles."""
SYMBOLS = {"target": "○", "sim": "+", "hw": "■"}
"""The markers of the pad."""


class TargetWidget(Panel):
    """A picture in which the user moves the target of the head: what the pad and the view in three dimensions share."""

    def __init__(self, name: str, tip: str) -> None:
        super().__init__()
        self._view: HeadView | None = None
        self._style: Style = style_of(Theme.DARK)
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)
        self._live = QTimer(self)
        self._live.setInterval(LIVE_MS)
        self._live.timeout.connect(lambda: self.intent.emit(LiveHead()))
        self.setProperty("sends", True)  # noqa: FBT003
        named(self, name, tip)

    def show_theme(self, theme: Theme) -> None:
        """Use the colours of a theme."""
        self._style = style_of(theme)
        if self._view is not None:
            self.show_view(self._view)
        self.update()

    def show_view(self, view: HeadView) -> None:
        """Show target and robots to a tenth of a degree, less than a pixel; draw again only if that changes."""
        shown = replace(
            view,
            target=HeadOrientation(*view.target.tenths),
            sim=view.sim and HeadOrientation(*view.sim.tenths),
            hw=view.hw and HeadOrientation(*view.hw.tenths),
            shown=view.shown and HeadOrientation(*view.shown.tenths),
        )
        if shown != self._view:
            self._view = shown
            self.update()

    @property
    def _right(self) -> float:
        """1 if the right of the robot is at the right of the pad; -1 if the user faces it."""
        return -1.0 if self._view is not None and self._view.facing else 1.0

    def _report(self, target: HeadOrientation) -> None:
        if self._view is None or target != self._view.target:
            self.intent.emit(AimHead(*target.tenths))

    def _follow(self) -> None:
        """Let the simulation follow the drag, if that was chosen."""
        if self._view is not None and self._view.drag.live and not self._live.isActive():
            self.intent.emit(LiveHead())
            self._live.start()

    def _let_go(self) -> None:
        """End a drag."""
        if self._live.isActive():
            self._live.stop()
            self.intent.emit(LiveHead())  # the last target
        self.intent.emit(ReleaseHead())

    def keyPressEvent(self, event: QKeyEvent) -> None:  # noqa: N802
        """Move the target, turned within the limit of yaw; other keys are Qt's."""
        step, view = KEYS.get(Qt.Key(event.key())), self._view
        if step is None or view is None:
            super().keyPressEvent(event)
            return
        size = COARSE_DEG if event.modifiers() & Qt.KeyboardModifier.ShiftModifier else 1.0
        yaw, pitch, roll = (part * size for part in step)
        target, limit = view.target, view.yaw_max
        turned = max(-limit, min(limit, target.yaw + yaw * self._right))
        self._report(HeadOrientation(turned, target.pitch + pitch, target.roll + roll * self._right))


class HeadPad(TargetWidget):
    """Shows target, simulation and hardware; reports new targets."""

    def __init__(self, texts: Texts) -> None:
        super().__init__(texts("label.head"), texts("tip.head_pad"))
        self._aim: Callable[[QPointF], None] | None = None
        """what the mouse drags: `_turn` or `_tilt`"""
        self._captions = {name: texts(f"label.pad_{name}") for name in (*CAPTIONS, *FACING.values())}
        self.setCursor(Qt.CursorShape.CrossCursor)
        self.setMinimumSize(140, 72)

    # Geometry

    @property
    def _centre(self) -> QPointF:
        return QPointF(self.width() / 2, self.height() / 2)

    @property
    def _outer(self) -> float:
        return min(self.width(), self.height() - 2 * self._style.px(LINE_PX)) / 2 - 6

    @property
    def _mark(self) -> float:
        """Half the width of the mark of the hardware (px); the others are larger."""
        return max(3.0, self._disc * 0.075)

    @property
    def _disc(self) -> float:
        return self._outer * (1 - RING) - 3

    def tilt_point(self, at: HeadOrientation, tilt_max: float) -> QPointF:
        """Return the point of pitch and roll (deg) on the disc: nose down is down, an ear down is at its side."""
        scale = self._disc / (tilt_max * BEYOND)
        x, y = at.roll * scale * self._right, at.pitch * scale
        shrink = min(1.0, self._disc / max(math.hypot(x, y), 1e-9))
        return self._centre + QPointF(x, y) * shrink

    @property
    def border(self) -> QPolygonF:
        """The orientations in which the head may rest, on the disc."""
        view = self._view
        return QPolygonF(
            [] if view is None else [self.tilt_point(at, view.tilt_max) for at in furthest(view)]
        )

    def yaw_point(self, yaw: float) -> QPointF:
        """Return the point of a yaw (deg) on the ring: 0 is up."""
        angle, radius = math.radians(yaw) * self._right, self._outer * (1 - RING / 2)
        return self._centre + QPointF(-math.sin(angle) * radius, -math.cos(angle) * radius)

    def _turn(self, offset: QPointF) -> None:
        """Aim at a point of the ring, by its offset from the middle."""
        if self._view is not None:
            yaw, limit = math.degrees(math.atan2(-offset.x() * self._right, -offset.y())), self._view.yaw_max
            self._report(replace(self._view.target, yaw=max(-limit, min(limit, yaw))))

    def _tilt(self, offset: QPointF) -> None:
        """Aim at a point of the disc, by its offset from the middle."""
        if self._view is not None:
            offset *= min(1.0, self._disc / max(math.hypot(offset.x(), offset.y()), 1e-9))
            scale = self._view.tilt_max * BEYOND / self._disc
            roll = offset.x() * scale * self._right
            self._report(replace(self._view.target, pitch=offset.y() * scale, roll=roll))

    # Mouse

    def mousePressEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        if event.button() != Qt.MouseButton.LeftButton:
            return
        offset = event.localPos() - self._centre
        reach = math.hypot(offset.x(), offset.y())
        if reach <= self._outer + 4:
            self._aim = self._tilt if reach <= self._disc + 1 else self._turn
            self.intent.emit(GrabHead())
            self._aim(offset)

    def mouseMoveEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        if self._aim is not None:
            self._aim(event.localPos() - self._centre)
            self._follow()

    def mouseReleaseEvent(self, _event: QMouseEvent) -> None:  # noqa: N802
        if self._aim is not None:
            self._aim = None
            self._let_go()

    # Drawing

    def paintEvent(self, _event: QPaintEvent) -> None:  # noqa: N802
        painter = QPainter(self)
        try:
            painter.setRenderHint(QPainter.RenderHint.Antialiasing)
            self._paint_ground(painter)
            self._paint_captions(painter)
            if self._view is not None:
                self._paint_heads(painter, self._view)
        finally:
            painter.end()  # Qt aborts if a painter stays active after an error

    def _paint_ground(self, painter: QPainter) -> None:
        centre, colours = self._centre, self._style
        draw_lines(painter, colours.accent if self.hasFocus() else colours.line, 2)
        painter.setBrush(QColor(colours.raised))
        painter.drawEllipse(centre, self._outer, self._outer)
        painter.setPen(Qt.PenStyle.NoPen)
        for colour, pattern in (
            (colours.ground, Qt.BrushStyle.SolidPattern),
            (colours.edge, Qt.BrushStyle.BDiagPattern),
        ):
            painter.setBrush(QBrush(QColor(colour), pattern))  # hatched: beyond the limit
            painter.drawEllipse(centre, self._disc, self._disc)
        limit = self._disc / BEYOND
        draw_lines(painter, colours.edge, 2)
        painter.setBrush(QColor(colours.field))
        painter.drawPolygon(self.border)
        draw_lines(painter, colours.line, 1)
        for share in (1 / 3, 2 / 3):
            painter.drawEllipse(centre, limit * share, limit * share)
        for way in (QPointF(limit, 0), QPointF(0, limit)):
            painter.drawLine(centre - way, centre + way)
        draw_lines(painter, colours.edge, 1.5)
        for yaw in range(-150, 181, 30):
            mark = self.yaw_point(yaw) - centre
            painter.drawLine(centre + mark * 0.965, centre + mark * 1.035)

    def _paint_captions(self, painter: QPainter) -> None:
        """Name the directions in words, because signs alone are ambiguous: in a corner only where it is free."""
        font, high = self.font(), min(self.height(), 2 * (self._outer + self._style.px(LINE_PX) + 6))
        whole = QRectF(0, (self.height() - high) / 2, self.width(), high)
        font.setPixelSize(self._style.px(LINE_PX - 3))
        painter.setFont(font)
        painter.setPen(QColor(self._style.dim))
        for name, alignment in CAPTIONS.items():
            text = self._captions[FACING.get(name, name) if self._right < 0 else name]
            place = painter.boundingRect(whole, int(alignment), text)
            if alignment & MIDDLE or self._is_beside_ring(place):
                painter.drawText(place, int(Qt.AlignmentFlag.AlignCenter), text)

    def _is_beside_ring(self, place: QRectF) -> bool:
        """Return whether the corner of a place that is nearest to the middle is outside of the ring and its marks."""
        off = place.translated(-self._centre)
        corner = min(abs(off.left()), abs(off.right())), min(abs(off.top()), abs(off.bottom()))
        return math.hypot(*corner) >= self._outer * (1 - RING / 2) + 2 * self._mark

    def _paint_heads(self, painter: QPainter, view: HeadView) -> None:
        """Draw the previewed path, the hardware, the simulation and the target, each on the disc and on the ring."""
        size, colours = self._mark, self._style
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(QColor(colours.dim))
        for point in self._points(view, *view.path):
            painter.drawEllipse(point, 1.8, 1.8)
        painter.setBrush(QColor(colours.hw))
        for point in self._points(view, view.hw):
            painter.drawRect(QRectF(point.x() - size, point.y() - size, 2 * size, 2 * size))
        draw_lines(painter, colours.sim, 2)
        for point in self._points(view, view.sim):
            for way in (QPointF(size * 1.5, 0), QPointF(0, size * 1.5)):
                painter.drawLine(point - way, point + way)
        draw_lines(painter, colours.text, 2.5)
        for point in self._points(view, view.target):
            painter.drawEllipse(point, size * 2, size * 2)

    def _points(self, view: HeadView, *heads: HeadOrientation | None) -> Iterator[QPointF]:
        """Yield the points of heads on the disc and on the ring."""
        for at in heads:
            if at is not None:
                yield self.tilt_point(at, view.tilt_max)
                yield self.yaw_point(at.yaw)


class HeadPanel(Panel):
    """The present and the target orientation of the head."""

    def __init__(self, texts: Texts) -> None:
        super().__init__("panel")
        self._texts = texts
        self.pad = HeadPad(texts)
        self.numbers = {
            (name, axis): label(role=role, right=True) for name, role in COLUMNS.items() for axis in AXES
        }
        self._names = {name: label(role=role, right=True) for name, role in COLUMNS.items()}
        for number in self.numbers.values():
            number.setProperty("figure", True)  # noqa: FBT003 - a constant width while the head moves
        self.reports(self.pad.intent)
        self.table = QWidget()
        """the numbers"""
        grid = spaced(QGridLayout(self.table), 1, NO_MARGINS)
        grid.setHorizontalSpacing(4)
        for column_number, name in enumerate(COLUMNS, start=1):
            grid.setColumnStretch(column_number, 1)
            grid.addWidget(self._names[name], 0, column_number)
            for line, axis in enumerate(AXES, start=1):
                grid.addWidget(self.numbers[name, axis], line, column_number)
        for line, axis in enumerate(AXES, start=1):
            title = label(texts(f"label.{axis}"), "dim")
            title.setToolTip(texts(f"tip.{axis}"))
            grid.addWidget(title, line, 0)
        self._layout = in_column(
            (self.pad, 1), in_column(None, self.table), gap=4, margins=(6, 6, 6, 6), inside=self
        )

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802
        """Put the numbers below the pad or, in a wide panel, beside it, where only their symbols have room."""
        super().resizeEvent(event)
        beside = self.width() > 1.3 * self.height()
        directions = QBoxLayout.Direction
        self._layout.setDirection(directions.LeftToRight if beside else directions.TopToBottom)
        for name, heading in self._names.items():
            words = self._texts(f"label.{name}")
            heading.setText(SYMBOLS[name] if beside else f"{SYMBOLS[name]} {words}")
            heading.setToolTip(words)

    def show_theme(self, theme: Theme) -> None:
        """Use the colours of a theme."""
        self.pad.show_theme(theme)

    def show_view(self, view: HeadView) -> None:
        """Show the pad and the numbers."""
        self.pad.show_view(view)
        for (name, axis), number in self.numbers.items():
            at = view.target if name == "target" else view.side(name)
            known = at is not None
            number.setText(
                self._texts("angle", degrees=getattr(at, axis)) if known else self._texts("unknown")
            )
