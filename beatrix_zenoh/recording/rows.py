"""The rows of a recording and the names of its entities, independent of Rerun."""

from __future__ import annotations

from dataclasses import dataclass

from beatrix_zenoh.client.session import Place
from beatrix_zenoh.recording.figure import Quaternion

RECORDER = "_recorder"
"""Root of the recorder's own entities; no robot can have this name."""
NOTES = f"{RECORDER}/notes"
"""Entity of the users' notes as lines."""
MARK = f"{RECORDER}/note"
"""Entity of the users' notes as bars on the time line."""


@dataclass(frozen=True)
class Row:
    """One value of an entity.

    `time_ns` is the source's time by the clock of the recording computer, since 1970; `robot_ns` the same moment by the
    robot's own wall clock.
    """

    path: str
    time_ns: int
    robot_ns: int


@dataclass(frozen=True)
class Numbers(Row):
    """Numbers of a plot: deg, deg/s or counts."""

    values: tuple[float, ...]


@dataclass(frozen=True)
class Orientation(Row):
    """Orientation of a body in its parent's frame."""

    quaternion: Quaternion


@dataclass(frozen=True)
class Line(Row):
    """A line of a log."""

    text: str
    level: str
    json: str = ""
    """the event of this line as JSON; empty: the line is no event"""


@dataclass(frozen=True)
class Bar(Row):
    """A state that lasts until the next one."""

    state: str


@dataclass(frozen=True)
class Frame(Row):
    """A camera's picture."""

    jpeg: bytes


def of_robot(place: Place, *parts: str) -> str:
    """Return the path of an entity of one robot, for example `bea/sim/arms`."""
    return "/".join((*place, *parts))


def of_model(place: Place, body: str) -> str:
    """Return the Rerun entity path of a body of a robot's model."""
    return of_robot(place, "model", body)


def of_difference(robot: str, what: str) -> str:
    """Return the path of the difference between hardware and simulation; `what` is `arms` or `head`."""
    return f"{robot}/difference/{what}"
