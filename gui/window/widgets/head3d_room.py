"""The room beside the head: a map with robot and person, turned like the picture, and what the left eye sees."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

from PyQt5.QtCore import QEvent, QObject, QPointF, QRectF, Qt
from PyQt5.QtGui import QColor, QKeyEvent, QMouseEvent, QPainter, QPaintEvent, QPolygonF
from PyQt5.QtWidgets import QWidget

from beatrix_zenoh.client import CameraImage
from gui.console.state.actions import MovePerson
from gui.console.state.intents import Theme
from gui.console.state.views import RoomView
from gui.console.texts import Texts
from gui.window.theme import Style, style_of
from gui.window.widgets.controls import NO_MARGINS, Panel, in_column, in_row, named
from gui.window.widgets.eyes import CameraPicture
from gui.window.widgets.head3d_paint import draw_lines

NEAREST, REACH = 0.5, 1.6
"""How near and how far (m) from the robot the user may place the person: always inside the room."""
STEEP: Final = math.sin(math.radians(48.0))
"""How much the ground is shortened for a viewer at this elevation."""
SEES: Final = math.radians(37.6)
"""Half of the angle that an eye sees across."""
STEP_PX: Final = 6
"""Way of the person on the map for an arrow key."""
SKIN, HAIR, CAP, SHIRT, DARK = "#f0c39f", "#5b3a26", "#d31a8c", "#2f7f86", "#2b2320"
"""As in the simulated room."""
ARROWS: Final = {
    Qt.Key.Key_Left: QPointF(-STEP_PX, 0),
    Qt.Key.Key_Right: QPointF(STEP_PX, 0),
    Qt.Key.Key_Up: QPointF(0, -STEP_PX),
    Qt.Key.Key_Down: QPointF(0, STEP_PX),
}
SHARE: Final = 0.29
"""Share of the picture's width that map and eye take each."""
MARGIN_PX, ABOVE_PX, BELOW_PX = 8, 32, 44
"""Free at the sides of the picture, and above and below, where names and controls are."""


@dataclass(frozen=True)
class Floor:
    """Where points of the ground (m) are on the map (px)."""

    azimuth: float
    """of the viewer (rad): 0 is in front of the robot"""
    width: float
    height: float

    @property
    def scale(self) -> float:
        """Pixels for a metre."""
        return min(self.width / (2 * REACH + 0.3), self.height / (2 * REACH * STEEP + 0.75))

    def seen(self, x: float, y: float) -> QPointF:
        """Return a way on the ground as the viewer sees it: to the right, and towards the viewer."""
        cos, sin = math.cos(self.azimuth), math.sin(self.azimuth)
        return QPointF(y * cos - x * sin, x * cos + y * sin)

    def place(self, x: float, y: float) -> QPointF:
        """Return the place of a point."""
        seen, middle = self.seen(x, y), self.height - (REACH * STEEP + 0.08) * self.scale
        return QPointF(self.width / 2 + seen.x() * self.scale, middle + seen.y() * STEEP * self.scale)

    def ground(self, at: QPointF) -> tuple[float, float]:
        """Return the point at a place, or the nearest one where the person may be."""
        away, cos, sin = at - self.place(0.0, 0.0), math.cos(self.azimuth), math.sin(self.azimuth)
        across, near = away.x() / self.scale, away.y() / STEEP / self.scale
        far = max(math.hypot(across, near), 1e-6)
        stretch = max(NEAREST, min(REACH, far)) / far
        return (near * cos - across * sin) * stretch, (across * cos + near * sin) * stretch


