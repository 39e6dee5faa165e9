"""Painting for `head3d`: the robots as shaded faces, the outline of the target, handles and limits."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache
from typing import Final

import numpy as np
from PyQt5.QtCore import QPointF, QRectF, Qt
from PyQt5.QtGui import QBrush, QColor, QPainter, QPen, QPolygonF, QRadialGradient

from beatrix_zenoh.body.figure import Figure, meshes
from beatrix_zenoh.body.scene import HeadDrawing, Screen, draw, hull
from beatrix_zenoh.body.surface import Floats
from beatrix_zenoh.contract.errors import Refused
from beatrix_zenoh.motion.kinematics import Neck
from beatrix_zenoh.motion.limits.region import reach
from gui.console.state.intents import HeadOrientation
from gui.console.state.views import HeadView
from gui.console.texts import Texts
from gui.window.theme import Style
from gui.window.widgets.head3d_drag import CROWN, EARS, FLOOR, NOSE, Part, on_screen, turned

GHOST: Final = 0.42
"""Opacity of the ghost."""
TINT: Final = 0.4
"""Share of the robot's colour in each colour of the ghost."""
GREY: Final = 0.7
"""Share of grey in each colour of a robot that is silent."""
NEAR_DEG: Final = 0.35
"""Difference of two heads that are drawn as one."""
GLOW: Final = 0.85
"""Share of a limit from which its border glows."""
RING: Final = 0.15
"""Radius (m) of the ring on the ground."""
AHEAD: Final = 0.06
"""Length (m) of the line from the nose."""
POINT_BYTES: Final = 16
GAP: Final = 12.0
"""Room (px) beside a sentence."""


@cache
def _neck() -> Neck:
    return Neck()


@cache
def _figure() -> Figure:
    return Figure()


def apart(one: HeadOrientation | None, other: HeadOrientation | None) -> bool:
    """Return whether two heads are drawn separately."""
    if one is None or other is None:
        return True
    return max(abs(one.yaw - other.yaw), abs(one.pitch - other.pitch), abs(one.roll - other.roll)) > NEAR_DEG


# -- the robots -------------------------------------------------------------------------------------


def paint_robot(
    painter: QPainter, head: HeadOrientation | None, screen: Screen, style: Style, *, grey: bool
) -> None:
    """Draw the ring under the robot with an arrow ahead, and the robot, grey if it is silent; nothing without a robot."""
    if head is None:
        return
    turn = np.linspace(0.0, math.tau, 49)
    for radius, width in ((RING, 2.0), (RING * 1.25, 1.0)):
        ring = np.column_stack((np.cos(turn) * radius, np.sin(turn) * radius, np.full(49, FLOOR)))
        painter.setPen(QPen(QColor(style.line), width))
        painter.drawPolyline(_polygon(screen.place(ring)[:, :2]))
    ahead = np.array([(1.4, 0.10), (1.25, 0.0), (1.4, -0.10)]) * RING
    painter.setPen(Qt.PenStyle.NoPen)
    painter.setBrush(QColor(style.edge))
    painter.drawPolygon(_polygon(screen.place(np.column_stack((ahead, np.full(3, FLOOR))))[:, :2]))
    drawing = _drawing(head, screen)
    _paint(painter, _tinted(drawing, style.disabled, GREY) if grey else drawing)


def paint_ghost(painter: QPainter, head: HeadOrientation, screen: Screen, tint: str) -> None:
    """Draw head and arms, tinted with a colour."""
    _paint(painter, _tinted(_drawing(head, screen, base=False), tint, TINT))


def _drawing(head: HeadOrientation, screen: Screen, *, base: bool = True) -> HeadDrawing:
    """Return the faces of a robot whose head has this orientation; without arms if no arms fit it."""
    shown = [mesh for mesh in meshes(_figure()) if base or mesh.body != "base"]
    rows = turned(head)
    try:
        arms = _neck().inverse(*(math.radians(angle) for angle in (head.yaw, head.pitch, head.roll)))
    except Refused:
        arms = (0.0, 0.0, 0.0)
        shown = [mesh for mesh in shown if mesh.body in {"base", "head"}]
    return draw(tuple(shown), _figure().orientations(arms, rows), screen)


def _tinted(drawing: HeadDrawing, tint: str, share: float) -> HeadDrawing:
    parts = np.stack([drawing.colours >> shift & 255 for shift in (16, 8, 0)], axis=1)
    mixed = parts * (1 - share) + np.array(QColor(tint).getRgb()[:3]) * share
    red, green, blue = (mixed.astype(np.int64) & 0xF8).T  # few colours, so that brushes are found again
    return HeadDrawing(drawing.corners, (red << 16) | (green << 8) | blue)


