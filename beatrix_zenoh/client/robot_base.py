"""Name, session and state of one robot."""

from __future__ import annotations

import math
import os
from enum import Enum
from typing import TYPE_CHECKING, Self

import msgspec

from beatrix_zenoh.bus import ProcessBound
from beatrix_zenoh.client import subscription
from beatrix_zenoh.client.choice import chosen_name
from beatrix_zenoh.client.degrees import Reading, RobotInfo, checked_seconds, reading, robot_info
from beatrix_zenoh.client.request import ask
from beatrix_zenoh.client.session import Client, Place
from beatrix_zenoh.client.slips import Suggesting, known_arguments, value_method
from beatrix_zenoh.client.subscription import FIRST_PICTURE_S, SILENCE_S, CameraImage, Subscription, message
from beatrix_zenoh.contract import codec, names
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import Event, Events, Info, Positions, Reason, Status
from beatrix_zenoh.contract.errors import BeatrixError, WrongUsage
from beatrix_zenoh.settings import resolve

if TYPE_CHECKING:
    from beatrix_zenoh.client.log import Log
    from beatrix_zenoh.client.sound import Microphones, Sound


class RobotStatus(Status, frozen=True, kw_only=True):
    """The message Status; it shows itself in lines, without clocks and empty fields."""

    def __repr__(self) -> str:
        fields = msgspec.structs.asdict(self)
        for name in ("robot", "side", "t_mono_ns", "t_wall_ns"):
            del fields[name]
        limit = fields.pop("speed_limit")
        lines = [f"{self.robot} ({self.side})", *_lines(fields, "  ")]
        if limit:
            lines.append(f"  speed_limit: {math.degrees(limit):.1f} °/s")
        return "\n".join(lines)


codec.prepare(RobotStatus)


def _lines(fields: dict[str, object], indent: str) -> list[str]:
    """Return one line per field, without empty fields; those of a message in the message are indented."""
    lines = []
    for name, value in fields.items():
        if isinstance(value, msgspec.Struct):
            lines += [f"{indent}{name}:", *_lines(msgspec.structs.asdict(value), indent + "  ")]
        elif isinstance(value, list) and value and isinstance(value[0], msgspec.Struct):
            for one in value:
                lines += _lines({name: one}, indent)
        elif isinstance(value, bool) or value not in ("", 0, None, []):
            shown = value.value if isinstance(value, Enum) else value
            lines.append(
                f"{indent}{name}: {shown:.4g}" if isinstance(shown, float) else f"{indent}{name}: {shown}"
            )
    return lines


class RobotBase(ProcessBound, Suggesting):
    """The readable part of a robot; `Robot` adds commands and motions."""

    @known_arguments
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
            raise WrongUsage(Reason.BAD_VALUE, f"side={side!r}: choose 'sim' or 'hw'.")
        self.side, self.timeout_s = side, checked_seconds("timeout_s", timeout_s)
        self._shared = client is not None
        self.client = Client(resolve(name, connect, who)) if client is None else client
        try:
            self.name = names.check_name(name or chosen_name(self.client))
        except BeatrixError:
            if client is None:
                self.client.close()
            raise
        self._default_speed: float | None = None
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

    @value_method
    def positions(self) -> Reading:
        """Query the current position, in degrees; raises NoAnswer with the cause if the robot does not answer."""
        key = keys.positions(self.name, self.side)
        return reading(ask(self.client, self.place, key, None, Positions, self.timeout_s))

    @value_method
    def status(self) -> RobotStatus:
        """Query the status: enabled, calibrated, holder, faults and more; raises the errors of `positions`."""
        key = keys.status(self.name, self.side)
        return ask(self.client, self.place, key, None, RobotStatus, self.timeout_s)

    @value_method
    def info(self) -> RobotInfo:
        """Query versions, limits and geometry (deg) and keys of the robot; raises the errors of `positions`."""
        key = keys.info(self.name, self.side)
        return robot_info(ask(self.client, self.place, key, None, Info, self.timeout_s))

    @value_method
    def log(self) -> Log:
        """Record positions and events from now until the end of its `with` block; then it has them as arrays.

        At most 30 minutes; older positions are dropped and counted. Raises the errors of `positions`.
        """
        from beatrix_zenoh.client.log import Log  # noqa: PLC0415 - numpy would delay every verb

        return Log(self.client, self.place, self.info())

    @value_method
    def stream(self, timeout_s: float | None = SILENCE_S) -> Subscription[Reading]:
        """Subscribe to positions in degrees, 50 per second.

        Reading raises NoAnswer if no position arrives within `timeout_s` (s); None waits for ever.
        """
        key = keys.positions(self.name, self.side)
        return Subscription(self.client, key, message(Positions, reading), timeout_s=timeout_s)

    @value_method
    def positions_stream(self, timeout_s: float | None = SILENCE_S) -> Subscription[Positions]:
        """Subscribe to positions as published (rad), with all fields; see `stream` for arguments and errors."""
        return subscription.positions(self.client, self.name, self.side, timeout_s=timeout_s)

    @value_method
    def status_stream(self, timeout_s: float | None = SILENCE_S) -> Subscription[Status]:
        """Subscribe to the status, published on change and once a second; see `stream` for arguments and errors."""
        return subscription.status(self.client, self.name, self.side, timeout_s=timeout_s)

    @value_method
    def events(self, timeout_s: float | None = None) -> Subscription[Event]:
        """Subscribe to events; see `stream` for arguments and errors."""
        return subscription.events(self.client, self.name, self.side, timeout_s=timeout_s)

    @value_method
    def camera(self, eye: str, timeout_s: float | None = FIRST_PICTURE_S) -> Subscription[CameraImage]:
        """Subscribe to the pictures of the `left` or `right` eye; the camera works only while a client subscribes.

        A simulation has a third camera, `outside`, which sees the head from the front. A slow reader gets the newest
        pictures and misses others; see `stream` for arguments and errors.
        """
        return subscription.images(self.client, self.name, self.side, eye, timeout_s=timeout_s)

    @value_method
    def microphones(self) -> Microphones:
        """Subscribe to the sound of both microphones, in blocks of 20 ms; they are on only while a client subscribes.

        Reading raises NoAnswer if no block arrives within 5 s. `faults` counts lost, duplicated and late blocks.
        """
        from beatrix_zenoh.client.sound import Microphones  # noqa: PLC0415 - numpy would delay every verb

        return Microphones(self.client, self.name, self.side)

    @value_method
    def listen(self, seconds: float = 2.0) -> Sound:
        """Listen for this time (s, at most 60), and return what both microphones have heard.

        Raises:
            NoAnswer: the robot has no microphones or does not answer.
            WrongUsage: `seconds` is not above 0, or above 60.
        """
        with self.microphones() as blocks:
            return blocks.listen(seconds)

    @value_method
    def past_events(self) -> list[Event]:
        """Query the newest events of the robot, at most 200, oldest first; raises the errors of `positions`."""
        key = keys.events(self.name, self.side)
        return ask(self.client, self.place, key, None, Events, self.timeout_s).events

    def close(self) -> None:
        """Close the session, so that the robot stops a running motion of this object; a shared session stays open."""
        if not self._shared:
            self.client.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exc: object) -> None:
        self.close()
