"""A lab's own robot: a TOML file whose values take the place of the shipped ones."""

from __future__ import annotations

import hashlib
import math
import tomllib
from collections.abc import Iterator
from pathlib import Path

import msgspec

from beatrix_zenoh import files
from beatrix_zenoh._generated.messages import Reason
from beatrix_zenoh._generated.robot import ALLOWED, ROBOT, Range, RobotData
from beatrix_zenoh.drive import Arms
from beatrix_zenoh.errors import QUOTED, BeatrixError, Refused, WrongUsage, quoted
from beatrix_zenoh.kinematics import Neck
from beatrix_zenoh.limits import BEYOND, Limits, looked_at
from beatrix_zenoh.rotation import leaning

Tables = dict[str, dict[str, object]]

LONGEST_FILE = 1 << 20
"""Bytes; what is longer, or never ends, is something else."""
LEAST_TILT = ALLOWED["limits"]["tilt_max"].low
NEAR = math.radians(2.0)
"""What every robot must be able to do from home, in any direction."""
GRID, DIRECTIONS = math.radians(1.5), 48
"""Poses are tried at every so much of tilt (rad), in so many directions: some 30 ms."""
SAME = math.radians(0.01)
ROUNDING = 1e-9
HOME: Arms = (0.0, 0.0, 0.0)
AS_BUILT = (
    "is compiled into the firmware. To build it for another robot, in the folder of BEATRIX: change schemas/robot.toml, "
    "then `make generate`, `make firmware`, `beatrix flash`; nodes and simulations that start from there count alike."
)
SIGN = "cannot be told: turn the plug of the motor that turns the wrong way round."
PINS = "is how the firmware is wired: firmware/mega/pins.h."
ANGLES = "arm_angle, rod_twist and mount_angle"
FIRMWARE = "the firmware is built for no wider ones"


def load(path: Path | None) -> RobotData:
    """The shipped robot, with the values of this file if there is one: tables and names as in docs/reference/robot.md.

    Raises:
        WrongUsage: BAD_VALUE, naming what is wrong and what there is.
    """
    if path is None:
        return ROBOT
    tables: Tables = msgspec.to_builtins(ROBOT)
    called = f"--robot-file {path}"
    try:
        held = files.content(path, LONGEST_FILE, called=called, form="TOML", nothing="no robot's values are")
        given = tomllib.loads(held.decode())
    except (OSError, ValueError, RecursionError) as error:
        raise WrongUsage(Reason.BAD_VALUE, f"{called} cannot be read: {error}.") from error
    try:
        fields = set()
        for table, field, value in entries(given, tables):
            tables[table][field] = value
            fields.add(field)
        robot = msgspec.convert(tables, RobotData)
        check(robot, fields)
        check_motions(robot)
    except (Refused, msgspec.ValidationError) as error:
        raise WrongUsage(Reason.BAD_VALUE, f"{path}: {error}") from error
    return robot


def fingerprint(robot: RobotData) -> str:
    """Eight hex digits that are the same for the same values."""
    return hashlib.sha256(msgspec.json.encode(robot)).hexdigest()[:8]


def entries(given: dict[str, object], known: Tables) -> Iterator[tuple[str, str, object]]:
    """Table, field and value of all that a file says; raises Refused for what is not there, as built, or no number."""
    for table, values in given.items():
        if table not in known or not isinstance(values, dict):
            raise Refused(Reason.BAD_VALUE, f"{quoted(table)} is no table. There are: {', '.join(known)}.")
        for field, value in values.items():
            if field not in known[table]:
                raise Refused(
                    Reason.BAD_VALUE,
                    f"[{table}] has no {quoted(field)}. There are: {', '.join(known[table])}.",
                )
            if field not in ALLOWED[table]:
                why = SIGN if field == "sign" else PINS if table == "pins" else AS_BUILT
                raise Refused(Reason.BAD_VALUE, f"[{table}] {field} {why}")
            whole = isinstance(known[table][field], int)
            if isinstance(value, bool) or not isinstance(value, int if whole else int | float):
                raise outside(table, field, repr(value), ALLOWED[table][field], whole=whole)
            yield table, field, value


