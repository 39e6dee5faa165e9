"""The pictures of the gestures: a small head that does what the gesture does, drawn in the colours of the theme."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Final

from PyQt5.QtCore import QPointF, QRectF, Qt
from PyQt5.QtGui import QColor, QPainter, QPainterPath, QPen, QPolygonF

UNIT: Final = 48.0
"""Side of the square in which the pictures are designed."""
LINE: Final = 2.4
TIP: Final = 4.0
"""Length of the point of an arrow."""
HEAD: Final = QRectF(11.0, 9.0, 26.0, 30.0)
FOLLOW: Final = "follow"
PROGRAM: Final = "program"


class Pen:
    """Draws the parts of a picture in design units."""

    def __init__(self, painter: QPainter, line: QColor, face: QColor, mark: QColor) -> None:
        self.painter = painter
        self._line, self._face, self._mark = line, face, mark

    def head(self, turned: float = 0.0) -> None:
        """Draw the outline of the head with its ears, tilted by `turned` (deg, clockwise), for the parts that follow."""
        self.painter.translate(UNIT / 2, UNIT / 2)
        self.painter.rotate(turned)
        self.painter.translate(-UNIT / 2, -UNIT / 2)
        self._outline()
        self.painter.setBrush(self._face)
        for x in (HEAD.left() - 3.0, HEAD.right() - 1.0):
            self.painter.drawRoundedRect(QRectF(x, 20.0, 4.0, 9.0), 2.0, 2.0)
        self.painter.drawRoundedRect(HEAD, 11.0, 12.0)

    def sheet(self) -> None:
        """Draw a sheet of paper with a folded corner."""
        self._outline()
        self.painter.setBrush(self._face)
        corners = [(10.0, 4.0), (30.0, 4.0), (38.0, 12.0), (38.0, 44.0), (10.0, 44.0)]
        self.painter.drawPolygon(QPolygonF([QPointF(*corner) for corner in corners]))
        self.line((30.0, 4.0), (30.0, 12.0), (38.0, 12.0))

    def eyes(self, radius: float = 2.1, *, by: tuple[float, float] = (0.0, 0.0)) -> None:
        """Draw round eyes, moved to the right and down by `by`."""
        self.painter.setPen(Qt.PenStyle.NoPen)
        self.painter.setBrush(self._line)
        for x in (18.5, 29.5):
            self.painter.drawEllipse(QPointF(x + by[0], 22.0 + by[1]), radius, radius)

    def rings(self) -> None:
        """Draw wide open eyes."""
        self._outline()
        for x in (18.5, 29.5):
            self.painter.drawEllipse(QPointF(x, 21.0), 3.6, 3.6)

    def arcs(self, place: QPointF, width: float, *, down: bool) -> None:
        """Draw an arc around a place: a mouth, or a closed eye."""
        self._outline()
        begin = 180 if down else 0
        self.painter.drawArc(
            QRectF(place.x() - width / 2, place.y() - width / 3, width, width / 1.5), begin * 16, 180 * 16
        )

    def line(self, *points: tuple[float, float]) -> None:
        """Draw a line of the face."""
        self._outline()
        self.painter.drawPolyline(QPolygonF([QPointF(*point) for point in points]))

    def arrow(self, start: tuple[float, float], end: tuple[float, float]) -> None:
        """Draw an arrow with a point at both ends, upright or level."""
        self._marks()
        self.painter.drawLine(QPointF(*start), QPointF(*end))
        upright = start[0] == end[0]
        for (x, y), way in ((start, 1.0), (end, -1.0)):
            sides = [
                (x - TIP * 0.8, y + way * TIP) if upright else (x + way * TIP, y - TIP * 0.8),
                (x, y),
                (x + TIP * 0.8, y + way * TIP) if upright else (x + way * TIP, y + TIP * 0.8),
            ]
            self.painter.drawPolyline(QPolygonF([QPointF(*point) for point in sides]))

    def mark(self, *points: tuple[float, float]) -> None:
        """Draw a line beside the head."""
        self._marks()
        self.painter.drawPolyline(QPolygonF([QPointF(*point) for point in points]))

    def note(self, x: float, y: float) -> None:
        """Draw a note of music whose head is at a place."""
        self.mark((x + 2.4, y), (x + 2.4, y - 9.0), (x + 6.0, y - 6.5))
        self.painter.setBrush(self._mark)
        self.painter.drawEllipse(QPointF(x, y), 2.2, 1.6)

    def question(self) -> None:
        """Draw a question mark above the right ear."""
        path = QPainterPath(QPointF(38.5, 7.0))
        path.cubicTo(38.5, 1.5, 46.0, 2.0, 45.5, 7.0)
        path.cubicTo(45.3, 9.5, 42.0, 9.5, 42.0, 13.0)
        self._marks()
        self.painter.drawPath(path)
        self.painter.drawPoint(QPointF(42.0, 17.5))

    def _outline(self) -> None:
        self._use(self._line)

    def _marks(self) -> None:
        self._use(self._mark)

    def _use(self, colour: QColor) -> None:
        self.painter.setBrush(Qt.BrushStyle.NoBrush)
        cap, join = Qt.PenCapStyle.RoundCap, Qt.PenJoinStyle.RoundJoin
        self.painter.setPen(QPen(colour, LINE, Qt.PenStyle.SolidLine, cap, join))


def _yes(pen: Pen) -> None:
    pen.head()
    pen.eyes(by=(0.0, 2.0))
    pen.arcs(QPointF(24.0, 31.0), 10.0, down=True)
    pen.arrow((44.0, 12.0), (44.0, 36.0))


def _no(pen: Pen) -> None:
    pen.head()
    pen.eyes()
    pen.line((19.5, 32.0), (28.5, 32.0))
    pen.arrow((12.0, 44.5), (36.0, 44.5))


def _hello(pen: Pen) -> None:
    pen.head(-14.0)
    pen.eyes(by=(0.0, -1.5))
    pen.arcs(QPointF(24.0, 29.5), 13.0, down=True)


def _surprised(pen: Pen) -> None:
    pen.head()
    pen.rings()
    pen.line((15.0, 14.0), (20.0, 12.5))
    pen.line((28.0, 12.5), (33.0, 14.0))
    pen.painter.drawEllipse(QPointF(24.0, 32.0), 2.6, 3.4)


def _sleepy(pen: Pen) -> None:
    pen.head(10.0)
    for x in (18.5, 29.5):
        pen.arcs(QPointF(x, 24.0), 7.0, down=True)
    pen.line((21.5, 33.0), (26.5, 33.0))


def _curious(pen: Pen) -> None:
    pen.head(-12.0)
    pen.eyes(2.6, by=(1.5, -1.0))
    pen.line((26.5, 15.5), (33.0, 14.5))
    pen.line((21.0, 32.5), (27.0, 31.5))


def _dance(pen: Pen) -> None:
    pen.head(12.0)
    for x in (18.5, 29.5):
        pen.arcs(QPointF(x, 23.5), 6.0, down=False)
    pen.arcs(QPointF(24.0, 29.0), 12.0, down=True)


def _follow(pen: Pen) -> None:
    pen.head()
    pen.eyes(by=(2.0, 0.0))
    pen.arcs(QPointF(24.0, 31.0), 10.0, down=True)
    for x, way_x in ((3.0, 1.0), (45.0, -1.0)):
        for y, way_y in ((3.0, 1.0), (45.0, -1.0)):
            pen.mark((x + 7.0 * way_x, y), (x, y), (x, y + 7.0 * way_y))


def _program(pen: Pen) -> None:
    pen.sheet()
    for y, left, right in ((16.0, 15.0, 27.0), (22.0, 19.0, 33.0), (28.0, 19.0, 30.0), (34.0, 15.0, 24.0)):
        pen.mark((left, y), (right, y))


def _beside_hello(pen: Pen) -> None:
    pen.mark((40.0, 4.0), (44.0, 8.5), (44.5, 14.0))
    pen.mark((3.5, 34.0), (4.0, 39.5), (8.0, 44.0))


def _beside_sleepy(pen: Pen) -> None:
    pen.mark((36.0, 4.0), (43.0, 4.0), (36.0, 11.0), (43.0, 11.0))
    pen.mark((3.5, 3.0), (8.0, 3.0), (3.5, 7.5), (8.0, 7.5))


def _beside_surprised(pen: Pen) -> None:
    pen.mark((24.0, 2.0), (24.0, 5.0))
    pen.mark((8.0, 6.5), (10.5, 9.0))
    pen.mark((40.0, 6.5), (37.5, 9.0))


def _beside_dance(pen: Pen) -> None:
    pen.note(4.5, 14.0)
    pen.note(39.5, 43.0)


PARTS: Final[Mapping[str, tuple[Callable[[Pen], None], Callable[[Pen], None] | None]]] = MappingProxyType(
    {
        "yes": (_yes, None),
        "no": (_no, None),
        "hello": (_hello, _beside_hello),
        "surprised": (_surprised, _beside_surprised),
        "sleepy": (_sleepy, _beside_sleepy),
        "curious": (_curious, Pen.question),
        "dance": (_dance, _beside_dance),
        FOLLOW: (_follow, None),
        PROGRAM: (_program, None),
    }
)
"""For each picture: the head, and what is beside it and does not tilt with it."""


def paint(painter: QPainter, name: str, box: QRectF, line: QColor, face: QColor, mark: QColor) -> None:
    """Draw the picture of a gesture, FOLLOW or PROGRAM into a square; `mark` is the colour of what is beside the head."""
    for part in PARTS[name]:
        if part is None:
            continue
        painter.save()
        painter.translate(box.topLeft())
        painter.scale(box.width() / UNIT, box.height() / UNIT)
        part(Pen(painter, line, face, mark))
        painter.restore()
