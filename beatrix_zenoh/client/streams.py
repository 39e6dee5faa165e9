"""Subscriptions to publications of one robot, or of many with `*` as a name."""

from __future__ import annotations

from typing import TypeVar

from beatrix_zenoh.client.session import Client
from beatrix_zenoh.client.subscription import Subscription, message
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import Event, Positions, Status

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
