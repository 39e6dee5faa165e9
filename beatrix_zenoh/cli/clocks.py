"""How far a robot's clock is from ours."""

from __future__ import annotations

import time
from typing import NamedTuple

from beatrix_zenoh._generated import keys
from beatrix_zenoh._generated.messages import Clock
from beatrix_zenoh.robot import Robot

TRIES = 20


class Offset(NamedTuple):
    """Robot's wall clock minus ours, and how wrong this can be: half the round trip; both s."""

    offset: float
    bound: float


def clock_offset(robot: Robot) -> Offset:
    """Best of 20 queries: the quickest answer bounds the error (Cristian, 1989).

    Raises:
        NoAnswer: as `Robot.status`.
    """
    return min((one_offset(robot) for _ in range(TRIES)), key=lambda found: found.bound)


def one_offset(robot: Robot) -> Offset:
    """One query: the robot is taken to have looked at its clock half-way."""
    key = keys.clock(robot.name, robot.twin)
    asked = time.time_ns()
    clock = robot.client.ask(robot.name, robot.twin, key, None, Clock, robot.timeout_s)
    heard = time.time_ns()
    return Offset((clock.t_wall_ns - (asked + heard) / 2) / 1e9, (heard - asked) / 2e9)