class PersonMap(Panel):
    """Draws robot and person, and reports where the user drags the person; a press anywhere places the person."""

    def __init__(self, texts: Texts) -> None:
        super().__init__()
        self.azimuth = 0.0
        """of the viewer (deg)"""
        self._style: Style = style_of(Theme.DARK)
        self._room: RoomView | None = None
        self._ring = 0
        named(self, texts("room.person"), texts("room.person_tip"))
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setCursor(Qt.CursorShape.PointingHandCursor)

    @property
    def floor(self) -> Floor:
        """The ground on the present map."""
        return Floor(math.radians(self.azimuth), self.width(), self.height())

    def show_theme(self, theme: Theme) -> None:
        """Use the colours of a theme."""
        self._style = style_of(theme)

    def show_view(self, view: RoomView) -> None:
        """Show robot and person; while the person speaks, the rings move with each view."""
        self._room = view
        self._ring += 1
        self.update()

    def mousePressEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        self._move(event.localPos())

    def mouseMoveEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        self._move(event.localPos())

    def keyPressEvent(self, event: QKeyEvent) -> None:  # noqa: N802
        step, room = ARROWS.get(Qt.Key(event.key())), self._room
        if step is not None and room is not None and room.person is not None:
            self._move(self.floor.place(room.person.x, room.person.y) + step)
        else:
            super().keyPressEvent(event)

    def _move(self, at: QPointF) -> None:
        if self._room is not None and self._room.person is not None:
            self.intent.emit(MovePerson(*self.floor.ground(at), self._room.person.z))

    def paintEvent(self, _event: QPaintEvent) -> None:  # noqa: N802
        painter, room = QPainter(self), self._room
        try:
            painter.setRenderHint(QPainter.RenderHint.Antialiasing)
            if room is not None:
                self._paint_ground(painter, room)
                robot, person = self.floor.place(0.0, 0.0), room.person
                behind = person is not None and self.floor.place(person.x, person.y).y() < robot.y()
                for shows_person in (behind, not behind):
                    (self._paint_person if shows_person else self._paint_robot)(painter, room)
        finally:
            painter.end()  # Qt aborts if a painter stays active after an error

    def _paint_ground(self, painter: QPainter, room: RoomView) -> None:
        """Draw the ground, and on it what the eye sees."""
        floor, style = self.floor, self._style
        middle, radius = floor.place(0.0, 0.0), REACH * floor.scale
        painter.setPen(QColor(style.edge if self.hasFocus() else style.line))
        painter.setBrush(QColor(style.panel))
        painter.drawEllipse(middle, radius, radius * STEEP)
        if room.yaw is not None:
            ways = [math.radians(room.yaw) + SEES * k / 6 for k in range(-6, 7)]
            fan = QColor(style.side(room.eye.side))
            fan.setAlphaF(0.3)
            painter.setPen(Qt.PenStyle.NoPen)
            painter.setBrush(fan)
            edge = (floor.place(REACH * math.cos(way), REACH * math.sin(way)) for way in ways)
            painter.drawPolygon(QPolygonF([middle, *edge]))

    def _paint_robot(self, painter: QPainter, room: RoomView) -> None:
        """Draw the robot as a small head that looks where its head looks."""
        floor, style, yaw = self.floor, self._style, math.radians(room.yaw or 0.0)
        foot, size = floor.place(0.0, 0.0), 0.18 * floor.scale
        draw_lines(painter, style.dim, 3)
        painter.drawLine(foot, foot - QPointF(0.0, size))
        way = floor.seen(math.cos(yaw), math.sin(yaw))
        paint_head(painter, foot - QPointF(0.0, 1.6 * size), size, way, (style.text, style.text, style.field))

    def _paint_person(self, painter: QPainter, room: RoomView) -> None:
        """Draw the person, who faces the robot, with a magenta cap; rings at the mouth while the person speaks."""
        floor, person = self.floor, room.person
        if person is None:
            return
        foot, size = floor.place(person.x, person.y), 0.21 * floor.scale
        head, way = foot - QPointF(0.0, 2.5 * size), floor.seen(-person.x, -person.y)
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(QColor(SHIRT))
        painter.drawRoundedRect(around(head + QPointF(0.0, 1.7 * size), 1.15 * size, 0.9 * size), size, size)
        paint_head(painter, head, size, way / math.hypot(person.x, person.y), (SKIN, HAIR, DARK))
        painter.setBrush(QColor(CAP))
        painter.drawChord(around(head - QPointF(0.0, 0.2 * size), 1.08 * size, 1.1 * size), 0, 180 * 16)
        towards = math.degrees(math.atan2(-way.y() * STEEP, way.x()))
        for number in range(3) if person.speaks else ():
            shade = QColor(self._style.warn)
            shade.setAlphaF(1.0 if number == self._ring // 2 % 3 else 0.45)
            draw_lines(painter, shade.name(QColor.NameFormat.HexArgb), 2.5)
            ring = size * (1.3 + 0.6 * number)
            painter.drawArc(
                around(head + QPointF(0.0, 0.45 * size), ring, ring), round((towards - 35) * 16), 70 * 16
            )


def around(middle: QPointF, across: float, up: float) -> QRectF:
    """Return the rectangle with this middle and half of its width and height."""
    return QRectF(middle.x() - across, middle.y() - up, 2 * across, 2 * up)


def paint_head(
    painter: QPainter, head: QPointF, size: float, way: QPointF, colours: tuple[str, str, str]
) -> None:
    """Draw a head that looks this way, see `Floor.seen`; colours of the face, of the hair, and of the eyes."""
    face, hair, eyes = colours
    looks_here = way.y() > -0.1
    painter.setPen(Qt.PenStyle.NoPen)
    painter.setBrush(QColor(face if looks_here else hair))
    painter.drawEllipse(head, size, size * 1.1)
    if looks_here:
        painter.setBrush(QColor(eyes))
        nose = head + QPointF(0.6 * way.x(), 0.1) * size
        for eye in (-0.36, 0.36):
            painter.drawEllipse(nose + QPointF(eye * size, 0.0), 0.14 * size, 0.18 * size)
        painter.drawChord(around(nose + QPointF(0.0, 0.4 * size), 0.35 * size, 0.25 * size), 0, -180 * 16)


class Room(Panel):
    """The map with a button, at the right of its parent, and the eye at the left; hidden without a view."""

    def __init__(self, texts: Texts, parent: QWidget) -> None:
        """Create it hidden."""
        super().__init__(parent=parent)
        self._view: RoomView | None = None
        self.map, self.eye, self.speak = PersonMap(texts), CameraPicture(texts), self.button()
        self.eye.setParent(parent)
        self.reports(self.map.intent)
        in_column((self.map, 1), in_row(None, self.speak, None), gap=2, margins=NO_MARGINS, inside=self)
        parent.installEventFilter(self)
        self.show_view(None)

    def show_theme(self, theme: Theme) -> None:
        """Use the colours of a theme."""
        self.map.show_theme(theme)

    def show_view(self, view: RoomView | None) -> None:
        """Show the room, or hide it."""
        self._view = view
        if view is not None:
            self.map.show_view(view)
            self.speak.show_view(view.speak)
            self.eye.show_view(view.eye)
        shows_map = view is not None and view.person is not None
        for part, shows in ((self.eye, view is not None), (self, shows_map)):
            if part.isHidden() == shows:
                part.setVisible(shows)
                part.raise_()  # over the texts of the parent, which would get the presses
                self._place()

    def show_image(self, side: str, image: CameraImage) -> None:
        """Show a picture if it is that of the shown eye."""
        if self._view is not None and (side, image.eye) == (self._view.eye.side, self._view.eye.eye):
            self.eye.show_image(image)

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:  # noqa: N802
        if event.type() == QEvent.Type.Resize:
            self._place()
        return super().eventFilter(watched, event)

    def _place(self) -> None:
        """Take the upper corners of the parent."""
        size = self.parentWidget().size()
        room = size.height() - ABOVE_PX - BELOW_PX
        width = round(min(size.width() * SHARE, room * 1.1))
        self.eye.setGeometry(MARGIN_PX, ABOVE_PX, width, min(room, round(0.75 * width) + ABOVE_PX))
        self.setGeometry(size.width() - width - MARGIN_PX, ABOVE_PX, width, min(room, width))
