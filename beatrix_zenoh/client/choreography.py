"""Choreographies: motion files with speeds, whose poses begin at given times, for one robot or both."""

from __future__ import annotations

from importlib import resources
from pathlib import Path

import msgspec

from beatrix_zenoh.client import motion_file
from beatrix_zenoh.client.motion_file import FORM, SPEED, MotionFile, Place
from beatrix_zenoh.client.queries import motion_query, pose_query
from beatrix_zenoh.client.readings import HeadAngles
from beatrix_zenoh.contract._generated.messages import MotionQuery, PoseQuery, Reason
from beatrix_zenoh.contract.errors import WrongUsage

SHIPPED = resources.files("beatrix_zenoh") / "choreographies"


class Pose(msgspec.Struct, frozen=True):
    """A pose of the head (deg), its time (s after the start) and speed (deg/s)."""

    at: float
    yaw: float
    pitch: float
    roll: float
    speed: float

    def query(self) -> PoseQuery:
        """Return the request for this pose; its speed is that of the fastest arm."""
        return pose_query(self.yaw, self.pitch, self.roll, relative=False, speed=self.speed)

    def __str__(self) -> str:
        return f"yaw {self.yaw:+g}°, pitch {self.pitch:+g}°, roll {self.roll:+g}°"


class ArmPose(msgspec.Struct, frozen=True):
    """A position of the arms (deg), its time (s after the start) and speed (deg/s)."""

    at: float
    short: float
    middle: float
    long: float
    speed: float

    def query(self) -> MotionQuery:
        """Return the request for this position; its speed is that of each arm."""
        return motion_query(self.short, self.middle, self.long, relative=False, speed=self.speed)

    def __str__(self) -> str:
        return f"arms short {self.short:+g}°, middle {self.middle:+g}°, long {self.long:+g}°"


Step = Pose | ArmPose


class Choreography(msgspec.Struct, frozen=True):
    """A sequence of poses, each with the name of its gesture."""

    steps: list[tuple[str, Step]]
    source: str = ""
    """the name in error messages; empty: no file"""
    lines: tuple[int, ...] = ()
    """the line of each step in the file; empty: no file"""

    def at_speed(self, speed: float) -> Choreography:
        """Return this choreography with one speed (deg/s) for all steps; raises WrongUsage unless it is above 0."""
        speed = checked_speed(speed)
        return msgspec.structs.replace(
            self, steps=[(title, msgspec.structs.replace(pose, speed=speed)) for title, pose in self.steps]
        )

    def where(self, index: int) -> str:
        """Return the place of a step for error messages: file, line or number, and time."""
        line = f"line {self.lines[index]}" if self.lines else f"step {index + 1}"
        source = f"{self.source}, " if self.source else ""
        return f"{source}{line} (t = {self.steps[index][1].at:.2f} s)"


def shipped(name: str) -> Choreography:
    """Return a choreography that comes with the package, such as `hello`."""
    return choreography(motion_file.parse((SHIPPED / f"{name}.csv").read_text(encoding="utf-8"), name))


def load(name: Path | str) -> Choreography:
    """Read a choreography from a file, or the shipped one of this name if there is no such file.

    Raises:
        WrongUsage: BAD_VALUE; the message names the wrong line.
    """
    path = Path(name)
    if not path.exists() and (SHIPPED / f"{path}.csv").is_file():
        return shipped(str(path))
    try:
        return choreography(motion_file.read(path))
    except OSError as error:
        names = ", ".join(sorted(entry.name.removesuffix(".csv") for entry in SHIPPED.iterdir()))
        raise WrongUsage(
            Reason.BAD_VALUE,
            f"{path} cannot be read: {error}. Name a file, or a shipped choreography: {names}.",
        ) from error


def choreography(read: MotionFile) -> Choreography:
    """Return the choreography in a motion file; raises WrongUsage (BAD_VALUE) for a path or a missing speed."""
    if not read.with_speed:
        raise WrongUsage(
            Reason.BAD_VALUE,
            f"{read.source} has no column {SPEED}, so it is a path: play it with `beatrix replay`.",
        )
    speed, title = read.points[0].speed, Path(read.source).stem
    steps: list[tuple[str, Step]] = []
    if speed is None:
        raise WrongUsage(
            Reason.BAD_VALUE,
            f"{read.source}, line {read.points[0].line}: {SPEED} is empty in the first point. Give "
            f"a number of degrees/s; in later lines an empty cell keeps the speed. {FORM}",
        )
    for point in read.points:
        speed, title = point.speed or speed, point.figure or title
        steps.append((title, step(point.t, point.place, speed)))
    return Choreography(steps, read.source, tuple(point.line for point in read.points))


def step(at: float, place: Place, speed: float) -> Step:
    """Return the step at a time (s) to a place (deg) with a speed (deg/s)."""
    if isinstance(place, HeadAngles):
        return Pose(at, *place, speed)
    return ArmPose(at, *place, speed)


def checked_speed(speed: float) -> float:
    """Return the speed (deg/s); raise WrongUsage unless it is above 0 and fits into a message."""
    pose_query(0, 0, 0, relative=False, speed=speed)
    if speed <= 0:
        raise WrongUsage(Reason.BAD_VALUE, f"speed is {speed:g}: give a number of degrees/s above 0.")
    return speed
