"""The room in the pictures of the eyes: four walls with signs, a desk, and objects at known places on it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import mujoco
import numpy as np

from sim_node.lettering import cells, plate
from sim_node.shapes import Shape, Vector
from sim_node.visuals import FLOOR, VisualGeoms

WORLD: Final = "world"
ROOM: Final = ((-2.2, 2.6), (-2.3, 2.3), (FLOOR - 0.74, FLOOR + 1.71))
"""Smallest and largest x, y, z (m)."""
DESK: Final = ((-0.38, 1.0), (-0.78, 0.78))
"""Smallest and largest x, y (m) of the desk on which the robot stands."""
SIGNS: Final = tuple(range(-150, 181, 30))
"""Directions (deg of yaw) of the signs on the walls; each sign shows its direction."""
SIGN_HEIGHT: Final = 0.72
"""Height of the middle of the signs (m)."""
_CELL: Final = 0.024
"""Side length (m) of the square cells that letters consist of."""

COLOURS: Final[dict[str, tuple[float, float, float]]] = {
    "red": (0.86, 0.13, 0.11),
    "yellow": (0.98, 0.80, 0.08),
    "green": (0.10, 0.62, 0.22),
    "blue": (0.08, 0.30, 0.84),
    "orange": (0.96, 0.48, 0.08),
    "purple": (0.46, 0.20, 0.66),
    "clay": (0.73, 0.38, 0.26),
    "dark green": (0.20, 0.50, 0.24),
    "wood": (0.80, 0.64, 0.46),
    "shadow": (0.56, 0.44, 0.31),
    "dark_wood": (0.47, 0.33, 0.22),
    "ground": (0.60, 0.55, 0.50),
    "ceiling": (0.93, 0.93, 0.92),
    "front": (0.90, 0.88, 0.82),
    "left": (0.64, 0.77, 0.88),
    "right": (0.94, 0.80, 0.64),
    "back": (0.70, 0.83, 0.68),
    "paper": (0.97, 0.97, 0.96),
    "ink": (0.12, 0.14, 0.18),
    "steel": (0.62, 0.65, 0.68),
    "sky": (0.62, 0.82, 0.97),
    "board": (0.13, 0.30, 0.25),
}

_LAMPS: Final = (
    ((0.62, 0.30, -0.72), 0.50),
    ((-0.60, 0.25, -0.76), 0.26),
    ((0.0, -0.90, -0.44), 0.36),
    ((-0.35, 0.10, 0.93), 0.34),
)
"""Directions and brightness (0 to 1) of the lights: from behind the robot, from the window, from the door, upwards."""

_SPHERE: Final = mujoco.mjtGeom.mjGEOM_SPHERE
_ELLIPSOID: Final = mujoco.mjtGeom.mjGEOM_ELLIPSOID
_CYLINDER: Final = mujoco.mjtGeom.mjGEOM_CYLINDER
_BOX: Final = mujoco.mjtGeom.mjGEOM_BOX


@dataclass(frozen=True)
class DeskObject:
    """An object on the desk, its colour, and the place of its middle (m)."""

    name: str
    colour: str
    place: tuple[float, float, float]


OBJECTS: Final = (
    DeskObject("cube", "red", (0.78, 0.35, FLOOR + 0.050)),
    DeskObject("cylinder", "green", (0.84, 0.18, FLOOR + 0.060)),
    DeskObject("ball", "blue", (0.84, -0.18, FLOOR + 0.055)),
    DeskObject("pyramid", "yellow", (0.78, -0.35, FLOOR + 0.060)),
    DeskObject("books", "purple", (0.44, 0.60, FLOOR + 0.075)),
    DeskObject("plant", "dark green", (0.42, -0.60, FLOOR + 0.170)),
)


def add_room(spec: mujoco.MjSpec) -> None:
    """Replace the floor of a model of the robot with the room."""
    spec.delete(spec.geom("floor"))
    _light(spec)
    visuals = VisualGeoms(spec, COLOURS)
    _shell(visuals)
    _signs(visuals)
    _front(visuals)
    _sides(visuals)
    _back(visuals)
    _desk(visuals)
    for thing in OBJECTS:
        x, y, _ = thing.place
        visuals.primitive(
            WORLD, "shadow", _CYLINDER, (_SHADOW_RADII[thing.name], 0.001), (x + 0.012, y + 0.008, FLOOR)
        )
        _ADD[thing.name](visuals, thing)


def _light(spec: mujoco.MjSpec) -> None:
    """Replace the lights by some without shadows that shine through walls, so that each wall has its own brightness."""
    for light in list(spec.lights):
        spec.delete(light)
    for direction, brightness in _LAMPS:
        lamp = spec.worldbody.add_light(type=mujoco.mjtLightType.mjLIGHT_DIRECTIONAL, dir=direction)
        lamp.diffuse, lamp.specular, lamp.castshadow = [brightness] * 3, [0.15] * 3, False
    spec.visual.headlight.ambient = [0.40, 0.40, 0.41]
    spec.visual.headlight.diffuse = [0.12, 0.12, 0.12]


def _shell(visuals: VisualGeoms) -> None:
    """Add floor, ceiling, four walls and skirting boards."""
    (x0, x1), (y0, y1), (z0, z1) = ROOM
    x, y, z = (x0 + x1) / 2, (y0 + y1) / 2, (z0 + z1) / 2
    half_x, half_y, half_z, thick = (x1 - x0) / 2, (y1 - y0) / 2, (z1 - z0) / 2, 0.02
    visuals.primitive(WORLD, "ground", _BOX, (half_x, half_y, thick), (x, y, z0 - thick))
    visuals.primitive(WORLD, "ceiling", _BOX, (half_x, half_y, thick), (x, y, z1 + thick))
    for name, at in (("front", x1 + thick), ("back", x0 - thick)):
        visuals.primitive(WORLD, name, _BOX, (thick, half_y, half_z), (at, y, z))
    for name, at in (("left", y1 + thick), ("right", y0 - thick)):
        visuals.primitive(WORLD, name, _BOX, (half_x, thick, half_z), (x, at, z))
    for at in (x0, x1):
        visuals.primitive(WORLD, "paper", _BOX, (0.012, half_y, 0.05), (at, y, z0 + 0.05))
    for at in (y0, y1):
        visuals.primitive(WORLD, "paper", _BOX, (half_x, 0.012, 0.05), (x, at, z0 + 0.05))


def _signs(visuals: VisualGeoms) -> None:
    """Add a sign for each direction, on the wall that a ray from the neck axis in this direction hits."""
    for yaw in SIGNS:
        place, inward = wall_at(yaw)
        letters = cells(str(yaw))
        sign = _turned(plate(letters, _CELL, 0.012), inward)
        visuals.mesh(WORLD, "ink", f"sign_{yaw}", sign, place + 0.010 * inward)
        across = np.abs(np.array((-inward[1], inward[0], 0.0)))
        half = across * (letters.shape[1] / 2 + 2) * _CELL + np.abs(inward) * 0.006
        half[2] = 6 * _CELL
        visuals.primitive(WORLD, "paper", _BOX, half.tolist(), place)
        # A vertical line below the sign shows the exact direction, also to a head that is pitched down.
        line = np.abs(inward) * 0.006 + across * 0.006
        line[2] = 0.25
        visuals.primitive(WORLD, "ink", _BOX, line.tolist(), place - np.array((0.0, 0.0, 6 * _CELL + 0.25)))


def wall_at(yaw: float) -> tuple[Vector, Vector]:
    """Return the point where a ray from the neck axis (deg of yaw) hits a wall, and the wall's normal into the room."""
    (x0, x1), (y0, y1), _ = ROOM
    ahead = np.array((math.cos(math.radians(yaw)), math.sin(math.radians(yaw))))
    hits = [
        (limit / part, axis)
        for axis, (part, limits) in enumerate(zip(ahead, ((x0, x1), (y0, y1)), strict=True))
        for limit in limits
        if limit * part > 1e-9
    ]
    distance, axis = min(hits)
    inward = np.zeros(3)
    inward[axis] = -math.copysign(1.0, ahead[axis])
    return np.array((*(ahead * distance), SIGN_HEIGHT)), inward


