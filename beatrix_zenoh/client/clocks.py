"""Offsets between a robot's clocks and those of this computer."""

from __future__ import annotations

import time
from typing import NamedTuple

from beatrix_zenoh.client.request import ask
from beatrix_zenoh.client.session import Client
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import Clock

TRIES = 20


class Offset(NamedTuple):
    """A robot's clock minus this computer's (s), and the largest possible error (s), which is half the round trip."""

    offset: float
    bound: float

    @property
    def certain(self) -> float:
        """The offset, or 0 if 0 is within its error, as for two programs on one computer, which share a clock."""
        return 0.0 if abs(self.offset) <= self.bound else self.offset

    @property
    def offset_ns(self) -> int:
        """The offset in ns."""
        return round(self.offset * 1e9)

    @property
    def bound_ns(self) -> int:
        """The largest error in ns."""
        return round(self.bound * 1e9)


class Offsets(NamedTuple):
    """Offsets of both clocks of a robot, wall clock and monotonic clock."""

    wall: Offset
    mono: Offset


def clock_offsets(
    client: Client, robot: str, side: str, *, timeout_s: float = 2.0, tries: int = TRIES
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
