"""The recorder's subscriptions: bounded queues that drop the oldest publications and count them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from beatrix_zenoh.client.session import Client
from beatrix_zenoh.client.subscription import (
    Arrival,
    CameraImage,
    Subscription,
    events,
    images,
    positions,
    status,
)
from beatrix_zenoh.contract._generated.messages import Event, Positions, Status
from beatrix_zenoh.contract.names import EYES
from beatrix_zenoh.recording.losses import Stream, stream_of_key

Value = Positions | Status | Event | CameraImage
PICTURES: Final = 64
"""Length of the queue of one camera: about 5 MB."""


class RobotSubscriptions:
    """Subscriptions to all robots, or to those with given names.

    Zenoh's threads only enqueue undecoded publications. Each queue is bounded: 3000 publications of each kind, 64
    pictures of each camera.
    """

    def __init__(self, client: Client, names: Sequence[str], *, cameras: bool) -> None:
        """Subscribe to the robots of these names, or to all robots if no name is given.

        With `cameras`, robots capture pictures for this recorder.
        """
        self._subscriptions: list[
            Subscription[Positions] | Subscription[Status] | Subscription[Event] | Subscription[CameraImage]
        ] = []
        for name in names or ["*"]:
            self._subscriptions += [
                status(client, name, timeout_s=None),
                events(client, name),
                positions(client, name, timeout_s=None),
            ]
            if cameras:
                self._subscriptions += [
                    images(client, name, "*", eye, timeout_s=None, length=PICTURES) for eye in EYES
                ]

    def take(self) -> list[Arrival[Value]]:
        """Return all publications since the last call, in the order of arrival."""
        arrivals: list[Arrival[Value]] = [
            arrival for subscription in self._subscriptions for arrival in subscription.take_arrivals()
        ]
        return sorted(arrivals, key=lambda arrival: arrival.t_mono_ns)

    @property
    def dropped(self) -> dict[Stream, int]:
        """Number of publications of each stream that were dropped because they were not taken in time."""
        found: dict[Stream, int] = {}
        for subscription in self._subscriptions:
            for key, dropped in subscription.dropped_keys.items():
                if (stream := stream_of_key(key)) is not None:
                    found[stream] = found.get(stream, 0) + dropped
        return found

    def close(self) -> None:
        """End the subscriptions."""
        for subscription in self._subscriptions:
            subscription.close()
