"""The contents of a recording: what it says of itself and its samples as arrays."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from importlib import metadata
from typing import NamedTuple

import msgspec
import numpy as np
import numpy.typing as npt

from beatrix_zenoh.client.session import Place
from beatrix_zenoh.contract._generated import messages
from beatrix_zenoh.contract._generated.messages import Event, Info
from beatrix_zenoh.contract.publishers import NUMBERS, Order, Publishers

DISTRIBUTION = "beatrix-zenoh"


class RobotAbout(msgspec.Struct, frozen=True):
    """A robot of a recording, in its own words."""

    robot: str
    side: str
    """`hw` or `sim`"""
    version: str
    """version of beatrix-zenoh of its node"""
    contract: str
    """hash of its Zenoh messages and keys"""
    firmware: str
    """version of the firmware; empty: no board"""
    fingerprint: str
    """hash of all values of the robot file; empty: not known"""

    def __str__(self) -> str:
        firmware = f"firmware {self.firmware}" if self.firmware else "no board"
        file = f", robot file {self.fingerprint}" if self.fingerprint else ""
        return (
            f"{self.robot} ({self.side}): beatrix {self.version}, {firmware}, contract {self.contract}{file}"
        )


class About(msgspec.Struct, frozen=True):
    """A recording, as it describes itself."""

    began_ns: int
    """start of the recording by the wall clock of the recording computer, since 1970"""
    version: str = ""
    """version of beatrix-zenoh of the recorder"""
    contract: str = ""
    """hash of the Zenoh messages and keys of the recorder"""
    title: str = ""
    note: str = ""
    """what the user wrote about the recording at its start"""
    seat: str = ""
    """seat that recorded"""
    robots: tuple[RobotAbout, ...] = ()
    seats: tuple[str, ...] = ()
    """seats that have sent requests or notes, sorted"""

    def heading(self) -> str:
        """Return title, start, seat and version as a sentence."""
        began = datetime.fromtimestamp(self.began_ns / 1e9, UTC)
        by = f" by {self.seat}" if self.seat else ""
        return f"{self.title or 'Recording'}, begun {began:%Y-%m-%d %H:%M:%S} UTC{by} with beatrix {self.version}."

    def warnings(self) -> list[str]:
        """Return a sentence for each robot whose simulation and hardware have different values."""
        files: dict[str, set[str]] = {}
        for one in self.robots:
            if one.fingerprint:
                files.setdefault(one.robot, set()).add(one.fingerprint)
        return [
            f"Simulation and hardware of {name} were started with different robot files: limits or geometry differ."
            for name, found in files.items()
            if len(found) > 1
        ]

    def lines(self) -> list[str]:
        """Return these facts as sentences for people; the first names the title."""
        notes = [f"Note: {self.note}"] if self.note else []
        found = [self.heading(), *notes, *(f"{robot}." for robot in self.robots), *self.warnings()]
        return [*found, f"Requests and notes came from {', '.join(self.seats)}."] if self.seats else found

    def with_robot(self, place: Place, info: Info) -> About:
        """Return these facts with those of a robot, in place of earlier ones."""
        found = RobotAbout(*place, info.version, info.contract, info.firmware, info.fingerprint or "")
        others = [one for one in self.robots if (one.robot, one.side) != place]
        robots = sorted([*others, found], key=lambda one: (one.robot, one.side))
        return msgspec.structs.replace(self, robots=tuple(robots))

    def with_seat(self, seat: str) -> About:
        """Return these facts with a seat that takes part."""
        if not seat or seat in self.seats:
            return self
        return msgspec.structs.replace(self, seats=tuple(sorted({*self.seats, seat})))


def about(began_ns: int, *, title: str = "", note: str = "", seat: str = "") -> About:
    """Return the facts of a recording that this program begins."""
    return About(began_ns, metadata.version(DISTRIBUTION), messages.CONTRACT, title, note, seat)


Floats = npt.NDArray[np.float64]
Nanoseconds = npt.NDArray[np.int64]


def lost(numbers: Sequence[int] | Nanoseconds, repeats: Nanoseconds | None = None) -> int | None:
    """Return how many sequence numbers are missing between the first and the last; those of a restarted node begin again.

    None: any is unknown (-1), or two programs publish.

    Args:
        numbers: (n,) sequence numbers in the order of publication.
        repeats: (n,) how many publications before each were repetitions, which are no samples; None: none were left out.
    """
    order, publishers = Order(), Publishers()
    left_out = [0] * len(numbers) if repeats is None else [0, *repeats[1:].tolist()]
    for number, before in zip(map(int, numbers), left_out, strict=False):
        for published in range(number - before, number + 1):
            order.goes_back(published % NUMBERS)
        if number < 0 or publishers.several(number):
            return None
    return order.missing


@dataclass(frozen=True)
class Samples:
    """The positions of one robot in the order of time; n samples."""

    time_ns: Nanoseconds
    """(n,) source's time by the clock of the recording computer, since 1970"""
    robot_ns: Nanoseconds
    """(n,) source's time by the robot's own wall clock, its published t_wall_ns"""
    arms: Floats
    """(n, 3) short, middle, long (deg): measured in a simulation, counted on hardware"""
    commanded: Floats
    """(n, 3) the firmware's set points (deg)"""
    head: Floats
    """(n, 3) yaw, pitch, roll (deg), from the arms"""
    head_measured: Floats
    """(n, 3) the measured orientation of the head (deg); NaN: not measured"""
    velocity: Floats
    """(n, 3) velocity of the arms (deg/s)"""
    seq: Nanoseconds
    """(n,) sequence numbers; a gap that `repeats` does not explain means lost samples (`lost`); -1: unknown"""
    repeats: Nanoseconds
    """(n,) number of publications before each sample that only repeated the sample before it and are no samples of their
    own: the node had no new telemetry"""

    @property
    def lost(self) -> int | None:
        """Number of missing sequence numbers; None: not known."""
        return lost(self.seq, self.repeats)


@dataclass(frozen=True)
class TimedEvent:
    """An event of a robot, and its time (ns since 1970) by the clock of the recording computer."""

    time_ns: int
    event: Event


class Note(msgspec.Struct, frozen=True):
    """A remark that a user put into a running recording."""

    time_ns: int
    """arrival by the clock of the recording computer"""
    seat: str
    text: str


@dataclass(frozen=True)
class Recorded:
    """The contents of a recording's file."""

    robots: dict[Place, Samples]
    events: dict[Place, tuple[TimedEvent, ...]]
    """events of each robot in the order of time: what was requested, and what came of it"""
    notes: tuple[Note, ...] = ()
    about: About | None = None
    """title, versions, robots and seats; None: another program has left them out"""


class EyePicture(NamedTuple):
    """A picture of an eye, and its time (ns since 1970) by the clock of the recording computer."""

    time_ns: int
    jpeg: bytes


EyePictures = dict[tuple[str, str, str], list[EyePicture]]
"""Pictures in the order of time, by robot, side and eye."""
