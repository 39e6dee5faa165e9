"""What the recorder receives from robots: publications, and answers to queries for clocks and descriptions."""

from __future__ import annotations

import contextlib
import queue
import time
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

from beatrix_zenoh import threads
from beatrix_zenoh.client.clocks import Offset, clock_offsets
from beatrix_zenoh.client.request import ask
from beatrix_zenoh.client.session import Client, Place
from beatrix_zenoh.client.subscription import (
    Arrival,
    CameraImage,
    Subscription,
    events,
    images,
    positions,
    status,
)
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import Event, Info, Positions, Status
from beatrix_zenoh.contract._generated.robot import ROBOT, GeometryData
from beatrix_zenoh.contract.errors import BeatrixError
from beatrix_zenoh.contract.names import EYES
from beatrix_zenoh.recording.figure import geometry_of
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


AGAIN_S: Final = 30.0
"""Period of the queries: clocks of two computers drift apart by up to about 0.1 ms/s, which is 3 ms in this time."""
ANSWER_S: Final = 1.0


@dataclass(frozen=True)
class RobotAnswer:
    """Clock offset, geometry and description of a robot."""

    place: Place
    offset: Offset | None
    """offset of the robot's monotonic clock; None: the robot did not answer"""
    geometry: GeometryData
    """the default geometry if the robot did not answer"""
    info: Info | None = None
    """what the robot says of itself; None: it did not answer"""


class RobotQueries:
    """Queries each requested robot at once and then every 30 s, without blocking the recorder."""

    def __init__(self, client: Client) -> None:
        self._client = client
        self._requests: queue.SimpleQueue[Place | None] = queue.SimpleQueue()
        self._answers: queue.SimpleQueue[RobotAnswer] = queue.SimpleQueue()
        self._geometries: dict[Place, GeometryData] = {}
        self._thread = threads.start(self._run, "recorder-queries")

    def request(self, place: Place) -> None:
        """Queue a query of a robot."""
        self._requests.put(place)

    def answers(self) -> list[RobotAnswer]:
        """Return the answers since the last call."""
        found = []
        with contextlib.suppress(queue.Empty):
            while True:
                found.append(self._answers.get_nowait())
        return found

    def close(self) -> None:
        """End the thread after its running query."""
        self._requests.put(None)
        self._thread.join()

    def _run(self) -> None:
        known: set[Place] = set()
        due_s = time.monotonic() + AGAIN_S
        while True:
            try:
                place = self._requests.get(timeout=max(0.0, due_s - time.monotonic()))
            except queue.Empty:
                due_s = time.monotonic() + AGAIN_S
                for place in known:
                    self._query(place, again=True)
                continue
            if place is None:
                return
            known.add(place)
            self._query(place, again=False)

    def _query(self, place: Place, *, again: bool) -> None:
        info = None
        try:
            offset = clock_offsets(self._client, *place, timeout_s=ANSWER_S).mono
            info = ask(self._client, place, keys.info(*place), None, Info, ANSWER_S)
            if info.geometry is not None:
                self._geometries.setdefault(place, geometry_of(info.geometry))
        except BeatrixError:
            if again:  # The robot does not answer now, but its earlier values are still valid.
                return
            offset = None
        self._answers.put(RobotAnswer(place, offset, self._geometries.get(place, ROBOT.geometry), info))
