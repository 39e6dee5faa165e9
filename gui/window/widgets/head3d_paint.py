"""Painting for `head3d`: the robots as shaded faces, the outline of the target, handles and limits."""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cache, lru_cache
from typing import Final

import numpy as np
from PyQt5.QtCore import QPointF, QRectF, QSizeF, Qt
from PyQt5.QtGui import QBrush, QColor, QImage, QPainter, QPen, QPolygonF

from beatrix_zenoh.body.figure import Figure, meshes
from beatrix_zenoh.body.head_shape import AWAKE, Face
from beatrix_zenoh.body.scene import CROWN, EARS, NOSE, SKULL, Screen, Viewpoint, Whole, draw, hull
from beatrix_zenoh.body.surface import Floats, Mesh
from beatrix_zenoh.contract.errors import Refused
from beatrix_zenoh.motion.kinematics import Neck
from beatrix_zenoh.motion.limits.region import reach
from gui.console.state.intents import HeadOrientation
from gui.console.state.views import HeadView
from gui.window.theme import Style
from gui.window.widgets.head3d_drag import FLOOR, Part, furthest, on_screen, turned

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
PORTRAIT_ZOOM: Final = 1.6
POINT_BYTES: Final = 16


@cache
def _neck() -> Neck:
    return Neck()


@cache
def _figure() -> Figure:
    return Figure()


def apart(one: HeadOrientation | None, other: HeadOrientation | None) -> bool:
    """Return whether two heads are drawn separately."""
    return one is None or other is None or one.away(other) > NEAR_DEG


# -- the robots -------------------------------------------------------------------------------------


@lru_cache(maxsize=4)
def robot(
    head: HeadOrientation, screen: Screen, ratio: float, style: Style, *, silent: bool, face: Face = AWAKE
) -> QImage:
    """Return the robot with a ring below it and an arrow ahead, grey if it is silent; kept while it rests."""
    with painted(screen.width, screen.height, ratio) as (image, painter):
        turn = np.linspace(0.0, math.tau, 49)
        for radius, width in ((RING, 2.0), (RING * 1.25, 1.0)):
            draw_lines(painter, style.line, width)
            ring = np.column_stack((np.cos(turn) * radius, np.sin(turn) * radius, np.full(49, FLOOR)))
            painter.drawPolyline(_polygon(screen.place(ring)[:, :2]))
        ahead = np.array([(1.4, 0.10), (1.25, 0.0), (1.4, -0.10)]) * RING
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(QColor(style.edge))
        painter.drawPolygon(_polygon(screen.place(np.column_stack((ahead, np.full(3, FLOOR))))[:, :2]))
        tint = (style.disabled, GREY) if silent else None
        _paint_faces(painter, head, screen, meshes(_figure(), face=face), tint)
    return image


@lru_cache(maxsize=2)
def ghost(head: HeadOrientation, screen: Screen, ratio: float, tint: str) -> QImage:
    """Return head and arms, tinted with a colour."""
    with painted(screen.width, screen.height, ratio) as (image, painter):
        shown = tuple(mesh for mesh in meshes(_figure()) if mesh.body != "base")
        _paint_faces(painter, head, screen, shown, (tint, TINT))
    return image


@lru_cache(maxsize=64)
def portrait(head: HeadOrientation | None, side: int, ratio: float, *, facing: bool = True) -> QImage:
    """Return the head alone from the front in a square of this side (px); not `facing`: its left is at the left.

    Without a head the square is empty.
    """
    screen = Screen(Viewpoint(0.0, zoom=PORTRAIT_ZOOM, height=SKULL[2] - 0.01), side, side)
    with painted(screen.width, screen.height, ratio) as (image, painter):
        if head is not None:
            shown = tuple(mesh for mesh in meshes(_figure()) if mesh.body == "head")
            _paint_faces(painter, head, screen, shown, None)
    return image if facing else image.mirrored(horizontal=True, vertical=False)


@contextmanager
def painted(width: float, height: float, ratio: float) -> Iterator[tuple[QImage, QPainter]]:
    """Yield a transparent picture of this size (px) for a display with this ratio of pixels, and a painter for it."""
    size = QSizeF(width * ratio, height * ratio).toSize()
    image = QImage(size, QImage.Format.Format_ARGB32_Premultiplied)
    image.setDevicePixelRatio(ratio)
    image.fill(Qt.GlobalColor.transparent)
    painter = QPainter(image)
    try:
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        yield image, painter
    finally:
        painter.end()  # Qt aborts if a painter stays active after an error


def draw_lines(
    painter: QPainter, colour: str, width: float, style: Qt.PenStyle = Qt.PenStyle.SolidLine
) -> None:
    """Let the painter draw lines and outlines, without filling them."""
    painter.setPen(QPen(QColor(colour), width, style))
    painter.setBrush(Qt.BrushStyle.NoBrush)