def _turned(shape: Shape, inward: Vector) -> Shape:
    """Turn a plate that is legible from -x so that it is legible from `inward`."""
    x, y = -inward[:2]
    turn = np.array(((x, -y, 0.0), (y, x, 0.0), (0.0, 0.0, 1.0)))
    return Shape(shape.vertices @ turn.T, shape.faces)


def _front(visuals: VisualGeoms) -> None:
    """Add a window on the left and a picture on the right."""
    x = ROOM[0][1]
    visuals.primitive(WORLD, "paper", _BOX, (0.020, 0.46, 0.42), (x, 1.25, -0.08))
    for y in (1.25 - 0.22, 1.25 + 0.22):
        for z in (-0.08 - 0.20, -0.08 + 0.20):
            visuals.primitive(WORLD, "sky", _BOX, (0.026, 0.20, 0.18), (x, y, z))
    visuals.primitive(WORLD, "dark_wood", _BOX, (0.020, 0.44, 0.34), (x, -1.25, -0.08))
    visuals.primitive(WORLD, "paper", _BOX, (0.024, 0.40, 0.30), (x, -1.25, -0.08))
    visuals.primitive(WORLD, "orange", _CYLINDER, (0.13, 0.028), (x, -1.10, 0.02), (1, 0, 0))
    visuals.primitive(WORLD, "clay", _BOX, (0.028, 0.38, 0.06), (x, -1.25, -0.30))
    visuals.primitive(WORLD, "board", _BOX, (0.027, 0.12, 0.10), (x, -1.47, -0.16))


