"""The head in three dimensions: the robots, the outline of the target, and dragging."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Final

from PyQt5.QtCore import QPoint, QPointF, Qt, QTimer
from PyQt5.QtGui import QColor, QCursor, QMouseEvent, QPainter, QPaintEvent, QWheelEvent
from PyQt5.QtWidgets import QLabel

from beatrix_zenoh.body.head_shape import AWAKE, Face
from beatrix_zenoh.body.scene import SKULL, Screen, Viewpoint
from gui.console.state.intents import Choose, GrabHead
from gui.console.state.views import HeadView
from gui.console.texts import Texts
from gui.window.widgets.controls import (
    ChoiceCheck,
    in_column,
    in_row,
    label,
    plain_button,
)
from gui.window.widgets.head import TargetWidget
from gui.window.widgets.head3d_drag import BEYOND, Drag, Part, grabbed, on_screen
from gui.window.widgets.head3d_paint import GHOST, Marks, apart, draw_lines, ghost, robot
from gui.window.widgets.head3d_room import Room

VIEWS: Final = {
    name: Viewpoint(azimuth, zoom=1.16, height=0.066)  # nearer than the whole robot: the head is the star
    for name, azimuth in (("front", 0.0), ("behind", 180.0), ("side", 90.0))
}
SIDEWAYS: Final = 1e-6
HALF_WIDTH: Final = 0.14
"""Half of the width (m) of a head that leans."""
ORBIT_DEG: Final = 0.5
"""Turn of the camera for a pixel."""
LOWEST_DEG: Final = -10.0
HIGHEST_DEG: Final = 80.0
LEAST_ZOOM: Final = 0.6
MOST_ZOOM: Final = 3.0
ZOOM_STEP: Final = 1.15
"""Factor for a notch of the wheel."""
STEP_MS: Final = 100
"""Time between two faces."""
CLOSED, HALF = Face(1.0), Face(0.5)
WAKING: Final = (HALF, HALF, CLOSED, HALF, *(AWAKE,) * 6, CLOSED, AWAKE)
"""The faces of a robot that wakes up: its last motions before it can move."""
ATTENTION: Final = 40
"""Steps after the last movement of the mouse in which a sleeping robot looks there."""
BLINK: Final = 25
"""Steps between two blinks meanwhile."""
FAR_PX: Final = 300.0
"""Distance of the mouse from the head at which the eyes look furthest."""
MOST_UP: Final = 0.5
GAZES: Final = 2
"""Number of gazes from straight ahead to either side: the mesh of each is kept."""


class Lids:
    """The lids and the gaze of a robot, which sleeps while its motors are off; call `step` every STEP_MS while it `moves`.

    The real head has no lids, and its eyes look straight ahead: so does the picture of every robot that can move.
    """

    def __init__(self) -> None:
        self.face = AWAKE
        self._asleep = False
        self._waking: list[Face] = []
        self._mouse: tuple[float, float] | None = None
        self._attention = 0

    @property
    def moves(self) -> bool:
        """Whether the face may change."""
        return self._asleep or bool(self._waking)

    @property
    def rests(self) -> bool:
        """Whether the face stays until the mouse moves."""
        return not self._waking and not self._attention

    def show(self, *, asleep: bool) -> None:
        """Close the eyes of a robot that sleeps, and wake it up when it does not any more."""
        if asleep is not self._asleep:
            self._asleep, self._mouse, self._attention = asleep, None, 0
            self._waking = [] if asleep else [*WAKING]
            self.face = CLOSED if asleep else self._waking.pop(0)

    def step(self, left: float, down: float) -> None:
        """Go on, with the mouse at a place (px) from the middle of the head, to the robot's left and down."""
        if self._waking:
            self.face = self._waking.pop(0)
        elif self._asleep:
            moved = self._mouse not in (None, (left, down))
            self._mouse = left, down
            self._attention = ATTENTION if moved else max(0, self._attention - 1)
            shut = not self._attention or self._attention % BLINK == 1
            self.face = CLOSED if shut else Face(0.5, _gaze(left, 1.0), _gaze(-down, MOST_UP))


def _gaze(distance: float, most: float) -> float:
    """Return one of a few gazes to a side, -1 to 1."""
    part = max(-most, min(most, distance / FAR_PX))
    return round(part * GAZES) / GAZES


