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
font-family="sans-serif" font-size="{2}" fill="#222" stroke-linecap="round" stroke-linejoin="round">
<title>{3}</title>
<rect width="{0}" height="{1}" fill="#fff"/>
"""
JUMPERS: Final = {1: "", 2: "MS1", 4: "MS2", 8: "MS1 MS2", 16: "MS1 MS2 MS3"}
"""Jumpers of an A4988 by microsteps for a full step (table of its data sheet)."""
DRIVERS: Final = "XYZ"
OUTPUTS: Final = ("2B", "2A", "1A", "1B")
"""Outputs of an A4988 in the order of its pins: a coil each for 2 and 1."""
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
            760, 940, 22, "Wiring: Arduino Mega 2560, CNC shield, three A4988 drivers, three motors, power"
        )
    ]
    parts += [box(20, 20, (190, 80), "#eceff1"), text(36, 52, "Computer", BOLD), text(36, 82, "beatrix hw")]
    parts += [box(330, 20, (320, 80), "#eceff1"), text(346, 52, "Cameras, microphones", BOLD)]
    parts += [text(346, 82, "in the skull")]
    parts += [line([(210, 60), (330, 60)], GREY, 6), text(240, 48, "USB")]
    parts += [line([(95, 100), (95, 150)], GREY, 6), text(112, 134, "USB")]
    parts += [box(20, 150, (150, 600), "#d7ebee"), text(36, 184, "Arduino", BOLD)]
    parts += [text(36, 212, "Mega", BOLD), text(36, 240, "2560", BOLD)]
    parts += [box(230, 150, (310, 600), "#f4e9ea"), text(246, 184, "CNC shield", BOLD)]
    parts += [text(620, 184, "NEMA 17", BOLD)]
    for index in range(len(ARMS)):
        parts += driver(index)
    parts += [pin(ROBOT.pins.enable, "enable of all: low = on", 710)]
    parts += [line([(290, 750), (290, 860)], RED, 5), line([(480, 750), (480, 860)], BLACK, 5)]
    parts += [box(245, 778, (146, 46), "#fff"), text(256, 809, "switch, fuse"), text(306, 852, "+", BOLD)]
    parts += [text(494, 852, "&#8722;", BOLD)]
    parts += [box(230, 860, (310, 60), "#eceff1"), text(246, 898, "Power supply, 12 V DC", BOLD)]
    notes = (
        "USB alone runs",
        "the firmware, not",
        "the motors. Never",
        "plug a motor in or",
        "out under power.",
    )
    parts += [text(20, 790 + 28 * row, note) for row, note in enumerate(notes)]
    return "".join(parts) + "</svg>\n"


def pin(number: int, words: str, y: float) -> str:
    """Return a pin of the Mega and its line to the shield at a height (px)."""
    label = text(156, y + 8, str(number), f'{BOLD} text-anchor="end"')
    return label + line([(170, y), (230, y)], GREY, 2) + text(240, y + 8, words)


def driver(index: int) -> Iterator[str]:
    """Yield the parts of one driver: its pins, its socket with jumpers, its motor and the wires of both coils."""
    (name, colour), axis, top = list(ARMS.items())[index], DRIVERS[index], 210 + 160 * index
    fill, jumpers = hexadecimal(colour), JUMPERS[ROBOT.drive.microsteps]
    yield pin(ROBOT.pins.step[index], f"{axis} step", top + 70)
    yield pin(ROBOT.pins.dir[index], f"{axis} direction", top + 105)
    yield box(384, top, (146, 124), "#fff", f'stroke="{fill}" stroke-width="3"')
    yield text(396, top + 30, f"A4988, {axis}", BOLD)
    yield text(396, top + 72, "jumpers on")
    yield text(396, top + 100, jumpers or "none", BOLD)
    for wire, output in enumerate(OUTPUTS):
        y = top + 20 + 24 * wire + 12 * (wire > 1)
        yield text(544, y + 6, output, 'font-size="17"')
        yield line([(570, y), (620, y)], fill, 2.5)
    yield box(620, top, (124, 124), hexadecimal(COLOURS.metal))
    yield f'<circle cx="682" cy="{top + 48}" r="30" fill="{fill}"/>\n'
    yield text(682, top + 110, name, f'{BOLD} text-anchor="middle"')


# -- parts ------------------------------------------------------------------------------------------

SCALE: Final = 1150.0
"""px for 1 m"""
MIDDLE: Final = (230.0, 890.0)
"""Place (px) of the foot of the vertical axis."""
FROM: Final = math.radians(14.0)
"""Direction of the view: azimuth from the robot's front towards its left (rad)."""
ABOVE: Final = math.radians(20.0)
"""Elevation of the view (rad)."""
MAST: Final = -0.058
"""Height of the upper end of the mast (m)."""
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
    yield tube([(0.0, 0.0, PLATE + 0.003), (0.0, 0.0, MAST)], hexadecimal(COLOURS.metal), 14)
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
    """Yield number, name and sizes of each part, with a line to it; the numbers are the order of assembly."""
    drive, size = ROBOT.drive, ROBOT.head
    elbow = chains(ROBOT.geometry)[0].elbow[2] * size.arm_length
    rings = zip(ARMS, SIZES.ring_heights, strict=True)
    rows = [
        (SIZES.floor + 0.04, 0.0, "Base, with the mast", f"3 motors, pinions of {drive.gear_pinion} teeth"),
        *(
            (z, LIFTS[name], f"{name.capitalize()} arm", f"elbow {millimetres(elbow - z)} above the ring")
            for name, z in reversed(list(rings))
        ),
        (-0.01, LIFTS["rods"], "Three rods", f"twisted by {ROBOT.geometry.rod_twist:g}°, elbow to skull"),
        (size.centre_height, LIFTS["head"], "Skull", f"two cameras {millimetres(size.eye_baseline)} apart"),
    ]
    for number, (height, lift, name, figures) in enumerate(rows, 1):
        x, y = seen((0.0, 0.0, height), lift)
        yield line([(x + 60, y), (358, y)], GREY, 1.5, 'stroke-dasharray="3 4"')
        yield f'<circle cx="378" cy="{y:.0f}" r="20" fill="#222"/>\n' + text(
            378, y + 9, str(number), f'{BOLD} fill="#fff" text-anchor="middle"'
        )
        yield text(410, y - 3, name, BOLD) + text(410, y + 26, figures)


def millimetres(length: float) -> str:
    """Return a length (m) as text."""
    return f"{1000 * length:.0f} mm"


def assembly() -> str:
    """Return the drawing of the robot's parts, lifted out of their places."""
    rods = [scaled(chain.mount, 1.0) for chain in chains(ROBOT.geometry)]
    axis = [seen((0.0, 0.0, SIZES.floor)), seen((0.0, 0.0, ROBOT.head.centre_height), LIFTS["head"])]
    parts = [
        SIZE.format(800, 930, 25, "The parts of the robot in the order of assembly"),
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
