"""Draw the wiring and the parts of the robot from schemas/robot.toml: `python tools/robot_drawings.py`.

Writes docs/images/wiring.svg and assembly.svg; a test checks that they are up to date. The pictures are SVG, so that they
are sharp on paper, and their texts can be searched.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Final

from beatrix_zenoh.body.figure import MOTOR, PLATE, chains, direction, motor_at, scaled
from beatrix_zenoh.colours import ARMS, hexadecimal
from beatrix_zenoh.contract._generated.robot import COLOURS, ROBOT, SIZES
from beatrix_zenoh.motion.rotation import Vector

IMAGES: Final = Path(__file__).resolve().parent.parent / "docs/images"
SIZE: Final = """<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {0} {1}" width="{0}" height="{1}" \
font-family="sans-serif" font-size="15" fill="#222" stroke-linecap="round" stroke-linejoin="round">
<title>{2}</title>
<rect width="{0}" height="{1}" fill="#fff"/>
"""
JUMPERS: Final = {1: "", 2: "MS1", 4: "MS2", 8: "MS1 MS2", 16: "MS1 MS2 MS3"}
"""Jumpers of an A4988 by microsteps for a full step (table of its data sheet)."""
DRIVERS: Final = "XYZ"
BOLD: Final = 'font-weight="bold"'
RED, BLACK, GREY = "#c62828", "#222", "#777"


def text(x: float, y: float, words: str, style: str = "") -> str:
    """Return a line of text that begins at a place (px)."""
    return f'<text x="{x:.0f}" y="{y:.0f}" {style}>{words}</text>\n'


def box(x: float, y: float, size: tuple[float, float], fill: str, style: str = 'stroke="#444"') -> str:
    """Return a rectangle with round corners (px)."""
    return f'<rect x="{x:.0f}" y="{y:.0f}" width="{size[0]:.0f}" height="{size[1]:.0f}" rx="6" fill="{fill}" {style}/>\n'


def line(points: Sequence[tuple[float, float]], colour: str, width: float = 3, style: str = "") -> str:
    """Return a line through these points (px)."""
    path = "L".join(f"{x:.1f} {y:.1f}" for x, y in points)
    return f'<path d="M{path}" fill="none" stroke="{colour}" stroke-width="{width:g}" {style}/>\n'


# -- wiring -----------------------------------------------------------------------------------------


def wiring() -> str:
    """Return the drawing of computer, Mega, shield, drivers, motors and power, with all pins."""
    parts = [
        SIZE.format(
            980, 640, "Wiring: Arduino Mega 2560, CNC shield, three A4988 drivers, three motors, power"
        )
    ]
    parts += [line([(150, 150), (230, 150)], GREY, 6), text(160, 138, "USB")]
    parts += [
        box(30, 110, (120, 80), "#eceff1"),
        text(52, 146, "Computer", BOLD),
        text(52, 168, "beatrix hw"),
    ]
    parts += [
        box(30, 270, (130, 64), "#eceff1"),
        text(44, 298, "Two cameras", BOLD),
        text(44, 319, "in the skull"),
    ]
    parts += [line([(90, 270), (90, 190)], GREY, 6), text(102, 236, "USB")]
    parts += [
        box(230, 60, (130, 480), "#d7ebee"),
        text(250, 90, "Arduino", BOLD),
        text(250, 110, "Mega 2560", BOLD),
    ]
    parts += [box(440, 60, (250, 480), "#f4e9ea"), text(460, 90, "CNC shield, on the Mega", BOLD)]
    for index in range(len(ARMS)):
        parts += driver(index)
    enable = ROBOT.pins.enable
    parts += [pin(enable, "enable of all: low = on", 492)]
    parts += [box(440, 575, (250, 50), "#eceff1"), text(460, 606, "Power supply, 12 V DC", BOLD)]
    parts += [line([(520, 575), (520, 540)], RED, 5), line([(600, 575), (600, 540)], BLACK, 5)]
    parts += [text(532, 564, "+", BOLD), text(612, 564, "&#8722;", BOLD)]
    parts += [
        text(30, 566, "USB alone runs the firmware,"),
        text(30, 586, "not the motors. Never plug a"),
        text(30, 606, "motor in or out under power."),
    ]
    return "".join(parts) + "</svg>\n"


def pin(number: int, words: str, y: float) -> str:
    """Return a pin of the Mega and its line to the shield at a height (px)."""
    label = text(336, y + 5, str(number), f'{BOLD} text-anchor="middle"')
    return label + line([(360, y), (440, y)], GREY, 2) + text(452, y + 5, words, 'font-size="13"')


def driver(index: int) -> Iterator[str]:
    """Yield the parts of one driver: its pins, its socket with jumpers, its motor and the wires between them."""
    (name, colour), axis, top = list(ARMS.items())[index], DRIVERS[index], 120 + 118 * index
    fill, drive = hexadecimal(colour), ROBOT.drive
    yield pin(ROBOT.pins.step[index], f"{axis} step", top + 20)
    yield pin(ROBOT.pins.dir[index], f"{axis} direction", top + 50)
    yield box(560, top, (110, 84), "#fff", f'stroke="{fill}" stroke-width="3"')
    yield text(572, top + 24, f"A4988, {axis}", BOLD)
    yield text(572, top + 48, "jumpers on", 'font-size="13"')
    yield text(572, top + 68, JUMPERS[drive.microsteps] or "none", f'{BOLD} font-size="13"')
    for wire in range(4):
        yield line([(670, top + 21 + 14 * wire), (780, top + 21 + 14 * wire)], fill, 2.5)
    yield box(780, top, (84, 84), hexadecimal(COLOURS.metal))
    yield f'<circle cx="822" cy="{top + 42}" r="20" fill="{fill}"/>\n'
    yield text(876, top + 32, f"{name} arm", BOLD)
    yield text(876, top + 54, "NEMA 17", 'font-size="13"')
    yield text(876, top + 74, f"{drive.full_steps} steps", 'font-size="13"')


# -- parts ------------------------------------------------------------------------------------------

SCALE: Final = 1150.0
"""px for 1 m"""
MIDDLE: Final = (230.0, 890.0)
"""Place (px) of the foot of the vertical axis."""
FROM: Final = math.radians(14.0)
"""Direction of the view: azimuth from the robot's front towards its left (rad)."""
ABOVE: Final = math.radians(20.0)
"""Elevation of the view (rad)."""
LIFTS: Final = {"long": 0.06, "middle": 0.13, "short": 0.20, "rods": 0.285, "head": 0.365}
"""How far (m) parts are lifted out of their places."""