class Head3d(TargetWidget):
    """Draws both robots from their positions, and reports new targets. Draws only when the picture changes."""

    def __init__(self, texts: Texts) -> None:
        super().__init__(texts("label.head3d"), texts("tip.head3d"))
        self._texts = texts
        self._names, self._nothing = QLabel(), label(wrap=True)
        self._nothing.setAlignment(Qt.AlignmentFlag.AlignCenter)
        self.views = {name: plain_button(texts(f"view.{name}"), texts("tip.view")) for name in VIEWS}
        for name, button in self.views.items():
            button.setCheckable(True)
            button.clicked.connect(lambda _, name=name: self._go(VIEWS[name]))
        self.live, self.send = ChoiceCheck(texts, "live"), ChoiceCheck(texts, "send_on_release")
        self.code = plain_button(texts("label.code"), texts("tip.drawer"))
        self.code.setCheckable(True)
        self.code.clicked.connect(lambda on: self.intent.emit(Choose("drawer", on)))
        self.room_box, self.room = ChoiceCheck(texts, "room"), Room(texts, self)
        self.reports(self.live.intent, self.send.intent, self.room_box.intent, self.room.intent)
        below = in_row(self.live, self.send, self.code, None, *self.views.values())
        self.top = in_row((in_row(self._names, self.room_box, None, gap=14), 1))
        in_column(self.top, (self._nothing, 1), below, margins=(9, 6, 9, 9), inside=self)
        self.camera = VIEWS["front"]
        self._drag: Drag | None = None
        self._orbit: QPointF | None = None
        self._over: Part | None = None
        self._covered = 0
        self._lids, self._blinks, self._mouse = Lids(), QTimer(self), QPoint()
        self._blinks.setInterval(STEP_MS)
        self._blinks.timeout.connect(self._blink)
        self.setMouseTracking(True)
        self.setMinimumSize(160, 130)
        self.look_from(self.camera)

    @property
    def screen3d(self) -> Screen:
        """The camera and the size of the picture (px)."""
        plain = Screen(self.camera, self.width(), self.height())
        half = min(HALF_WIDTH * plain.scale, (self.width() - self._covered) / 2)
        return replace(plain, aside=max(0.0, self._covered + half - self.width() / 2))

    def keep_clear(self, left: int) -> None:
        """Move the head aside if it is where a notice covers the picture, that far from its left edge (px)."""
        if left != self._covered and self._drag is None:  # not from under the mouse
            self._covered = left
            self.update()

    def look_from(self, camera: Viewpoint) -> None:
        """Show the head from elsewhere."""
        self.camera = camera
        for name, button in self.views.items():
            button.setChecked(math.isclose(camera.azimuth, VIEWS[name].azimuth))
        self.room.map.azimuth = camera.azimuth
        self.update()

    @property
    def _faces(self) -> bool:
        """Whether the camera is in front of the robot, or beside it."""
        return math.cos(math.radians(self.camera.azimuth)) > -SIDEWAYS

    def _go(self, camera: Viewpoint) -> None:
        """Look from elsewhere, as the user wants; the pad turns with the view."""
        before = self._faces
        self.look_from(camera)
        if self._faces is not before:
            self.intent.emit(Choose("facing", self._faces))

    @property
    def controls_height(self) -> int:
        """Height of the controls at the lower edge (px)."""
        controls = (self.live, self.code, *self.views.values())
        return self.height() - min(control.y() for control in controls if not control.isHidden())

    def show_simple(self, *, simple: bool) -> None:
        """Show the button of the code instead of the choices of a drag, which are made then."""
        for box in (self.live, self.send):
            box.setHidden(simple)
        self.code.setVisible(simple)

    def show_view(self, view: HeadView) -> None:
        """Draw the robots and the target; name the robots and a silent one, or say that none is online."""
        super().show_view(view)
        if view.facing is not self._faces:
            self.look_from(VIEWS["front" if view.facing else "behind"])
        self._lids.show(asleep=view.asleep and view.shown is not None)
        if self._lids.moves and not self._blinks.isActive() and self.isVisible():
            self._blinks.start()
        names = [
            (f"{symbol} {self._texts(f'side.{side}')}", self._style.side(side))
            for symbol, side in (("■", "hw"), ("+", "sim"))
            if view.side(side) is not None
        ]
        if view.silent and view.shown is not None:
            silent = f"◌ {self._texts(f'side.{view.solid}')}: {self._texts('condition.silent')}"
            names.append((silent, self._style.bad))
        texts = (f"<span style='color:{colour}'>{text}</span>" for text, colour in names)
        self._names.setText("<br>".join(texts))
        for button in self.views.values():
            button.setVisible(view.shown is not None)
        self._nothing.setText("" if view.shown is not None else self._texts("label.no_head"))

    def _blink(self) -> None:
        """Go on with the face of a robot that sleeps or wakes up; it looks at the mouse."""
        before, mouse, view = self._lids.face, QCursor.pos(), self._view
        if view is not None and (mouse != self._mouse or not self._lids.rests):
            x, y, _ = on_screen(self.screen3d, view.shown or view.target, SKULL)
            self._mouse, at = mouse, self.mapFromGlobal(mouse)
            self._lids.step((at.x() - x) * (1 if self._faces else -1), at.y() - y)
        if self._lids.face != before:
            self.update()
        if not (self._lids.moves and self.isVisible()):
            self._blinks.stop()

    # Mouse

    def mousePressEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        at, view = event.localPos(), self._view
        left = event.button() == Qt.MouseButton.LeftButton
        part = grabbed(self.screen3d, view, at.x(), at.y()) if left and view is not None else None
        if part is not None and view is not None:
            self._drag = Drag(self.screen3d, view.target, part, at.x(), at.y())
            self.setCursor(Qt.CursorShape.ClosedHandCursor)
            self.intent.emit(GrabHead())
            self.update()
        elif left or event.button() == Qt.MouseButton.RightButton:
            self._orbit = at

    def mouseMoveEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        at, view = event.localPos(), self._view
        if view is None:
            return
        if self._drag is not None:
            target = self._drag.at(at.x(), at.y(), view.tilt_max * BEYOND, view.yaw_max)
            self._report(target)
            self._follow()
        elif self._orbit is not None:
            way, self._orbit = at - self._orbit, at
            camera = self.camera
            azimuth = (camera.azimuth - way.x() * ORBIT_DEG) % 360.0
            elevation = max(LOWEST_DEG, min(HIGHEST_DEG, camera.elevation + way.y() * ORBIT_DEG))
            self._go(replace(camera, azimuth=azimuth, elevation=elevation))
        else:
            self._hover(grabbed(self.screen3d, view, at.x(), at.y()))

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        self._orbit = None
        if event.button() == Qt.MouseButton.LeftButton:
            self._release()

    def _release(self) -> None:
        if self._drag is None:
            return
        self._drag = None
        self.setCursor(Qt.CursorShape.OpenHandCursor)
        self._let_go()
        self.update()

    def wheelEvent(self, event: QWheelEvent) -> None:  # noqa: N802
        zoom = self.camera.zoom * ZOOM_STEP ** (event.angleDelta().y() / 120)
        self.look_from(replace(self.camera, zoom=max(LEAST_ZOOM, min(MOST_ZOOM, zoom))))
        event.accept()

    def _hover(self, part: Part | None) -> None:
        if part is not self._over:
            self._over = part
            self.setCursor(Qt.CursorShape.OpenHandCursor if part else Qt.CursorShape.ArrowCursor)
            self.update()

    def showEvent(self, event: object) -> None:  # noqa: N802, ARG002
        if self._lids.moves:
            self._blinks.start()

    def hideEvent(self, event: object) -> None:  # noqa: N802, ARG002
        self._release()

    def leaveEvent(self, event: object) -> None:  # noqa: N802, ARG002
        self._hover(None)

    # Drawing

    def paintEvent(self, _event: QPaintEvent) -> None:  # noqa: N802
        painter, view = QPainter(self), self._view
        try:
            painter.fillRect(self.rect(), QColor(self._style.field))
            if view is None:
                return
            self._paint_robots(painter, view)
            painter.setRenderHint(QPainter.RenderHint.Antialiasing)
            part = self._over if self._drag is None else self._drag.part
            if view.shown is not None:
                marks = Marks(painter, view, self.screen3d, self._style, part)
                marks.paint(dragged=self._drag is not None)
            if self.hasFocus():
                draw_lines(painter, self._style.accent, 2)
                painter.drawRect(self.rect().adjusted(1, 1, -1, -1))
        finally:
            painter.end()  # Qt aborts if a painter stays active after an error

    def _paint_robots(self, painter: QPainter, view: HeadView) -> None:
        """Draw one robot solid, and the other one, if it is elsewhere, as a translucent ghost."""
        screen, ratio, style = self.screen3d, self.devicePixelRatioF(), self._style
        other = "hw" if view.solid == "sim" else "sim"
        beside = view.side(other)
        if view.shown is not None:
            solid = robot(view.shown, screen, ratio, style, silent=view.silent, face=self._lids.face)
            painter.drawImage(QPoint(0, 0), solid)
        if beside is not None and apart(beside, view.shown):
            painter.setOpacity(GHOST)
            painter.drawImage(QPoint(0, 0), ghost(beside, screen, ratio, style.side(other)))
            painter.setOpacity(1.0)