@cache
def _brush(colour: int) -> QBrush:
    return QBrush(QColor(colour))


def _polygon(points: Floats) -> QPolygonF:
    """Return a polygon of points, (n, 2), through its buffer: this is much quicker than point by point."""
    polygon = QPolygonF(len(points))
    pointer = polygon.data()
    pointer.setsize(len(points) * POINT_BYTES)
    np.frombuffer(memoryview(pointer), dtype=np.float64)[:] = points.reshape(-1)  # type: ignore[arg-type]
    return polygon


def _paint(painter: QPainter, drawing: HeadDrawing) -> None:
    painter.setPen(Qt.PenStyle.NoPen)
    corners, last = _polygon(drawing.corners.reshape(-1, 2)), -1
    for face, colour in enumerate(drawing.colours.tolist()):
        if colour != last:
            painter.setBrush(_brush(colour))
            last = colour
        painter.drawConvexPolygon(corners.mid(4 * face, 4))


# -- target, handles and limits ---------------------------------------------------------------------


@dataclass(frozen=True)
class Marks:
    """What is drawn over the robots."""

    view: HeadView
    screen: Screen
    style: Style
    part: Part | None
    """the part under the mouse"""
    dragged: bool

    @property
    def strain(self) -> float:
        """Lean of the target, divided by the limit in its direction."""
        target = self.view.target
        furthest = reach(self.view.drag.border, target.pitch, target.roll)
        return math.hypot(target.pitch, target.roll) / furthest

    @property
    def twist(self) -> float:
        """Yaw of the target, divided by the limit."""
        return abs(self.view.target.yaw) / self.view.yaw_max


def paint_marks(painter: QPainter, marks: Marks, texts: Texts, *, focused: bool) -> None:
    """Draw the border, the outline of the target and the handles."""
    view = marks.view
    shown = view.shown
    aims = marks.dragged or apart(shown, view.target)
    if shown is None:
        _paint_nothing(painter, marks, texts)
    else:
        if aims or marks.strain > GLOW:
            _paint_border(painter, marks)
        if aims:
            _paint_outline(painter, marks)
        _paint_handles(painter, marks, aims=aims)
        _paint_letters(painter, marks, texts)
    if focused:
        painter.setPen(QPen(QColor(marks.style.accent), 2))
        painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.drawRect(QRectF(1, 1, marks.screen.width - 2, marks.screen.height - 2))


def _paint_border(painter: QPainter, marks: Marks) -> None:
    """Draw where the crown of the head may be; it glows where the target is near it or beyond."""
    border = marks.view.drag.border
    count = len(border)
    crowns, yaw = [], marks.view.target.yaw
    for k, lean in enumerate(border):
        turn = math.tau * k / count
        rows = turned(HeadOrientation(yaw, lean * math.sin(turn), lean * math.cos(turn)))
        crowns.append([row[2] * CROWN[2] for row in rows])  # the crown is on the axis z of the head
    points = marks.screen.place(np.array(crowns))[:, :2]
    painter.setBrush(Qt.BrushStyle.NoBrush)
    painter.setPen(QPen(QColor(marks.style.edge), 1.5, Qt.PenStyle.DashLine))
    painter.drawPolygon(_polygon(points))
    if marks.strain > GLOW:
        target = marks.view.target
        at = round(math.atan2(target.pitch, target.roll) / math.tau * count)
        near = points[[(at + k) % count for k in range(-6, 7)]]
        glow = QColor(marks.style.bad if marks.strain > 1 else marks.style.warn)
        for width, opacity in ((14.0, 50), (8.0, 110), (3.0, 255)):
            glow.setAlpha(opacity)
            painter.setPen(QPen(glow, width, Qt.PenStyle.SolidLine, Qt.PenCapStyle.RoundCap))
            painter.drawPolyline(_polygon(near))
    if marks.twist > GLOW:
        _glow_at(painter, on_screen(marks.screen, marks.view.target, NOSE), marks)


def _glow_at(painter: QPainter, place: Floats, marks: Marks) -> None:
    """Let the nose glow where the yaw ends."""
    middle, colour = QPointF(place[0], place[1]), QColor(marks.style.warn)
    gradient = QRadialGradient(middle, 30.0)
    gradient.setColorAt(0.0, colour)
    colour.setAlpha(0)
    gradient.setColorAt(1.0, colour)
    painter.setPen(Qt.PenStyle.NoPen)
    painter.setBrush(gradient)
    painter.drawEllipse(middle, 30.0, 30.0)