def _sides(visuals: VisualGeoms) -> None:
    """Add a door and a clock on the left, and shelves with books on the right."""
    left, right, ground = ROOM[1][1], ROOM[1][0], ROOM[2][0]
    visuals.primitive(WORLD, "dark_wood", _BOX, (0.44, 0.020, 0.96), (0.15, left, ground + 0.96))
    visuals.primitive(WORLD, "wood", _BOX, (0.38, 0.026, 0.90), (0.15, left, ground + 0.92))
    visuals.primitive(WORLD, "steel", _SPHERE, (0.035,), (0.44, left - 0.05, ground + 0.92))
    visuals.primitive(WORLD, "red", _CYLINDER, (0.17, 0.02), (1.85, left, 0.10), (0, 1, 0))
    visuals.primitive(WORLD, "paper", _CYLINDER, (0.145, 0.026), (1.85, left, 0.10), (0, 1, 0))
    visuals.bar(WORLD, "ink", 0.009, (1.85, left - 0.03, 0.10), (1.85, left - 0.03, 0.21))
    visuals.bar(WORLD, "ink", 0.011, (1.85, left - 0.03, 0.10), (1.92, left - 0.03, 0.06))
    books = ("red", "blue", "yellow", "green", "orange", "purple", "steel")
    for level, height in enumerate((-0.62, -0.26, 0.10)):
        visuals.primitive(WORLD, "dark_wood", _BOX, (0.60, 0.13, 0.014), (0.75, right + 0.13, height))
        for book in range(9):
            colour = books[(3 * level + 2 * book) % len(books)]
            tall = 0.10 + 0.02 * ((book * 5 + level * 3) % 4)
            at = (0.24 + 0.085 * book + 0.09 * level, right + 0.12, height + 0.014 + tall)
            visuals.primitive(WORLD, colour, _BOX, (0.032, 0.09, tall), at)


def _back(visuals: VisualGeoms) -> None:
    """Add a blackboard with two drawings, a square and a triangle."""
    x = ROOM[0][0]
    visuals.primitive(WORLD, "wood", _BOX, (0.020, 0.86, 0.48), (x, 0.0, -0.10))
    visuals.primitive(WORLD, "board", _BOX, (0.026, 0.82, 0.44), (x, 0.0, -0.10))
    chalk = x + 0.03
    square = [(chalk, 0.36 + a, -0.10 + b) for a, b in ((0.2, 0.2), (-0.2, 0.2), (-0.2, -0.2), (0.2, -0.2))]
    triangle = [(chalk, -0.36 + a, -0.10 + b) for a, b in ((0.0, 0.22), (-0.24, -0.2), (0.24, -0.2))]
    for corners in (square, triangle):
        visuals.bar(WORLD, "paper", 0.010, *corners, corners[0])


