"""Name, session, state and clocks of one robot, and the room of its simulation."""

from __future__ import annotations

import os
import time
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from beatrix_zenoh.bus import ProcessBound
from beatrix_zenoh.client import subscription
from beatrix_zenoh.client.degrees import (
    Reading,
    RobotInfo,
    checked_number,
    checked_place,
    checked_seconds,
    reading,
    robot_info,
)
from beatrix_zenoh.client.request import A, M, accepted, ask
from beatrix_zenoh.client.session import Client, Closable, Place, chosen_name
from beatrix_zenoh.client.slips import Suggesting
from beatrix_zenoh.client.subscription import FIRST_PICTURE_S, SILENCE_S, CameraImage, Subscription, message
from beatrix_zenoh.contract import codec, names
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import (
    Clock,
    Event,
    Events,
    Info,
    Positions,
    SoundQuery,
    SoundReply,
    Status,
    TargetQuery,
    TargetReply,
)
from beatrix_zenoh.contract.errors import BeatrixError, wrong_usage
from beatrix_zenoh.contract.rows import KeyRow
from beatrix_zenoh.contract.values import values
from beatrix_zenoh.settings import resolve

if TYPE_CHECKING:
    from beatrix_zenoh.client.log import Log
    from beatrix_zenoh.client.sound import Microphones, Sound

CLOCK_TRIES = 20


class RobotStatus(Status, frozen=True, kw_only=True):
    """The message Status; it shows itself in lines, without clocks and empty fields."""

    def __repr__(self) -> str:
        lines = [f"{self.robot} ({self.side})"]
        for one in values(self):
            if one.group not in ("robot", "clocks") and (
                isinstance(one.value, bool) or one.value not in ("", 0, None, [])
            ):
                shown = one.value if isinstance(one.value, bool) else one.text()
                lines.append(f"  {one.field}: {shown}")
        return "\n".join(lines)


codec.prepare(RobotStatus)


