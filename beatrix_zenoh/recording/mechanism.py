"""The mechanism inside the robot, as solids on the bodies of its figure: motors, arms, rods and the nine joint axes.

Viewers hide it until the user switches it on. Each arm's motor, ring, link and axes have the arm's colour.
"""

from __future__ import annotations

import math
from typing import Final

from beatrix_zenoh.colours import ARMS, Colour
from beatrix_zenoh.contract._generated.robot import COLOURS, SIZES
from beatrix_zenoh.motion.rotation import Vector
from beatrix_zenoh.recording.figure import (
    ROD_PARTS,
    UP,
    Body,
    Figure,
    Solid,
    arc,
    bar,
    cylinder,
    direction,
    ellipsoid,
    scaled,
)

# Lengths in m.
AXIS_RADIUS: Final = 0.0016
AXIS_LENGTH: Final = 0.105
"""Length of the elbows' and mounts' axes, from the neck centre on."""
HEAD_AXIS: Final = 0.24
LINK_RADIUS: Final = 0.0042
CENTRE: Final[Vector] = (0.0, 0.0, 0.0)


def mechanism(figure: Figure) -> tuple[Body, ...]:
    """Return the bodies of the mechanism; their paths are those of the figure's bodies."""
    base = bar([(0.0, 0.0, SIZES.floor), CENTRE], AXIS_RADIUS * 1.5, COLOURS.black)
    head = [
        ellipsoid(CENTRE, (0.007, 0.007, 0.007), COLOURS.black),
        *bar([CENTRE, (0.0, 0.0, HEAD_AXIS)], AXIS_RADIUS, COLOURS.black),
    ]
    bodies = []
    for index, (name, colour) in enumerate(ARMS.items()):
        azimuth, elbow, mount = figure.chains[index]
        reach, radius = figure.size.arm_length, figure.size.mount_radius
        height = SIZES.ring_heights[index]
        motor = direction(azimuth + math.pi / 3, 0.030, -0.152)
        pinion = direction(azimuth + math.pi / 3, 0.030, height)
        base += [cylinder(motor, UP, 0.019, 0.034, colour), *bar([motor, pinion], 0.003, colour)]
        base.append(cylinder(pinion, UP, 0.0155, 0.006, colour))
        ring, post = (0.0, 0.0, height), direction(azimuth, SIZES.post_radius, height)
        arm = [
            cylinder(ring, UP, SIZES.ring_radius, 0.003, colour),
            *bar([ring, post, scaled(elbow, reach)], LINK_RADIUS, colour),
            *joint(elbow, reach, colour),
        ]
        points = [scaled(point, reach) for point in arc(elbow, mount, ROD_PARTS)]
        rod = bar(points, LINK_RADIUS, COLOURS.rod) + joint(mount, radius, colour)
        head += bar([scaled(mount, radius), (0.0, 0.0, radius)], LINK_RADIUS, COLOURS.black)
        bodies += [Body(f"arm_{name}", tuple(arm)), Body(f"arm_{name}/rod_{name}", tuple(rod))]
    return Body("base", tuple(base)), *bodies, Body("head", tuple(head))


def joint(axis: Vector, distance: float, colour: Colour) -> list[Solid]:
    """Return a hinge at this distance (m) from the neck centre on its axis, and the axis from the centre on."""
    return [
        cylinder(scaled(axis, distance), axis, 0.0095, 0.013, colour),
        *bar([CENTRE, scaled(axis, AXIS_LENGTH)], AXIS_RADIUS, colour),
    ]