def seen(place: Vector, lift: float = 0.0) -> tuple[float, float]:
    """Return where a place (m) lies in the picture (px)."""
    x, y, z = place
    right, near = y * math.cos(FROM) - x * math.sin(FROM), x * math.cos(FROM) + y * math.sin(FROM)
    up = (z + lift - SIZES.floor) * math.cos(ABOVE) - near * math.sin(ABOVE)
    return MIDDLE[0] + SCALE * right, MIDDLE[1] - SCALE * up


def disc(place: Vector, radius: float, height: float, colour: str, lift: float = 0.0) -> str:
    """Return an upright cylinder: its middle, radius and height (m)."""
    (x, low), (_, high) = (
        seen((place[0], place[1], place[2] + half), lift) for half in (-height / 2, height / 2)
    )
    wide, deep = SCALE * radius, SCALE * radius * math.sin(ABOVE)
    side = f"M{x - wide:.1f} {high:.1f}V{low:.1f}A{wide:.1f} {deep:.1f} 0 0 0 {x + wide:.1f} {low:.1f}V{high:.1f}z"
    top = f'<ellipse cx="{x:.1f}" cy="{high:.1f}" rx="{wide:.1f}" ry="{deep:.1f}" fill="{colour}" stroke="#333"/>\n'
    return f'<path d="{side}" fill="{colour}" stroke="#333"/>\n{top}'