def _paint_faces(
    painter: QPainter,
    head: HeadOrientation,
    screen: Screen,
    shown: tuple[Mesh, ...],
    tint: tuple[str, float] | None,
) -> None:
    """Draw meshes of a robot whose head has this orientation, without arms if none fit it; `tint`: a colour and its share."""
    try:
        arms = _neck().inverse(*(math.radians(angle) for angle in (head.yaw, head.pitch, head.roll)))
    except Refused:
        arms = (0.0, 0.0, 0.0)
        shown = tuple(mesh for mesh in shown if mesh.body in {"base", "head"})
    drawing = draw(shown, _figure().orientations(arms, turned(head)), screen)
    colours = drawing.colours if tint is None else _tinted(drawing.colours, *tint)
    painter.setPen(Qt.PenStyle.NoPen)
    corners, last = _polygon(drawing.corners.reshape(-1, 2)), -1
    for face, colour in enumerate(colours.tolist()):
        if colour != last:
            painter.setBrush(_brush(colour))
            last = colour
        painter.drawConvexPolygon(corners.mid(4 * face, 4))


def _tinted(colours: Whole, tint: str, share: float) -> Whole:
    parts = np.stack([colours >> shift & 255 for shift in (16, 8, 0)], axis=1)
    mixed = parts * (1 - share) + np.array(QColor(tint).getRgb()[:3]) * share
    red, green, blue = (mixed.astype(np.int64) & 0xF8).T  # few colours, so that brushes are found again
    tinted: Whole = (red << 16) | (green << 8) | blue
    return tinted


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


# -- target, handles and limits ---------------------------------------------------------------------


@dataclass(frozen=True)
class Marks:
    """What is drawn over the robots."""

    painter: QPainter
    view: HeadView
    screen: Screen
    style: Style
    part: Part | None
    """the part under the mouse"""

    @property
    def strain(self) -> float:
        """Lean of the target, divided by the limit in its direction."""
        target = self.view.target
        furthest = reach(self.view.drag.border, target.pitch, target.roll)
        return math.hypot(target.pitch, target.roll) / furthest

    def paint(self, *, dragged: bool) -> None:
        """Draw the border, the outline of the target, the handles, and a refused target."""
        aims = dragged or apart(self.view.shown, self.view.target)
        if aims or self.strain > GLOW:
            self._paint_border()
        if aims:
            self._paint_outline()
        self._paint_handles(aims=aims)
        if self.view.drag.refused is not None:
            self._paint_refused(self.view.drag.refused)

    def _at(self, point: tuple[float, float, float]) -> QPointF:
        """Return the place of a point of the target."""
        x, y, _ = on_screen(self.screen, self.view.target, point)
        return QPointF(x, y)

    def _paint_border(self) -> None:
        """Draw where the crown of the head may be; it glows where the target is near it or beyond, as the nose does."""
        painter, style, target = self.painter, self.style, self.view.target
        # The crown is on the axis z of the head.
        crowns = [[row[2] * CROWN[2] for row in turned(head)] for head in furthest(self.view)]
        points = self.screen.place(np.array(crowns))[:, :2]
        draw_lines(painter, style.edge, 1.5, Qt.PenStyle.DashLine)
        painter.drawPolygon(_polygon(points))
        if self.strain > GLOW:
            at = round(math.atan2(target.pitch, target.roll) / math.tau * len(points))
            near = points[[(at + k) % len(points) for k in range(-6, 7)]]
            draw_lines(painter, style.bad if self.strain > 1 else style.warn, 6)
            painter.drawPolyline(_polygon(near))
        if abs(target.yaw) > GLOW * self.view.yaw_max:
            draw_lines(painter, style.warn, 6)
            painter.drawEllipse(self._at(NOSE), 12.0, 12.0)

    def _paint_outline(self) -> None:
        """Draw the outline of the head at the target."""
        (head,) = (mesh for mesh in meshes(_figure()) if mesh.body == "head")
        skull = head.points[head.points[:, 2] > 0.05] @ np.array(turned(self.view.target)).T
        draw_lines(self.painter, self.style.bad if self.strain > 1 else self.style.text, 2.5)
        self.painter.drawPolygon(_polygon(hull(self.screen.place(skull)[:, :2])))

    def _paint_handles(self, *, aims: bool) -> None:
        """Draw where to grab: the nose with a line ahead, and the ear under the mouse."""
        painter, style = self.painter, self.style
        if self.part in EARS:
            draw_lines(painter, style.accent, 3)
            painter.drawEllipse(self._at(EARS[self.part]), 16.0, 16.0)
        over = self.part is Part.FACE
        if aims or over:
            x, y, z = NOSE
            tip = self._at((x + AHEAD, y, z))
            draw_lines(painter, style.accent if over else style.text, 3 if over else 2)
            painter.drawLine(self._at(NOSE), tip)
            painter.drawEllipse(tip, 6.0, 6.0)

    def _paint_refused(self, refused: HeadOrientation) -> None:
        """Mark a refused target with a cross and the reason."""
        painter, style, reason = self.painter, self.style, self.view.drag.reason
        x, y, _ = on_screen(self.screen, refused, CROWN)
        wide = painter.fontMetrics().horizontalAdvance(f"✕ {reason}") + style.px(8)
        box = QRectF(x - style.px(8), y - style.px(9), wide, style.px(18))
        painter.fillRect(box, QColor(style.notice))
        painter.setPen(QColor(style.bad))
        painter.drawText(box, int(Qt.AlignmentFlag.AlignCenter), f"✕ {reason}")
