"""Dragging the head in the 3-D view: which part the mouse grabs, and where it turns the head. No Qt."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import StrEnum
from typing import Final

import numpy as np

from beatrix_zenoh.body.scene import EARS, NOSE, SKULL, Screen
from beatrix_zenoh.body.surface import Floats
from beatrix_zenoh.contract._generated.robot import SIZES
from beatrix_zenoh.motion.rotation import Rotation, rotation_of
from gui.console.state.intents import HeadOrientation
from gui.console.state.views import HeadView

EAR_PX: Final = 24.0
"""Distance from an ear within which the mouse grabs it."""
FACING_DEG: Final = 110.0
"""Angle between the nose and the viewer up to which the mouse moves the near side of the head, else the far side."""
HEAD_RADIUS: Final = 0.1
"""Distance (m) that the mouse moves for 1 rad of yaw or pitch."""
EAR_LEVER: Final = 0.08
"""The same for roll."""
BEYOND: Final = 1.2
"""Largest lean of a target, divided by the limit: the user may aim beyond the limit, and the refusal explains it."""
FLOOR: Final = SIZES.floor


class Part(StrEnum):
    """What the mouse grabs."""

    FACE = "face"
    """turns and nods"""
    LEFT_EAR = "left"
    """tilts"""
    RIGHT_EAR = "right"


def turned(head: HeadOrientation) -> Rotation:
    """Return the rows of the rotation of a head."""
    return rotation_of(*(math.radians(angle) for angle in (head.yaw, head.pitch, head.roll)))


def furthest(view: HeadView) -> list[HeadOrientation]:
    """Return the furthest leans of the target, in all directions."""
    leans = view.drag.border
    turns = [math.tau * k / len(leans) for k in range(len(leans))]
    return [
        HeadOrientation(view.target.yaw, lean * math.sin(turn), lean * math.cos(turn))
        for lean, turn in zip(leans, turns, strict=True)
    ]


def on_screen(screen: Screen, head: HeadOrientation, point: tuple[float, float, float]) -> Floats:
    """Return x, y (px) and nearness (m) of a point of the head."""
    place: Floats = screen.place(np.array([point]) @ np.array(turned(head)).T)[0]
    return place


def picked(screen: Screen, head: HeadOrientation, x: float, y: float) -> Part | None:
    """Return the part of a head at a point of the picture (px); None: the ground."""
    middle = on_screen(screen, head, SKULL)
    for part in (Part.LEFT_EAR, Part.RIGHT_EAR):
        ear = on_screen(screen, head, EARS[part])
        near = ear[2] > middle[2] - 0.06  # not an ear that the head hides
        if near and math.hypot(x - ear[0], y - ear[1]) < EAR_PX:
            return part
    nose = on_screen(screen, head, NOSE)
    radius = screen.scale * HEAD_RADIUS
    if math.hypot(x - middle[0], y - middle[1]) < radius or math.hypot(x - nose[0], y - nose[1]) < EAR_PX:
        return Part.FACE
    return None


def grabbed(screen: Screen, view: HeadView, x: float, y: float) -> Part | None:
    """Return the part at a point of the picture (px): of the target or, if it is elsewhere, of a robot's head."""
    parts = (picked(screen, head, x, y) for head in (view.target, view.hw, view.sim) if head is not None)
    return next((part for part in parts if part is not None), None)


@dataclass(frozen=True)
class Drag:
    """A drag of the head, from its begin."""

    screen: Screen
    start: HeadOrientation
    """the target at the begin"""
    part: Part
    x: float
    y: float
    """where the mouse was (px)"""

    def at(self, x: float, y: float, lean_max: float, yaw_max: float) -> HeadOrientation:
        """Return the target with the mouse at a point of the picture (px).

        lean_max: largest length of (pitch, roll); yaw_max: largest yaw in both directions (deg).
        """
        lever = HEAD_RADIUS if self.part is Part.FACE else EAR_LEVER
        degrees = math.degrees(1 / (lever * self.screen.scale))
        right, up = (x - self.x) * degrees, (self.y - y) * degrees
        start = self.start
        if self.part is Part.FACE:
            yaw = start.yaw + (right if faces(self.screen, start) else -right)
            pitch, roll = start.pitch - up, start.roll
        else:
            yaw, pitch = start.yaw, start.pitch
            roll = start.roll + (up if self.part is Part.LEFT_EAR else -up)
        shrink = min(1.0, lean_max / max(math.hypot(pitch, roll), 1e-9))
        yaw = max(-yaw_max, min(yaw_max, yaw))
        return HeadOrientation(*HeadOrientation(yaw, pitch * shrink, roll * shrink).tenths)


def faces(screen: Screen, head: HeadOrientation) -> bool:
    """Return whether the near side of the head follows the mouse: the nose points to the viewer or to a side."""
    return math.cos(math.radians(head.yaw - screen.camera.azimuth)) > math.cos(math.radians(FACING_DEG))
