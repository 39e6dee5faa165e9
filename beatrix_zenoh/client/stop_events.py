"""The STOP events of a robot, which show STOP even while no motion of this program runs, and their number by seat."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

from beatrix_zenoh.client.request import Place
from beatrix_zenoh.client.robot import Robot
from beatrix_zenoh.client.robot_state import RobotState
from beatrix_zenoh.contract._generated.messages import EventKind, Reason
from beatrix_zenoh.contract.errors import Interrupted


class StopEvents:
    """A subscription to one robot's events since `since_s` (s, the robot's monotonic clock), by default from now on."""

    def __init__(self, robot: Robot, since_s: float | None = None) -> None:
        """Subscribe; without `since_s` raises NoAnswer if the robot is not on line."""
        self._robot = robot
        self._events = robot.events()
        self._since_s = robot.positions().t if since_s is None else since_s

    def check(self, when: str = "") -> None:
        """Raise Interrupted (STOPPED) if STOP was pressed; its message contains the seat and `when`."""
        for event in self._events.take():
            if event.kind is EventKind.STOP and event.t_mono_ns / 1e9 > self._since_s:
                presser = event.seat or "A client"
                raise Interrupted(Reason.STOPPED, f"{self._robot}: {presser} pressed STOP{when}.")

    def close(self) -> None:
        """End the subscription."""
        self._events.close()


class SeatStops(NamedTuple):
    """The STOPs of one seat."""

    seat: str
    """empty: unknown"""
    total: int
    robots: dict[Place, int]
    """STOPs of each robot. Its own events report them, so those of a student's simulation prove nothing."""


def stops_by_seat(robots: Iterable[RobotState]) -> list[SeatStops]:
    """Return the STOPs of all seats in the events of these robots, the most frequent seat first."""
    found: dict[str, dict[Place, int]] = {}
    for robot in robots:
        for seat, count in robot.stops:
            found.setdefault(seat, {})[robot.robot, robot.twin] = count
    stops = [SeatStops(seat, sum(counts.values()), counts) for seat, counts in found.items()]
    return sorted(stops, key=lambda one: (-one.total, one.seat))
