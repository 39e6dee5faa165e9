"""The messages that a simulation follows, as foreign programs may publish them."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import cast

import msgpack
import msgspec
import pytest
from msgspec.structs import replace
from statuses import AT_HOME, READY

from beatrix_zenoh.bus import Received, Sessions
from beatrix_zenoh.contract import codec
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import Status
from sim_node.following.follower import HardwareSample
from sim_node.following.robots import HardwareMessages

POSITIONS, STATUS = keys.positions("bea", "hw"), keys.status("bea", "hw")


class Foreign:
    """A program that publishes for a simulation, without a network."""

    def __init__(self) -> None:
        self.samples: list[HardwareSample] = []
        self.statuses: list[Status] = []
        self._handlers: dict[str, Callable[[Received], None]] = {}
        messages = HardwareMessages("bea", self.samples.append, self.statuses.append)
        messages.open(cast("Sessions", self))

    def subscribe(self, key: str, handle: Callable[[Received], None]) -> Callable[[], None]:
        self._handlers[key] = handle
        return lambda: None

    def publish(self, key: str, payload: bytes) -> None:
        self._handlers[key](Received(key, payload, "", None))


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf, 1e300, "north", None])
@pytest.mark.parametrize("field", ["position", "velocity", "commanded"])
def test_positions_that_are_no_numbers_are_not_followed(field: str, value: object) -> None:
    foreign = Foreign()
    message = msgspec.to_builtins(AT_HOME)
    message[field]["y"] = value
    foreign.publish(POSITIONS, msgpack.packb(message))
    message["t_mono_ns"] = value
    foreign.publish(POSITIONS, msgpack.packb(message))
    foreign.publish(POSITIONS, b"\xc1")
    assert foreign.samples == []
    foreign.publish(POSITIONS, codec.encode(AT_HOME))
    assert [sample.commanded.place for sample in foreign.samples] == [(0.0, 0.0, 0.0)]


def test_a_foreign_status_that_cannot_be_read_changes_nothing() -> None:
    foreign = Foreign()
    foreign.publish(STATUS, b"{}")
    assert foreign.statuses == []
    foreign.publish(STATUS, codec.encode(READY))
    assert foreign.statuses == [READY]


def test_each_sample_says_whether_two_programs_publish() -> None:
    foreign = Foreign()
    for seq in (1, 2, 3, 500, 4, 501, 5, 502, 6, 503):
        foreign.publish(POSITIONS, codec.encode(replace(AT_HOME, seq=seq)))
    assert not any(sample.contested for sample in foreign.samples[:4])
    assert foreign.samples[-1].contested