def check(robot: RobotData, given: set[str]) -> None:
    """Refuse values outside what is allowed, for the field or beside the others; raises Refused."""
    check_table(robot, "geometry", given, {})
    try:
        reach = math.degrees(Neck(robot.geometry).reach)
    except Refused as error:
        raise Refused(error.reason, f"[geometry] {ANGLES}: {error.message}") from error
    most = math.floor(10 * (reach - 1) + ROUNDING) / 10
    if most < LEAST_TILT:
        raise Refused(
            Reason.BAD_VALUE,
            f"[geometry] {ANGLES} let the head tilt {reach:.1f} deg in every direction; "
            f"{LEAST_TILT + 1:g} deg are needed.",
        )
    shipped = ROBOT.limits
    ends: dict[str, tuple[float, str]] = {
        "tilt_max": (most, f"the rods reach {reach:.1f} deg in every direction, less a degree"),
        "gap_min": (shipped.gap_min, FIRMWARE),
        "yaw_max": (shipped.yaw_max, FIRMWARE),
        "speed_max": (shipped.speed_max, FIRMWARE),
        "speed_default": (robot.limits.speed_max, "no more than speed_max"),
    }
    for table in ALLOWED:
        check_table(robot, table, given, ends if table == "limits" else {})


def check_table(robot: RobotData, table: str, given: set[str], ends: dict[str, tuple[float, str]]) -> None:
    """The same for one table; `ends` close its open ranges, and say why."""
    for field, (low, high, unit) in ALLOWED[table].items():
        value = getattr(getattr(robot, table), field)
        end, why = ends.get(field, (0.0, ""))
        allowed = Range(end if low == -math.inf else low, end if high == math.inf else high, unit)
        whole = isinstance(value, int)
        fits = value in allowed[:2] if whole else allowed.low <= value <= allowed.high
        if not fits:
            text = f"{value}" + ("" if field in given else ", as shipped")
            raise outside(table, field, text, allowed, why, whole=whole)


def outside(table: str, field: str, value: str, allowed: Range, why: str = "", *, whole: bool) -> Refused:
    """What to raise for a value that is not allowed."""
    low, high, unit = allowed
    if whole:
        text = f"{low} or {high} is allowed"
    elif math.isfinite(low + high):
        text = f"{low:g} to {high:g} {unit}".rstrip() + " is allowed"
    else:
        text = f"a number of {unit} is needed"
    because = f" ({why})" if why else ""
    return Refused(Reason.BAD_VALUE, f"[{table}] {field} = {value[:QUOTED]}: {text}{because}.")


def check_motions(robot: RobotData) -> None:
    """Refuse a robot that cannot look anywhere near home, or could stand otherwise than asked; raises Refused."""
    try:
        neck = Neck(robot.geometry)
        snaps = snaps_at(neck, looked_at(neck, math.radians(robot.limits.tilt_max)))
        if snaps is None:
            limits = Limits(robot)
            speed = (limits.default_speed,) * 3
            for yaw, pitch, roll in near_home():
                limits.check_motion(HOME, HOME, neck.inverse(yaw, pitch, roll), speed, straight=True)
    except BeatrixError as error:
        field = (
            f"[limits] gap_min = {robot.limits.gap_min:g}"
            if error.reason is Reason.ARM_GAP
            else f"[geometry] {ANGLES}"
        )
        raise Refused(
            Reason.BAD_VALUE, f"{field}: the head could not turn by 2 deg from home. {error.message}"
        ) from error
    if snaps is not None:
        most = math.degrees(snaps - GRID - BEYOND)
        raise Refused(
            Reason.BAD_VALUE,
            f"[limits] tilt_max = {robot.limits.tilt_max:g}: with these {ANGLES} the neck can snap into another position "
            f"where the head tilts by {math.degrees(snaps):.0f} deg: at most {math.floor(most)} deg may be allowed.",
        )


def snaps_at(neck: Neck, most: float) -> float | None:
    """The least tilt (rad), up to this, at which the arms of a head also fit another; None if there is none."""
    for level in range(1, math.ceil(most / GRID) + 1):
        tilt = min(level * GRID, most)
        around = (leaning(tilt, math.tau * index / DIRECTIONS) for index in range(DIRECTIONS))
        if not all(stands(neck, pitch, roll) for pitch, roll in around):
            return tilt
    return None


def stands(neck: Neck, pitch: float, roll: float) -> bool:
    """The arms for this pose (rad) lead to it."""
    try:
        there = neck.forward(neck.inverse(0.0, pitch, roll))
    except BeatrixError:
        return False
    return math.dist(there, (0.0, pitch, roll)) < SAME


def near_home() -> Iterator[Arms]:
    """Poses (rad) close to home, on all sides."""
    for yaw in (-NEAR, NEAR):
        for pitch in (-NEAR, 0.0, NEAR):
            for roll in (-NEAR, 0.0, NEAR):
                yield yaw, pitch, roll
