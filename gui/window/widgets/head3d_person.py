"""A map of the room, seen from the side of the head's picture: the robot, what its left eye sees, and the person.

In the picture of the head itself the person would stand behind the camera, or hide the robot's face.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

from PyQt5.QtCore import QPointF, QRectF, Qt, pyqtSignal
from PyQt5.QtGui import (
    QColor,
    QFocusEvent,
    QKeyEvent,
    QMouseEvent,
    QPainter,
    QPainterPath,
    QPaintEvent,
    QPolygonF,
)
from PyQt5.QtWidgets import QSizePolicy, QWidget

from gui.console.state.actions import MovePerson
from gui.console.state.world import Person
from gui.console.texts import Texts
from gui.window.theme import Style
from gui.window.widgets.controls import named
from gui.window.widgets.head3d_paint import draw_lines

REACH: Final = 1.6
"""Radius of the map (m): the person can be dragged so far."""
NEAREST: Final = 0.5
"""Smallest distance of the person from the robot (m)."""
STEEP: Final = math.radians(48.0)
"""Elevation of the viewer."""
SEES: Final = math.radians(37.6)
"""Half of the angle that the left eye sees across."""
AWAY: Final = -0.1
"""A head with a smaller way towards the viewer is seen from behind."""
STEP: Final = 0.1
"""Way of the person for an arrow key (m)."""
SKIN, HAIR, CAP, SHIRT, DARK = "#f0c39f", "#5b3a26", "#d31a8c", "#2f7f86", "#2b2320"
"""As in the simulated room."""
ARROWS: Final = {
    Qt.Key.Key_Left: (-1, 0),
    Qt.Key.Key_Right: (1, 0),
    Qt.Key.Key_Up: (0, -1),
    Qt.Key.Key_Down: (0, 1),
}


@dataclass(frozen=True)
class Floor:
    """Where points of the room (m) are on the map (px)."""

    azimuth: float
    """of the viewer (rad): 0 is in front of the robot"""
    width: float
    height: float

    @property
    def scale(self) -> float:
        """Pixels for a metre."""
        return min(self.width / (2 * REACH + 0.3), self.height / (2 * REACH * math.sin(STEEP) + 0.75))

    def place(self, x: float, y: float) -> QPointF:
        """Return the place of a point of the ground."""
        cos, sin = math.cos(self.azimuth), math.sin(self.azimuth)
        middle = self.height - (REACH * math.sin(STEEP) + 0.08) * self.scale
        across, near = y * cos - x * sin, x * cos + y * sin
        return QPointF(self.width / 2 + across * self.scale, middle + near * math.sin(STEEP) * self.scale)

    def way(self, x: float, y: float) -> QPointF:
        """Return a direction of the ground: to the right, and towards the viewer; its length is 1."""
        cos, sin, far = math.cos(self.azimuth), math.sin(self.azimuth), max(math.hypot(x, y), 1e-6)
        return QPointF(y * cos - x * sin, x * cos + y * sin) / far

    def ground(self, at: QPointF) -> tuple[float, float]:
        """Return the point of the ground at a place, as far from the robot as the person may be."""
        cos, sin = math.cos(self.azimuth), math.sin(self.azimuth)
        away = (at - self.place(0.0, 0.0)) / self.scale
        across, near = away.x(), away.y() / math.sin(STEEP)
        far = max(math.hypot(across, near), 1e-6)
        stretch = max(NEAREST, min(REACH, far)) / far
        return (near * cos - across * sin) * stretch, (across * cos + near * sin) * stretch


class PersonMap(QWidget):
    """Draws robot and person, and reports where the user drags the person; a press anywhere places the person."""

    intent = pyqtSignal(object)

    def __init__(self, texts: Texts) -> None:
        super().__init__()
        self.azimuth = 0.0
        """of the viewer (deg)"""
        self._yaw: float | None = None
        self._person: Person | None = None
        self._style: Style | None = None
        self._side = ""
        self._ring = 0
        named(self, texts("room.person"), texts("room.person_tip"))
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setCursor(Qt.CursorShape.PointingHandCursor)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)

    @property
    def floor(self) -> Floor:
        """The ground on the present map."""
        return Floor(math.radians(self.azimuth), self.width(), self.height())

    def show_room(self, person: Person | None, side: str, yaw: float | None) -> None:
        """Show the person, and the robot of this side, whose head has this yaw (deg); None: unknown."""
        self._person, self._yaw, self._side = person, yaw, side
        self._ring += person is not None and person.speaks
        self.update()

    def show_style(self, style: Style) -> None:
        """Use the colours of a theme."""
        self._style = style
        self.update()

    # Mouse and keys

    def mousePressEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        self.mouseMoveEvent(event)

    def mouseMoveEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        if event.buttons() & Qt.MouseButton.LeftButton:
            self._move(event.localPos())

    def keyPressEvent(self, event: QKeyEvent) -> None:  # noqa: N802
        arrow, person = ARROWS.get(Qt.Key(event.key())), self._person
        if arrow is None or person is None:
            super().keyPressEvent(event)
            return
        scale = self.floor.scale * STEP
        step = QPointF(arrow[0] * scale, arrow[1] * scale * math.sin(STEEP))
        self._move(self.floor.place(person.x, person.y) + step)

    def focusInEvent(self, event: QFocusEvent) -> None:  # noqa: N802
        super().focusInEvent(event)
        self.update()

    def _move(self, at: QPointF) -> None:
        if self._person is not None:
            self.intent.emit(MovePerson(*self.floor.ground(at), self._person.z))

    # Drawing

    def paintEvent(self, _event: QPaintEvent) -> None:  # noqa: N802
        painter, style = QPainter(self), self._style
        try:
            if style is None:
                return
            painter.setRenderHint(QPainter.RenderHint.Antialiasing)
            self._paint_ground(painter, style)
            person = self._person
            behind = person is not None and self._at(person).y() < self.floor.place(0.0, 0.0).y()
            if person is not None and behind:
                self._paint_person(painter, style, person)
            self._paint_robot(painter, style)
            if person is not None and not behind:
                self._paint_person(painter, style, person)
        finally:
            painter.end()  # Qt aborts if a painter stays active after an error

    def _at(self, person: Person) -> QPointF:
        return self.floor.place(person.x, person.y)

    def _paint_ground(self, painter: QPainter, style: Style) -> None:
        """Draw the ground, and on it what the eye sees."""
        floor = self.floor
        middle, radius = floor.place(0.0, 0.0), REACH * floor.scale
        painter.setPen(QColor(style.edge if self.hasFocus() else style.line))
        painter.setBrush(QColor(style.panel))
        painter.drawEllipse(middle, radius, radius * math.sin(STEEP))
        if self._yaw is not None:
            ways = [math.radians(self._yaw) + SEES * k / 6 for k in range(-6, 7)]
            edge = [floor.place(REACH * math.cos(way), REACH * math.sin(way)) for way in ways]
            fan = QColor(style.side(self._side))
            fan.setAlphaF(0.25)
            painter.setPen(Qt.PenStyle.NoPen)
            painter.setBrush(fan)
            painter.drawPolygon(QPolygonF([middle, *edge]))

    def _paint_robot(self, painter: QPainter, style: Style) -> None:
        """Draw the robot as a small head that looks where its head looks."""
        middle, size = self.floor.place(0.0, 0.0), 0.18 * self.floor.scale
        head, yaw = middle - QPointF(0.0, 1.6 * size), math.radians(self._yaw or 0.0)
        draw_lines(painter, style.dim, 3)
        painter.drawLine(middle, head)
        paint_head(painter, head, size, style.text, style.text)
        paint_eyes(painter, head, size, self.floor.way(math.cos(yaw), math.sin(yaw)), style.field)

    def _paint_person(self, painter: QPainter, style: Style, person: Person) -> None:
        """Draw the person, who faces the robot, with a magenta cap; rings at the mouth while the person speaks."""
        foot, size = self._at(person), 0.21 * self.floor.scale
        head, way = foot - QPointF(0.0, 2.5 * size), self.floor.way(-person.x, -person.y)
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(QColor(SHIRT))
        body = QRectF(foot.x() - 1.15 * size, head.y() + size * 0.8, 2.3 * size, 1.8 * size)
        painter.drawRoundedRect(body, size, size)
        paint_head(painter, head, size, SKIN, HAIR if way.y() < AWAY else SKIN)
        if paint_eyes(painter, head, size, way, DARK):
            draw_lines(painter, DARK, 1.5)
            smile = QRectF(
                head.x() + way.x() * size * 0.6 - 0.35 * size, head.y() + 0.2 * size, 0.7 * size, 0.5 * size
            )
            painter.drawArc(smile, -150 * 16, 120 * 16)
        wide = 1.08 * size
        cap = QPainterPath(head + QPointF(-wide, -0.2 * size))
        cap.arcTo(QRectF(head.x() - wide, head.y() - 1.3 * size, 2 * wide, 2.2 * size), 180.0, -180.0)
        painter.fillPath(cap, QColor(CAP))
        if person.speaks:
            self._paint_rings(painter, style, head + QPointF(0.0, 0.45 * size), way, size)

    def _paint_rings(
        self, painter: QPainter, style: Style, mouth: QPointF, way: QPointF, size: float
    ) -> None:
        """Draw arcs that go from the mouth to the robot."""
        towards = math.degrees(math.atan2(-way.y() * math.sin(STEEP), way.x()))
        for number in range(3):
            radius = size * (1.3 + 0.6 * number)
            shade = QColor(style.warn)
            shade.setAlphaF(1.0 if number == self._ring // 2 % 3 else 0.45)
            draw_lines(painter, shade.name(QColor.NameFormat.HexArgb), 2.5)
            around = QRectF(mouth.x() - radius, mouth.y() - radius, 2 * radius, 2 * radius)
            painter.drawArc(around, round((towards - 35) * 16), 70 * 16)


def paint_head(painter: QPainter, head: QPointF, size: float, face: str, hair: str) -> None:
    """Draw a head whose visible side is the face, or the hair."""
    painter.setPen(QColor(face))
    painter.setBrush(QColor(hair))
    painter.drawEllipse(head, size, size * 1.1)


def paint_eyes(painter: QPainter, head: QPointF, size: float, way: QPointF, colour: str) -> bool:
    """Draw the eyes of a head that looks this way, see `Floor.way`; return False if it looks away from the viewer."""
    if way.y() < AWAY:
        return False
    painter.setPen(Qt.PenStyle.NoPen)
    painter.setBrush(QColor(colour))
    for eye in (-0.36, 0.36):
        painter.drawEllipse(
            head + QPointF((0.6 * way.x() + eye) * size, 0.1 * size), 0.14 * size, 0.18 * size
        )
    return True
