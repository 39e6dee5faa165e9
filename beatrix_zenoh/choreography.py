"""Movements with times, played by simulation and hardware together."""

from __future__ import annotations

import time
import tomllib
from collections.abc import Callable
from importlib import resources
from typing import Protocol

import msgspec

from beatrix_zenoh._generated.messages import Reason
from beatrix_zenoh.errors import Refused

SHIPPED = resources.files("beatrix_zenoh") / "choreographies"
EXAMPLE = 'title = "…", speed = 75.0, and [[figure]] with title = "…" and poses = [[at, yaw, pitch, roll], …]'


class Pose(msgspec.Struct, frozen=True, array_like=True, forbid_unknown_fields=True):
    """Where to look (deg) and when to begin to turn there (s after the start)."""

    at: float
    yaw: float
    pitch: float
    roll: float


class Figure(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Poses that people see as one gesture."""

    title: str
    poses: list[Pose]


class Choreography(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Figures one after another; `speed` is that of the fastest arm, deg/s."""

    title: str
    speed: float
    figure: list[Figure]

    @property
    def steps(self) -> list[tuple[str, Pose]]:
        """All poses with the titles of their figures."""
        return [(figure.title, pose) for figure in self.figure for pose in figure.poses]


class Plan(Protocol):
    """A motion that was previewed."""

    def commit(self) -> None:
        """Carry it out; returns when the robots are there."""


class Stage(Protocol):
    """Who plays: a `Twin`."""

    def preview(self, yaw: float, pitch: float, roll: float, *, speed: float | None) -> Plan:
        """Try a head motion, deg and deg/s."""


def shipped(name: str) -> Choreography:
    """A choreography that comes with the package: `hello`."""
    return parse((SHIPPED / f"{name}.toml").read_text(encoding="utf-8"), name)


def parse(text: str, source: str) -> Choreography:
    """Read a choreography from its text.

    Raises:
        Refused: BAD_VALUE, naming what is wrong in `source`.
    """
    try:
        choreography = msgspec.convert(tomllib.loads(text), Choreography, strict=False)
    except (tomllib.TOMLDecodeError, msgspec.ValidationError) as error:
        raise Refused(Reason.BAD_VALUE, f"{source}: {error}. It holds {EXAMPLE}.") from error
    times = [pose.at for _, pose in choreography.steps]
    if not times or times != sorted(times):
        raise Refused(
            Reason.BAD_VALUE, f"{source}: the times of the poses must not decrease. It holds {EXAMPLE}."
        )
    return choreography


def play(stage: Stage, choreography: Choreography, tell: Callable[[str, Pose], None]) -> None:
    """Preview and commit pose after pose, each at its time or, if the one before took longer, as soon as possible.

    Raises:
        Refused, Interrupted, NoAnswer: of the first motion that failed; nothing follows it.
    """
    begin = time.monotonic()
    for title, pose in choreography.steps:
        tell(title, pose)
        plan = stage.preview(pose.yaw, pose.pitch, pose.roll, speed=choreography.speed)
        time.sleep(max(0.0, begin + pose.at - time.monotonic()))
        plan.commit()