def tube(places: Sequence[Vector], colour: str, width: float, lift: float = 0.0) -> str:
    """Return a bent tube through these places (m), with its width (px) and a dark edge."""
    points = [seen(place, lift) for place in places]
    return line(points, "#333", width + 2) + line(points, colour, width)


def nearest_last(places: Sequence[Vector]) -> list[int]:
    """Return the indices of these places, the furthest from the viewer first."""
    return sorted(
        range(len(places)), key=lambda i: places[i][0] * math.cos(FROM) + places[i][1] * math.sin(FROM)
    )


def base() -> Iterator[str]:
    """Yield the base: foot, three motors with pinions, plate."""
    neck = chains(ROBOT.geometry)
    yield disc((0.0, 0.0, SIZES.floor + 0.006), 0.085, 0.012, hexadecimal(COLOURS.base))
    pinion = SIZES.ring_radius * 0.87 * ROBOT.drive.gear_pinion / ROBOT.drive.gear_ring
    motors = [motor_at(chain.azimuth, MOTOR) for chain in neck]
    for index in nearest_last(motors):
        azimuth, colour = neck[index].azimuth, hexadecimal(list(ARMS.values())[index])
        foot, top = direction(azimuth, 0.075, SIZES.floor + 0.012), direction(azimuth, 0.05625, PLATE)
        yield tube([foot, top], hexadecimal(COLOURS.trim), 8)
        yield disc(motors[index], 0.020, 0.034, colour)
    yield disc((0.0, 0.0, PLATE), 0.062, 0.006, hexadecimal(COLOURS.base))
    for index in nearest_last(motors):
        x, y, _ = motors[index]
        height = SIZES.ring_heights[index]
        yield tube([(x, y, PLATE + 0.003), (x, y, height)], hexadecimal(COLOURS.metal), 4)
        yield disc((x, y, height), pinion, SIZES.ring_thickness, hexadecimal(COLOURS.metal))


def arm(index: int) -> Iterator[str]:
    """Yield one arm: its ring gear, and its upright with the elbow."""
    name, height, lift = list(ARMS)[index], SIZES.ring_heights[index], LIFTS[list(ARMS)[index]]
    chain, colour = chains(ROBOT.geometry)[index], hexadecimal(ARMS[name])
    elbow = scaled(chain.elbow, ROBOT.head.arm_length)
    upright = tube(
        [
            direction(chain.azimuth, SIZES.post_radius, height),
            scaled(chain.elbow, 1.2 * ROBOT.head.arm_length),
            elbow,
        ],
        colour,
        9,
        lift,
    )
    ring = disc((0.0, 0.0, height), SIZES.ring_radius, SIZES.ring_thickness, colour, lift)
    x, y = seen((0.0, 0.0, height + SIZES.ring_thickness / 2), lift)
    wide = SCALE * SIZES.ring_radius * 0.87
    ring += f'<ellipse cx="{x:.1f}" cy="{y:.1f}" rx="{wide:.1f}" ry="{wide * math.sin(ABOVE):.1f}" fill="#fff" stroke="#333" stroke-dasharray="2 3"/>\n'
    behind = math.cos(chain.azimuth - FROM) < 0
    yield upright + ring if behind else ring + upright


def rod(index: int) -> str:
    """Return one rod: an arc about the neck's centre, from the elbow to the mount of the skull."""
    chain, radius = chains(ROBOT.geometry)[index], ROBOT.head.arm_length
    angle = math.radians(ROBOT.geometry.rod_twist)
    arc = []
    for step in range(17):
        part = step / 16 * angle
        start, end = math.sin(angle - part) / math.sin(angle), math.sin(part) / math.sin(angle)
        x, y, z = (start * a + end * b for a, b in zip(chain.elbow, chain.mount, strict=True))
        arc.append(scaled((x, y, z), radius))
    ends = "".join(dot(arc[end], list(ARMS.values())[index], LIFTS["rods"]) for end in (0, -1))
    return tube(arc, hexadecimal(COLOURS.rod), 10, LIFTS["rods"]) + ends


