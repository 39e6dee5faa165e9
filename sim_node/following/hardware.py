"""The messages of the hardware that a simulation follows."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Final

from beatrix_zenoh.bus import Received, Reply, Sessions
from beatrix_zenoh.contract import codec
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import Info, Positions, Status
from beatrix_zenoh.contract.errors import BeatrixError
from beatrix_zenoh.contract.publishers import Publishers
from sim_node.following.follower import Sample

ANSWER_S: Final = 5.0
"""Longest wait (s) for the robot file of the hardware."""


class HardwareMessages:
    """Receives positions and status of the hardware of one name; the callbacks run on Zenoh's thread."""

    def __init__(
        self, name: str, on_sample: Callable[[Sample], None], on_status: Callable[[Status], None]
    ) -> None:
        self._name, self._on_sample, self._on_status = name, on_sample, on_status
        self._ends: list[Callable[[], None]] = []
        self._publishers = Publishers()

    def open(self, sessions: Sessions) -> None:
        """Subscribe."""
        self._ends += [
            sessions.subscribe(keys.positions(self._name, "hw"), self._positions),
            sessions.subscribe(keys.status(self._name, "hw"), self._status),
        ]

    def ask_file(self, sessions: Sessions, handle: Callable[[str], None]) -> None:
        """Pass the fingerprint of the hardware's robot file to `handle`, on Zenoh's thread; empty if it has none."""

        def read(reply: Reply) -> None:
            try:
                handle(codec.decode(reply.payload, Info).fingerprint or "")
            except BeatrixError:  # an error reply, or the reply of a foreign program
                return

        bus = sessions.session(keys.KEYS["info"].session)
        query = bus.query(keys.info(self._name, "hw"), None, codec.MSGPACK, timeout_s=ANSWER_S)
        self._ends.append(query.close)
        query.hand_over(read)

    def close(self) -> None:
        """End the subscriptions and the queries."""
        for end in self._ends:
            end()
        self._ends = []

    def _positions(self, received: Received) -> None:
        try:
            positions = codec.decode(received.payload, Positions)
        except BeatrixError:  # it does not come from a node of this version
            return
        contested = self._publishers.several(positions.seq)
        self._on_sample(Sample.of(positions, time.monotonic(), contested=contested))

    def _status(self, received: Received) -> None:
        try:
            self._on_status(codec.decode(received.payload, Status))
        except BeatrixError:
            return