def _paint_outline(painter: QPainter, marks: Marks) -> None:
    """Draw the outline of the head at the target, with eyes if they are turned to the viewer."""
    screen, target = marks.screen, marks.view.target
    rows = np.array(turned(target))
    (head,) = (mesh for mesh in meshes(_figure()) if mesh.body == "head")
    skull = head.points[head.points[:, 2] > 0.05] @ rows.T
    painter.setBrush(Qt.BrushStyle.NoBrush)
    refused = marks.strain > 1
    painter.setPen(QPen(QColor(marks.style.bad if refused else marks.style.text), 2.5))
    painter.drawPolygon(_polygon(hull(screen.place(skull)[:, :2])))
    if float(screen.camera.axes[2] @ rows[:, 0]) > 0.1:
        size = _figure().size
        for side in (1, -1):
            eye = on_screen(screen, target, (0.1, side * size.eye_baseline / 2, size.centre_height + 0.018))
            painter.drawEllipse(QPointF(eye[0], eye[1]), screen.scale * 0.02, screen.scale * 0.02)


def _paint_handles(painter: QPainter, marks: Marks, *, aims: bool) -> None:
    """Draw where to grab: the nose with a line ahead, and the ears."""
    screen, target, style = marks.screen, marks.view.target, marks.style
    x, y, z = NOSE
    nose = on_screen(screen, target, NOSE)
    tip = on_screen(screen, target, (x + AHEAD, y, z))
    over = marks.part is Part.FACE
    painter.setPen(QPen(QColor(style.accent if over else style.text), 3 if over else 2))
    painter.setBrush(QColor(style.accent) if over else Qt.BrushStyle.NoBrush)
    if aims or over:
        painter.drawLine(QPointF(nose[0], nose[1]), QPointF(tip[0], tip[1]))
        painter.drawEllipse(QPointF(tip[0], tip[1]), 6.0, 6.0)
    for part in (Part.LEFT_EAR, Part.RIGHT_EAR):
        if marks.part is part:
            ear = on_screen(screen, target, EARS[part])
            painter.setPen(QPen(QColor(style.accent), 3))
            painter.setBrush(Qt.BrushStyle.NoBrush)
            painter.drawEllipse(QPointF(ear[0], ear[1]), 16.0, 16.0)


def _paint_nothing(painter: QPainter, marks: Marks, texts: Texts) -> None:
    """Say that no robot is online; an outline would cross the sentence."""
    painter.setPen(QColor(marks.style.text))
    whole = QRectF(GAP, 0, marks.screen.width - 2 * GAP, marks.screen.height)
    wrapped = int(Qt.AlignmentFlag.AlignCenter) | int(Qt.TextFlag.TextWordWrap)
    painter.drawText(whole, wrapped, texts("label.no_head"))


def _paint_letters(painter: QPainter, marks: Marks, texts: Texts) -> None:
    """Name the robots, and a refused target where it is."""
    view, style = marks.view, marks.style
    font = painter.font()
    font.setPixelSize(style.px(12))
    painter.setFont(font)
    names = [
        (f"{symbol} {texts(f'side.{side}')}", style.side(side))
        for symbol, side in (("■", "hw"), ("+", "sim"))
        if view.side(side) is not None
    ]
    if view.silent:
        names.append((f"◌ {texts(f'side.{view.solid}')}: {texts('condition.silent')}", style.bad))
    x = style.px(10)
    for text, colour in names:
        painter.setPen(QColor(colour))
        painter.drawText(QPointF(x, style.px(18)), text)
        x += painter.fontMetrics().horizontalAdvance(text) + style.px(14)
    if view.drag.refused is not None:
        place = on_screen(marks.screen, view.drag.refused, CROWN)
        painter.setPen(QPen(QColor(style.bad), 3))
        for way in (QPointF(6, 6), QPointF(6, -6)):
            painter.drawLine(QPointF(place[0], place[1]) - way, QPointF(place[0], place[1]) + way)
        wide = painter.fontMetrics().horizontalAdvance(view.drag.reason) + style.px(8)
        box = QRectF(place[0] + 12, place[1] - style.px(9), wide, style.px(18))
        painter.fillRect(box, QColor(style.notice))
        painter.drawText(box, int(Qt.AlignmentFlag.AlignCenter), view.drag.reason)
