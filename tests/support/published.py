"""The publications of a robot, message by message, as a subscriber receives them."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from typing import Generic, TypeVar

import msgspec
from late_tests import in_time
from robots import EVENT_S

from beatrix_zenoh import Robot
from beatrix_zenoh.bus import Received
from beatrix_zenoh.client.request import ask
from beatrix_zenoh.contract import codec
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import Positions, Status
from beatrix_zenoh.contract.values import values
from beatrix_zenoh.node.state import change_fields

M = TypeVar("M", bound=msgspec.Struct)
AT_ONCE_S = 0.3
"""Longest time from a change to its publication (s)."""


class Published(Generic[M]):
    """The messages published on one key from now on, in the order of arrival."""

    def __init__(self, robot: Robot, key: str, kind: type[M]) -> None:
        self.all: list[M] = []
        self.robot = robot
        self._kind = kind
        self._read_count = 0
        self._changed = threading.Condition()
        robot.client.bus.subscribe(key, self._receive)

    def _receive(self, received: Received) -> None:
        message = codec.decode(received.payload, self._kind)
        with self._changed:
            self.all.append(message)
            self._changed.notify()

    def next(self, holds: Callable[[M], bool] = lambda _: True, timeout_s: float = EVENT_S) -> M:
        """Return the next message that fulfils `holds`; later calls continue after it."""
        deadline = time.monotonic() + timeout_s
        with self._changed:
            while True:
                while self._read_count < len(self.all):
                    self._read_count += 1
                    if holds(self.all[self._read_count - 1]):
                        return self.all[self._read_count - 1]
                received = self._changed.wait(max(0.0, deadline - time.monotonic()))
                assert received, (
                    f"not published within {timeout_s} s; last of {len(self.all)}: {self.all[-1:]}"
                )


def published_positions(robot: Robot) -> Published[Positions]:
    """Subscribe to the positions of a robot; return when the first has arrived."""
    positions = Published(robot, keys.positions(robot.name, robot.side), Positions)
    positions.next()
    return positions


def published_statuses(robot: Robot) -> Published[Status]:
    """Subscribe to the statuses of a robot; return when the subscription has reached the robot."""
    statuses = Published(robot, keys.status(robot.name, robot.side), Status)
    published_positions(robot)  # a later subscription of the same session, and positions are more frequent
    return statuses


def at_once(status: Status, since_ns: float) -> None:
    """Assert that a status was published at most AT_ONCE_S after a change; the test has the mark `measures_time`."""
    in_time((status.t_mono_ns - since_ns) / 1e9, AT_ONCE_S, "publication of a change")


def regular(statuses: Published[Status]) -> Status:
    """Return a free robot's status from a publication that no change has caused.

    The next periodic publication is due a second later, so a change must have caused an earlier one.
    """
    robot = statuses.robot
    before = ask(
        robot.client, robot.place, keys.status(robot.name, robot.side), None, Status, robot.timeout_s
    )
    deadline, changed = time.monotonic() + EVENT_S, list[str]()
    while time.monotonic() < deadline:
        status = statuses.next()
        if change_fields(status) != change_fields(before):
            pairs = zip(values(status), values(before), strict=False)
            changed, before = [one.field for one, other in pairs if one != other], status
        elif status.holder == "" and status.t_mono_ns - before.t_mono_ns > AT_ONCE_S * 1e9:
            return status
    raise AssertionError(f"no status without a change within {EVENT_S} s; last changed: {', '.join(changed)}")