class RobotBase(ProcessBound, Closable, Suggesting):
    """The readable part of a robot; `Robot` adds commands and motions."""

    def __init__(
        self,
        name: str | None = None,
        side: str | None = None,
        *,
        connect: str | None = None,
        who: str | None = None,
        timeout_s: float = 2.0,
        client: Client | None = None,
    ) -> None:
        side = side or os.environ.get("BEATRIX_SIDE") or "sim"
        if side not in names.SIDES:
            raise wrong_usage(f"side={side!r}: choose 'sim' or 'hw'.")
        self.side, self.timeout_s = side, checked_seconds("timeout_s", timeout_s)
        self._shared = client is not None
        self.client = Client(resolve(name, connect, who)) if client is None else client
        try:
            self.name = names.check_name(name or chosen_name(self.client))
        except BeatrixError:
            if client is None:
                self.client.close()
            raise
        given = os.environ.get("BEATRIX_LEASE", "")
        self.given_lease = int(given) if given.isdecimal() else 0
        """Number of the lease that the program which started this one has taken, as `beatrix lesson turn` does; 0: none"""
        self.lease_number = self.given_lease
        """Number of the lease under which this object sends its motions; 0: none"""

    def __str__(self) -> str:
        return f"{self.name} ({self.side})"

    def __repr__(self) -> str:
        return f"<robot {self} at {self.client.bus.endpoint}>"

    @property
    def place(self) -> Place:
        """Name and side of the robot."""
        return self.name, self.side

    def _read(self, row: KeyRow, kind: type[M]) -> M:
        return ask(self.client, self.place, row(*self.place), None, kind, self.timeout_s)

    def positions(self) -> Reading:
        """Query the current position, in degrees; raises NoAnswer with the cause if the robot does not answer."""
        return reading(self._read(keys.positions, Positions))

    def status(self) -> RobotStatus:
        """Query the status: enabled, calibrated, holder, faults and more; raises NoAnswer as `positions`."""
        return self._read(keys.status, RobotStatus)

    def info(self) -> RobotInfo:
        """Query versions, limits and geometry (deg) and keys of the robot; raises NoAnswer as `positions`."""
        return robot_info(self._read(keys.info, Info))

    def log(self) -> Log:
        """Record positions and events from now until the end of its `with` block; then it has them as arrays.

        At most 30 minutes; older positions are dropped and counted. Raises NoAnswer as `positions`.
        """
        from beatrix_zenoh.client.log import Log  # noqa: PLC0415 - numpy would delay every verb

        return Log(self.client, self.place, self.info())

    def stream(self, timeout_s: float | None = SILENCE_S) -> Subscription[Reading]:
        """Subscribe to positions in degrees, 50 per second.

        Reading raises NoAnswer if no position arrives within `timeout_s` (s); None waits for ever.
        """
        key = keys.positions(self.name, self.side)
        return Subscription(self.client, key, message(Positions, reading), timeout_s=timeout_s)

    def positions_stream(self, timeout_s: float | None = SILENCE_S) -> Subscription[Positions]:
        """Subscribe to positions as published (rad), with all fields; see `stream` for arguments and errors."""
        return subscription.positions(self.client, self.name, self.side, timeout_s=timeout_s)

    def status_stream(self, timeout_s: float | None = SILENCE_S) -> Subscription[Status]:
        """Subscribe to the status, published on change and once a second; see `stream` for arguments and errors."""
        return subscription.status(self.client, self.name, self.side, timeout_s=timeout_s)

    def events(self, timeout_s: float | None = None) -> Subscription[Event]:
        """Subscribe to events; see `stream` for arguments and errors."""
        return subscription.events(self.client, self.name, self.side, timeout_s=timeout_s)

    def camera(self, eye: str, timeout_s: float | None = FIRST_PICTURE_S) -> Subscription[CameraImage]:
        """Subscribe to the pictures of the `left` or `right` eye; the camera works only while a client subscribes.

        A simulation has a third camera, `outside`, which sees the head from the front. A slow reader gets the newest
        pictures and misses others; see `stream` for arguments and errors.
        """
        return subscription.images(self.client, self.name, self.side, eye, timeout_s=timeout_s)

    def microphones(self) -> Microphones:
        """Subscribe to the sound of both microphones, in blocks of 20 ms; they are on only while a client subscribes.

        Reading raises NoAnswer if no block arrives within 5 s. `faults` counts lost, duplicated and late blocks.
        """
        from beatrix_zenoh.client.sound import Microphones  # noqa: PLC0415 - numpy would delay every verb

        return Microphones(self.client, self.name, self.side)

    def listen(self, seconds: float = 2.0) -> Sound:
        """Listen for this time (s, at most 60), and return what both microphones have heard.

        Raises:
            NoAnswer: the robot has no microphones or does not answer.
            WrongUsage: `seconds` is not above 0, or above 60.
        """
        with self.microphones() as blocks:
            return blocks.listen(seconds)

    def past_events(self) -> list[Event]:
        """Query the newest events of the robot, at most 200, oldest first; raises NoAnswer as `positions`."""
        return self._read(keys.events, Events).events

    def close(self) -> None:
        """Close the session, so that the robot stops a running motion of this object; a shared session stays open."""
        if not self._shared:
            self.client.close()