def dot(place: Sequence[float], colour: tuple[int, int, int], lift: float, radius: float = 7) -> str:
    """Return a small circle at a place (m); its radius is in px."""
    x, y = seen((place[0], place[1], place[2]), lift)
    return f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{radius:g}" fill="{hexadecimal(colour)}" stroke="#333"/>\n'


def head() -> Iterator[str]:
    """Yield the skull: its three mounts, and two eyes, which are the cameras."""
    size, lift = ROBOT.head, LIFTS["head"]
    mounts = [scaled(chain.mount, size.mount_radius) for chain in chains(ROBOT.geometry)]
    for index in nearest_last(mounts):
        yield tube([(0.0, 0.0, size.mount_radius), mounts[index]], hexadecimal(COLOURS.trim), 8, lift)
        yield dot(mounts[index], list(ARMS.values())[index], lift)
    x, y = seen((0.0, 0.0, size.centre_height), lift)
    yield f'<ellipse cx="{x:.1f}" cy="{y:.1f}" rx="{SCALE * 0.088:.1f}" ry="{SCALE * 0.092:.1f}" fill="{hexadecimal(COLOURS.shell)}" stroke="#333"/>\n'
    for side in (-0.5, 0.5):
        eye = SIZES.eye_forward * 0.8, side * size.eye_baseline, size.centre_height + SIZES.eye_up
        yield dot(eye, COLOURS.white, lift, 24)
        yield dot((SIZES.eye_forward, *eye[1:]), COLOURS.iris, lift, 12)
        yield dot((SIZES.eye_forward, *eye[1:]), COLOURS.black, lift, 5)


def labels() -> Iterator[str]:
    """Yield number, name and figures of each part, with a line to it; the numbers are the order of assembly."""
    drive, size, geometry = ROBOT.drive, ROBOT.head, ROBOT.geometry
    rings = [(name, height, LIFTS[name]) for name, height in zip(ARMS, SIZES.ring_heights, strict=True)]
    rows = [
        (SIZES.floor + 0.04, 0.0, "Base", f"three NEMA 17 motors; pinions of {drive.gear_pinion} teeth"),
        *(
            (
                z,
                lift,
                f"{name.capitalize()} arm",
                f"ring of {drive.gear_ring} teeth inside, upright to the elbow",
            )
            for name, z, lift in reversed(rings)
        ),
        (-0.01, LIFTS["rods"], "Three rods", f"twisted by {geometry.rod_twist:g}°, from elbow to skull"),
        (
            size.centre_height,
            LIFTS["head"],
            "Skull",
            f"three mounts, two cameras {1000 * size.eye_baseline:g} mm apart",
        ),
    ]
    for number, (height, lift, name, figures) in enumerate(rows, 1):
        x, y = seen((0.0, 0.0, height), lift)
        yield line([(x + 60, y), (390, y)], GREY, 1.5, 'stroke-dasharray="3 4"')
        yield f'<circle cx="406" cy="{y:.0f}" r="15" fill="#222"/>\n' + text(
            406, y + 5, str(number), f'{BOLD} fill="#fff" text-anchor="middle"'
        )
        yield text(432, y - 3, name, f'{BOLD} font-size="17"') + text(432, y + 17, figures)


def assembly() -> str:
    """Return the drawing of the robot's parts, lifted out of their places."""
    rods = [scaled(chain.mount, 1.0) for chain in chains(ROBOT.geometry)]
    axis = [seen((0.0, 0.0, SIZES.floor)), seen((0.0, 0.0, ROBOT.head.centre_height), LIFTS["head"])]
    parts = [
        SIZE.format(840, 930, "The parts of the robot in the order of assembly"),
        line(axis, GREY, 1.5, 'stroke-dasharray="9 5"'),
    ]
    parts += [*labels(), *base()]
    for index in reversed(range(len(ARMS))):
        parts += arm(index)
    parts += [rod(index) for index in nearest_last(rods)]
    return "".join([*parts, *head()]) + "</svg>\n"


DRAWINGS: Final = {"wiring.svg": wiring, "assembly.svg": assembly}

if __name__ == "__main__":
    for file, drawn in DRAWINGS.items():
        (IMAGES / file).write_text(drawn(), encoding="utf-8")
