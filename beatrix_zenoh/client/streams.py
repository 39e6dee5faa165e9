"""Subscriptions to publications of one robot, or of many with `*` as a name."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, TypeVar

from beatrix_zenoh.client.request import Place
from beatrix_zenoh.client.session import Client
from beatrix_zenoh.client.subscription import Subscription, message
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import Event, Positions, Reason, Status
from beatrix_zenoh.contract.errors import NoAnswer

if TYPE_CHECKING:
    from beatrix_zenoh.client.robot_base import RobotBase

SILENCE_S = 3.0
"""A robot without publications for this long (s) hangs or is lost, because it publishes its status once a second."""

T = TypeVar("T")


def same(value: T) -> T:
    """Return the message unchanged."""
    return value


def positions(
    client: Client, robot: str = "*", twin: str = "*", *, timeout_s: float | None = SILENCE_S
) -> Subscription[Positions]:
    """Subscribe to positions (rad); reading raises NoAnswer if none arrives for `timeout_s` (s), with None never."""
    return Subscription(client, keys.positions(robot, twin), message(Positions, same), timeout_s=timeout_s)


def status(
    client: Client, robot: str = "*", twin: str = "*", *, timeout_s: float | None = SILENCE_S
) -> Subscription[Status]:
    """Subscribe to status, on change and once a second; see `positions` for arguments and errors."""
    return Subscription(client, keys.status(robot, twin), message(Status, same), timeout_s=timeout_s)


def events(
    client: Client, robot: str = "*", twin: str = "*", *, timeout_s: float | None = None
) -> Subscription[Event]:
    """Subscribe to events; see `positions` for arguments and errors."""
    return Subscription(client, keys.events(robot, twin), message(Event, same), timeout_s=timeout_s)


def follow_events(robots: Sequence[RobotBase], past: int) -> Iterator[tuple[Place, Event]]:
    """Yield the last `past` events of robots of one name, oldest first, then each new event.

    Args:
        robots: simulation, hardware or both, of one client.
        past: number of earlier events to begin with.

    Raises:
        NoAnswer: a robot is not on line, or is lost meanwhile.
    """
    first = robots[0]
    twin = first.twin if len(robots) == 1 else "*"
    with events(first.client, first.name, twin, timeout_s=SILENCE_S) as coming:
        before = [(robot.place, event) for robot in robots for event in robot.past_events()]
        # An event that is published during the query for past events arrives twice; `known` drops the second.
        known = {(place, event.t_mono_ns, event.seq) for place, event in before}
        before.sort(key=lambda row: row[1].t_wall_ns)
        yield from before[max(0, len(before) - past) :]
        while True:
            try:
                arrival = coming.next_arrival()
            except NoAnswer as error:
                if error.reason is not Reason.TIMED_OUT:
                    raise
                for robot in robots:  # `status` raises NoAnswer if the robot is lost
                    robot.status()
                continue
            place = arrival.robot, arrival.twin
            if (place, arrival.value.t_mono_ns, arrival.value.seq) not in known:
                yield place, arrival.value