class RobotWithRoom(RobotBase):
    """The part of a robot that changes the room of its simulation; hardware has none.

    x (forward), y (left) and z (up) are distances (m) from the neck's centre.
    """

    def target(self) -> TargetReply:
        """Return the place (m) of the simulated person in front of the robot: the middle between the eyes."""
        return self._ask_room(keys.target, None, TargetReply)

    def move_target(self, x: float, y: float, z: float) -> TargetReply:
        """Place the middle between the eyes of the simulated person, and end the person's own path.

        Raises Refused for a place outside the room.
        """
        x, y, z = checked_place(x, y, z)
        return self._ask_room(keys.target, TargetQuery(x=x, y=y, z=z), TargetReply)

    def walk_target(self, path: str = "sway", period_s: float = 12.0) -> TargetReply:
        """Let the simulated person walk a path from its beginning: `sway`, `circle`, or `still` to stand in front.

        `period_s` is the time (s) for once there and back, from 2 to 600. Raises Refused for another path or period.
        """
        query = TargetQuery(path=path, period_s=checked_number("period_s", period_s, "s"))
        return self._ask_room(keys.target, query, TargetReply)

    def place_sound(
        self, x: float | None = None, y: float | None = None, z: float | None = None
    ) -> SoundReply:
        """Place the source of sound in the simulated room; without a place, in the mouth of the simulated person.

        Raises Refused for a place outside the room or inside the head.
        """
        if x is None and y is None and z is None:
            return self._ask_room(keys.sound, SoundQuery(mouth=True), SoundReply)
        if x is None or y is None or z is None:
            raise wrong_usage("A place needs x, y and z (m); without any, it is the mouth.")
        x, y, z = checked_place(x, y, z)
        return self._ask_room(keys.sound, SoundQuery(x=x, y=y, z=z), SoundReply)

    def play_sound(self, sound: str | Path = "voice", seconds: float | None = None) -> SoundReply:
        """Play a sound in the simulated room, in place of the last one; returns at once.

        Args:
            sound: `clap` (one a second), `voice`, `noise`, `silence`, or the path of a WAV file.
            seconds: how long (s, at most 60); a shorter sound is repeated. By default 3 s, and a file once.

        Raises:
            Refused: BAD_VALUE: there is no such sound, or `seconds` is not allowed.
            WrongUsage: BAD_VALUE: the file cannot be read, has another format, or lasts longer than 10 s.
        """
        lasts_s = 0.0 if seconds is None else checked_seconds("seconds", seconds)
        path = Path(sound)
        if path.suffix.lower() != ".wav":
            return self._ask_room(keys.sound, SoundQuery(play=str(sound), seconds=lasts_s), SoundReply)
        from beatrix_zenoh.client.sound import mono  # noqa: PLC0415 - numpy would delay every verb

        query = SoundQuery(play="samples", seconds=lasts_s)
        return self._ask_room(keys.sound, query, SoundReply, mono(path))

    def _ask_room(
        self, row: KeyRow, query: TargetQuery | SoundQuery | None, kind: type[A], samples: bytes | None = None
    ) -> A:
        place = (self.name, "sim")
        return accepted(ask(self.client, place, row(self.name), query, kind, self.timeout_s, samples))


class Offset(NamedTuple):
    """A robot's clock minus this computer's (s), and the largest possible error (s), which is half the round trip."""

    offset: float
    bound: float

    @property
    def certain(self) -> float:
        """The offset, or 0 if 0 is within its error, as for two programs on one computer, which share a clock."""
        return 0.0 if abs(self.offset) <= self.bound else self.offset


class Offsets(NamedTuple):
    """Offsets of both clocks of a robot, wall clock and monotonic clock."""

    wall: Offset
    mono: Offset


def clock_offsets(
    client: Client, robot: str, side: str, *, timeout_s: float = 2.0, tries: int = CLOCK_TRIES
) -> Offsets:
    """Return the offsets of the fastest of several round trips, which has the smallest error (Cristian, 1989).

    One round trip takes 0.4 ms on loopback.

    Args:
        client: the session.
        robot: name of the robot.
        side: `sim` or `hw`.
        timeout_s: time limit of each reply (s).
        tries: number of round trips.

    Raises:
        NoAnswer: as `Robot.status`.
    """
    return min(
        (_round_trip(client, robot, side, timeout_s) for _ in range(tries)),
        key=lambda found: found.wall.bound,
    )


def offset_of(robot: RobotBase) -> Offset:
    """Return the offset of the robot's monotonic clock from this computer's."""
    return clock_offsets(robot.client, *robot.place, timeout_s=robot.timeout_s).mono


def _round_trip(client: Client, robot: str, side: str, timeout_s: float) -> Offsets:
    """Return the offsets from one query, assuming that the robot reads its clocks half-way between query and reply."""
    key = keys.clock(robot, side)
    asked_wall, asked_mono = time.time_ns(), time.monotonic_ns()
    clock = ask(client, (robot, side), key, None, Clock, timeout_s)
    heard_mono, heard_wall = time.monotonic_ns(), time.time_ns()
    bound = (heard_mono - asked_mono) / 2e9
    wall = Offset((2 * clock.t_wall_ns - asked_wall - heard_wall) / 2e9, bound)
    mono = Offset((2 * clock.t_mono_ns - asked_mono - heard_mono) / 2e9, bound)
    return Offsets(wall, mono)
