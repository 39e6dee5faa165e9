"""The values of a lab's own robot: a TOML file that overrides the default values."""

from __future__ import annotations

import hashlib
import itertools
import math
from collections.abc import Iterator
from pathlib import Path

import msgspec

from beatrix_zenoh import files
from beatrix_zenoh.contract import codec
from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract._generated.robot import ALLOWED, ROBOT, RobotData
from beatrix_zenoh.contract.errors import BeatrixError, Refused, bad_value, quoted, wrong_usage
from beatrix_zenoh.motion.kinematics import Neck
from beatrix_zenoh.motion.limits import TILT_KNOWN_BEYOND, MotionLimits, known_tilt
from beatrix_zenoh.motion.rotation import leaning

codec.prepare(RobotData)

Tables = dict[str, dict[str, object]]

LONGEST_FILE = 1 << 20
"""Largest size of a file (bytes)."""
LEAST_TILT = ALLOWED["limits"]["tilt_max"].low
NEAR = math.radians(2.0)
"""Angle (rad) that every robot must reach from home, in any direction."""
GRID, DIRECTIONS = math.radians(1.5), 48
"""Spacing of the tested poses in tilt (rad), and number of directions; the test takes about 30 ms."""
SAME = math.radians(0.01)
ROUNDING = 1e-9
HOME = (0.0, 0.0, 0.0)
FIXED = (
    "is fixed in the firmware. For another robot, in the folder of BEATRIX: change schemas/robot.toml, then `make "
    "generate`, `make firmware`, `beatrix flash`, and start all nodes in that folder. If a motor turns the wrong way, "
    "reverse its plug."
)
ANGLES = "arm_angle, rod_twist and mount_angle"


def load(path: Path | None) -> RobotData:
    """Return the default robot with the values of this file, if any: tables and names as in docs/reference/robot.md.

    Raises:
        WrongUsage: BAD_VALUE; the file cannot be read, or an entry is wrong: the message names it and what is allowed.
    """
    if path is None:
        return ROBOT
    tables: Tables = msgspec.to_builtins(ROBOT)
    called = f"--robot-file {path}"
    try:
        given = files.toml(path, LONGEST_FILE, called)
    except OSError as error:
        raise wrong_usage(f"{called} cannot be read: {error}.") from error
    try:
        fields = set()
        for table, field, value in entries(given, tables):
            tables[table][field] = value
            fields.add(field)
        robot = msgspec.convert(tables, RobotData)
        check(robot, fields)
        check_motions(robot)
    except (Refused, msgspec.ValidationError) as error:
        raise wrong_usage(f"{path}: {error}") from error
    return robot


def fingerprint(robot: RobotData) -> str:
    """Return a hash of all values, in eight hex digits."""
    return hashlib.sha256(msgspec.json.encode(robot)).hexdigest()[:8]


def entries(given: dict[str, object], known: Tables) -> Iterator[tuple[str, str, object]]:
    """Yield the table, field and value of each entry.

    Raises Refused for unknown tables, and for unknown or fixed fields.
    """
    for table, values in given.items():
        if table not in known or not isinstance(values, dict):
            raise bad_value(f"{quoted(table)} is not a table. The tables are: {', '.join(known)}.")
        for field, value in values.items():
            if field not in known[table]:
                raise bad_value(
                    f"[{table}] has no {quoted(field)}. Its fields are: {', '.join(known[table])}.",
                )
            if field not in ALLOWED[table]:
                raise bad_value(f"[{table}] {field} {FIXED}")
            yield table, field, value


def check(robot: RobotData, given: set[str]) -> None:
    """Raise Refused for values out of range, alone or in combination."""
    check_table(robot, "geometry", given, {})
    try:
        reach = math.degrees(Neck(robot.geometry).reach)
    except Refused as error:
        raise Refused(error.reason, f"[geometry] {ANGLES}: {error.message}") from error
    most = math.floor(10 * (reach - 1) + ROUNDING) / 10
    if most < LEAST_TILT:
        raise bad_value(
            f"[geometry] {ANGLES} let the head tilt {reach:.1f}° in every direction; "
            f"{LEAST_TILT + 1:g}° are needed.",
        )
    shipped = ROBOT.limits
    ends = {
        "tilt_max": most,
        "gap_min": shipped.gap_min,
        "yaw_max": shipped.yaw_max,
        "speed_max": shipped.speed_max,
        "speed_default": robot.limits.speed_max,
    }
    for table in ALLOWED:
        check_table(robot, table, given, ends)


def check_table(robot: RobotData, table: str, given: set[str], ends: dict[str, float]) -> None:
    """Raise Refused if a value of one table is out of range; `ends`: limits of fields from other values."""
    for field, allowed in ALLOWED[table].items():
        value = getattr(getattr(robot, table), field)
        low, high = (ends.get(field, end) if math.isinf(end) else end for end in allowed[:2])
        whole = isinstance(value, int)
        if value in (low, high) if whole else low <= value <= high:
            continue
        raise bad_value(
            f"[{table}] {field} = {value}{'' if field in given else ', the default value'}: {low:g} "
            f"{'or' if whole else 'to'} {high:g} {allowed.unit} is allowed"
            + (": the firmware, the rods or another value allow no wider limit." if field in ends else "."),
        )


def check_motions(robot: RobotData) -> None:
    """Raise Refused for a robot that cannot move around home, or whose neck could snap into another assembly."""
    try:
        neck = Neck(robot.geometry)
        snaps = snaps_at(neck, known_tilt(neck, math.radians(robot.limits.tilt_max)))
        if snaps is None:
            limits = MotionLimits(robot)
            speed = (limits.default_speed,) * 3
            for pose in itertools.product((-NEAR, 0.0, NEAR), repeat=3):
                limits.check_motion(HOME, HOME, neck.inverse(*pose), speed, straight=True)
    except BeatrixError as error:
        field = (
            f"[limits] gap_min = {robot.limits.gap_min:g}"
            if error.reason is Reason.ARM_GAP
            else f"[geometry] {ANGLES}"
        )
        raise bad_value(f"{field}: the head could not turn by 2° from home. {error.message}") from error
    if snaps is not None:
        most = math.degrees(snaps - GRID - TILT_KNOWN_BEYOND)
        raise bad_value(
            f"[limits] tilt_max = {robot.limits.tilt_max:g}: with these {ANGLES} the neck can snap into another "
            f"position where the head tilts by {math.degrees(snaps):.0f}°. At most {math.floor(most)}° is possible.",
        )


def snaps_at(neck: Neck, most: float) -> float | None:
    """Return the smallest tested tilt (rad) up to `most` at which the same arm angles fit another pose too, or None."""
    for level in range(1, math.ceil(most / GRID) + 1):
        tilt = min(level * GRID, most)
        around = (leaning(tilt, math.tau * index / DIRECTIONS) for index in range(DIRECTIONS))
        if not all(is_unique(neck, pitch, roll) for pitch, roll in around):
            return tilt
    return None


def is_unique(neck: Neck, pitch: float, roll: float) -> bool:
    """Return whether forward kinematics of the arm angles of this pose (rad) gives the same pose."""
    try:
        there = neck.forward(neck.inverse(0.0, pitch, roll))
    except BeatrixError:
        return False
    return math.dist(there, (0.0, pitch, roll)) < SAME