def _desk(visuals: VisualGeoms) -> None:
    (x0, x1), (y0, y1) = DESK
    ground, thick = ROOM[2][0], 0.016
    half = ((x1 - x0) / 2, (y1 - y0) / 2)
    middle = ((x0 + x1) / 2, (y0 + y1) / 2)
    visuals.primitive(WORLD, "wood", _BOX, (*half, thick), (*middle, FLOOR - thick))
    height = (FLOOR - 2 * thick - ground) / 2
    for x in (x0 + 0.05, x1 - 0.05):
        for y in (y0 + 0.05, y1 - 0.05):
            visuals.primitive(WORLD, "steel", _BOX, (0.025, 0.025, height), (x, y, ground + height))


def _cube(visuals: VisualGeoms, thing: DeskObject) -> None:
    visuals.primitive(WORLD, thing.colour, _BOX, (0.050, 0.050, 0.050), thing.place)


def _cylinder(visuals: VisualGeoms, thing: DeskObject) -> None:
    visuals.primitive(WORLD, thing.colour, _CYLINDER, (0.045, 0.060), thing.place)


def _ball(visuals: VisualGeoms, thing: DeskObject) -> None:
    visuals.primitive(WORLD, thing.colour, _SPHERE, (0.055,), thing.place)


def _pyramid(visuals: VisualGeoms, thing: DeskObject) -> None:
    base = [(x, y, -0.060) for x, y in ((1, 1), (-1, 1), (-1, -1), (1, -1))]
    vertices = np.array([(0.058 * x, 0.058 * y, z) for x, y, z in base] + [(0.0, 0.0, 0.060)])
    faces = [(0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4), (0, 2, 1), (0, 3, 2)]
    shape = Shape(vertices, np.array(faces, dtype=np.int32))
    visuals.mesh(WORLD, thing.colour, "pyramid", shape, thing.place)


def _books(visuals: VisualGeoms, thing: DeskObject) -> None:
    """Add a pile of three books."""
    x, y, z = thing.place
    for row, (colour, half_x, half_y) in enumerate(
        ((thing.colour, 0.080, 0.11), ("orange", 0.070, 0.10), ("paper", 0.075, 0.085))
    ):
        visuals.primitive(WORLD, colour, _BOX, (half_x, half_y, 0.025), (x, y, z - 0.05 + 0.05 * row))


def _plant(visuals: VisualGeoms, thing: DeskObject) -> None:
    """Add a pot with leaves."""
    x, y, z = thing.place
    visuals.primitive(WORLD, "clay", _CYLINDER, (0.055, 0.055), (x, y, FLOOR + 0.055))
    visuals.primitive(WORLD, "clay", _CYLINDER, (0.062, 0.012), (x, y, FLOOR + 0.10))
    for leaf in range(6):
        turn = math.tau * leaf / 6
        out = np.array((math.cos(turn), math.sin(turn), 1.3))
        visuals.primitive(
            *(WORLD, thing.colour, _ELLIPSOID, (0.028, 0.010, 0.085)),
            *(np.array((x, y, z + 0.01)) + 0.045 * np.array((out[0], out[1], 0.6)), out),
        )
    visuals.primitive(WORLD, thing.colour, _ELLIPSOID, (0.026, 0.026, 0.10), (x, y, z + 0.03))


_SHADOW_RADII: Final = {
    "cube": 0.075,
    "cylinder": 0.056,
    "ball": 0.044,
    "pyramid": 0.080,
    "books": 0.125,
    "plant": 0.075,
}
"""Radius (m) of the shadow under an object; without it the object seems to float."""
_ADD: Final = {
    "cube": _cube,
    "cylinder": _cylinder,
    "ball": _ball,
    "pyramid": _pyramid,
    "books": _books,
    "plant": _plant,
}
