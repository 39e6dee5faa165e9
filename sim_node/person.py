"""The person in the scene: head and upper body, which programs can find by colour or with a face detector."""

from __future__ import annotations

from typing import Final

import mujoco
import numpy as np

from sim_node.shapes import superellipsoid
from sim_node.visuals import VisualGeoms

Place = tuple[float, float, float]
"""x forward, y left, z up (m), from the neck centre."""
TARGET: Final = "target"
"""The person's body; its origin is the middle between the eyes, and its face points along x."""
HOME: Final[Place] = (1.15, 0.0, 0.16)
"""The middle between the eyes (m) at the start: behind the desk, in front of the robot."""
COLOURS: Final[dict[str, tuple[float, float, float]]] = {
    "magenta": (0.88, 0.06, 0.52),
    "skin": (0.93, 0.74, 0.62),
    "lips": (0.66, 0.24, 0.24),
    "hair": (0.17, 0.11, 0.08),
    "eyeball": (0.96, 0.96, 0.95),
    "pupil": (0.08, 0.06, 0.06),
    "shirt": (0.14, 0.47, 0.50),
}

_FINE: Final = (28, 18)
"""Points of a ring, and rings of a mesh: enough for a round shape, and fast to draw."""
_SPHERE: Final = mujoco.mjtGeom.mjGEOM_SPHERE
_ELLIPSOID: Final = mujoco.mjtGeom.mjGEOM_ELLIPSOID
_CYLINDER: Final = mujoco.mjtGeom.mjGEOM_CYLINDER


def add_person(spec: mujoco.MjSpec, place: Place = HOME) -> None:
    """Add the person as a mocap body; the middle between the eyes is at `place`."""
    # Half a turn about z: the person faces the robot.
    spec.worldbody.add_body(name=TARGET, mocap=True, pos=place, quat=[0.0, 0.0, 0.0, 1.0])
    visuals = VisualGeoms(spec, COLOURS)
    _head(visuals)
    _face(visuals)
    _upper_body(visuals)


def _head(visuals: VisualGeoms) -> None:
    head = superellipsoid((0.084, 0.072, 0.112), 0.9, *_FINE)
    visuals.mesh(TARGET, "skin", "person_head", head, (-0.080, 0.0, -0.022))
    hair = superellipsoid((0.084, 0.078, 0.095), 0.9, *_FINE)
    visuals.mesh(TARGET, "hair", "person_hair", hair, (-0.102, 0.0, 0.004))
    cap = superellipsoid((0.093, 0.083, 0.058), 0.8, *_FINE)
    visuals.mesh(TARGET, "magenta", "person_cap", cap, (-0.082, 0.0, 0.076))
    visuals.primitive(TARGET, "magenta", _SPHERE, (0.017,), (-0.082, 0.0, 0.140))
    for side in (1, -1):
        visuals.primitive(TARGET, "skin", _ELLIPSOID, (0.014, 0.011, 0.023), (-0.080, side * 0.075, -0.022))


def _face(visuals: VisualGeoms) -> None:
    for side in (1, -1):
        y = side * 0.029
        visuals.primitive(TARGET, "eyeball", _ELLIPSOID, (0.010, 0.0150, 0.0105), (-0.004, y, -0.002))
        visuals.primitive(TARGET, "pupil", _SPHERE, (0.0085,), (0.0005, y, -0.002))
        visuals.bar(TARGET, "hair", 0.0042, *_arc(0.002, y, 0.021, 0.018, -14.0, 5))
    visuals.primitive(
        TARGET, "skin", _ELLIPSOID, (0.016, 0.011, 0.022), (0.006, 0.0, -0.034), (0.35, 0.0, 1.0)
    )
    visuals.bar(TARGET, "lips", 0.0055, *_arc(-0.003, 0.0, -0.080, 0.025, 11.0, 5))


def _arc(
    x: float, y: float, z: float, half: float, bend: float, points: int
) -> list[tuple[float, float, float]]:
    """Return points of an arc (m) on the face around (x, y, z); it follows the curved face, and bends up or down."""
    return [(x - 9.0 * t * t, y + t, z + bend * t * t) for t in np.linspace(-half, half, points).tolist()]


def _upper_body(visuals: VisualGeoms) -> None:
    visuals.primitive(TARGET, "skin", _CYLINDER, (0.040, 0.060), (-0.090, 0.0, -0.140))
    visuals.primitive(TARGET, "magenta", _CYLINDER, (0.052, 0.014), (-0.090, 0.0, -0.172))
    shoulders = superellipsoid((0.085, 0.190, 0.100), 0.75, *_FINE)
    visuals.mesh(TARGET, "shirt", "person_shoulders", shoulders, (-0.095, 0.0, -0.272))
    chest = superellipsoid((0.084, 0.140, 0.30), 0.5, *_FINE)
    visuals.mesh(TARGET, "shirt", "person_chest", chest, (-0.095, 0.0, -0.48))
    for side in (1, -1):
        visuals.bar(TARGET, "shirt", 0.045, (-0.095, side * 0.150, -0.26), (-0.085, side * 0.178, -0.55))
