"""The STOP events of a robot, which show STOP even while no motion of this program runs."""

from __future__ import annotations

from beatrix_zenoh._generated.messages import EventKind, Reason
from beatrix_zenoh.client.robot import Robot
from beatrix_zenoh.errors import Interrupted


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
