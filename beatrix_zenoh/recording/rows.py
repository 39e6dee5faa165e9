"""The rows of a recording, the names of its entities, and the outputs that get the rows; independent of Rerun."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol

from beatrix_zenoh.body.figure import Figure, Quaternion
from beatrix_zenoh.client.session import Place
from beatrix_zenoh.contract.names import SIDES
from beatrix_zenoh.recording.about import About

RECORDER = "_recorder"
"""Root of the recorder's own entities; no robot can have this name."""
NOTES = f"{RECORDER}/notes"
"""Entity of the users' notes as lines."""
MARK = f"{RECORDER}/note"
"""Entity of the users' notes as bars on the time line."""


@dataclass(frozen=True)
class RecordingRow:
    """One value of an entity.

    `time_ns` is the source's time by the clock of the recording computer, since 1970; `robot_ns` the same moment by the
    robot's own wall clock.
    """

    path: str
    time_ns: int
    robot_ns: int


@dataclass(frozen=True)
class Numbers(RecordingRow):
    """Numbers of a plot: deg, deg/s or counts."""

    values: tuple[float, ...]


@dataclass(frozen=True)
class BodyTurn(RecordingRow):
    """Orientation of a body in its parent's frame."""

    quaternion: Quaternion


@dataclass(frozen=True)
class Line(RecordingRow):
    """A line of a log."""

    text: str
    level: str
    json: str = ""
    """the event of this line as JSON; empty: the line is no event"""


@dataclass(frozen=True)
class Bar(RecordingRow):
    """A state that lasts until the next one."""

    state: str


@dataclass(frozen=True)
class Frame(RecordingRow):
    """A camera's picture."""

    jpeg: bytes


@dataclass(frozen=True)
class SoundRow(RecordingRow):
    """A block of sound from both microphones."""

    pcm: bytes
    """int16, little-endian, left and right by turns, as published"""
    rate: int
    """frames per second"""
    seq: int
    """number of the block; a gap means lost blocks"""


def of_robot(place: Place, *parts: str) -> str:
    """Return the path of an entity of one robot, for example `bea/sim/arms`."""
    return "/".join((*place, *parts))


def of_model(place: Place, body: str) -> str:
    """Return the Rerun entity path of a body of a robot's model."""
    return of_robot(place, "model", body)


def of_difference(robot: str, what: str) -> str:
    """Return the path of the difference between hardware and simulation; `what` is `arms` or `head`."""
    return f"{robot}/difference/{what}"


Say = Callable[[str], None]
"""A function that shows a sentence to the user."""


@dataclass(frozen=True)
class RobotSet:
    """The robots found so far, and those that have sent pictures or sound."""

    robots: Mapping[Place, Figure]
    with_pictures: frozenset[Place] = frozenset()
    with_sound: frozenset[Place] = frozenset()

    @property
    def names(self) -> list[str]:
        """Names of the robots, without duplicates."""
        return sorted({name for name, _ in self.robots})

    def sides(self, name: str) -> list[Place]:
        """Return the sides of one robot, the simulation first."""
        return [(name, side) for side in SIDES if (name, side) in self.robots]


class Output(Protocol):
    """A file or a viewer; used by the recorder's thread only."""

    def show(self, robots: RobotSet) -> None:
        """Set the robots of the recording."""
        ...

    def describe(self, about: About) -> None:
        """Set what the recording says of itself."""
        ...

    def write(self, rows: Sequence[RecordingRow]) -> None:
        """Add rows, which `update` writes."""
        ...

    def update(self, now_s: float) -> bool:
        """Write the rows that are due at `now_s` (monotonic clock).

        Returns True if the output has restarted and needs robots, description, poses and states again.
        """
        ...

    def close(self) -> bool:
        """Write the remaining rows and close; return False if that fails or takes too long."""
        ...
