"""A simulation that follows: its decisions, and what it says when hardware and simulation part."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import cast

import msgpack
import msgspec
import pytest
from msgspec.structs import replace
from statuses import AT_HOME, BOARD, READY

from beatrix_zenoh.bus import Received, Sessions
from beatrix_zenoh.contract import codec
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import FollowState, Head, Status
from beatrix_zenoh.motion.gear import Arms
from beatrix_zenoh.node.planner import vector
from sim_node.following.follower import (
    CONTESTED,
    LASTS_S,
    NO_SET_POINTS,
    NO_STATUS,
    RETRY_S,
    SILENT_S,
    UNKNOWN_S,
    Follower,
    HardwareSample,
    Limits,
    Parting,
    Places,
    SetPoint,
)
from sim_node.following.robots import HardwareMessages

LIMITS = Limits(math.radians(30), math.radians(90), math.radians(180))
REST: Arms = (0.0, 0.0, 0.0)
UPRIGHT = Places(REST, REST, REST)


def deg(*angles: float) -> Arms:
    x, y, z = map(math.radians, angles)
    return x, y, z


def sample(
    at_s: float, *place: float, velocity: float = 0.0, delay_s: float = 0.0, position: float | None = None
) -> HardwareSample:
    """Return positions (deg, deg/s) of the hardware that are true at `at_s`; its clock is 1000 s ahead."""
    arms = deg(*place) if len(place) == 3 else deg(*(place or (0.0,)) * 3)
    there = arms if position is None else deg(position, position, position)
    message = replace(
        AT_HOME,
        t_mono_ns=round((at_s + 1000) * 1e9),
        position=vector(there),
        velocity=vector(deg(velocity, velocity, velocity)),
        commanded=vector(arms),
        head=Head(sum(there) / 3, 0.0, 0.0),
    )
    return HardwareSample.of(message, at_s + delay_s)


def status(*, enabled: bool = True, calibrated: bool = True, connected: bool = True) -> Status:
    board = replace(BOARD, connected=connected)
    return replace(READY, enabled=enabled, calibrated=calibrated, board=board)


@pytest.fixture
def follower() -> Follower:
    """A follower that has reached the hardware at home, at 10 s."""
    made = Follower(9.9)
    made.hear_status(status())
    made.hear(sample(10.0))
    assert made.step(10.0, SetPoint(REST, REST), LIMITS) is not None
    assert made.state(10.0) is FollowState.FOLLOWING
    return made


def test_it_waits_for_a_status_before_it_trusts_set_points() -> None:
    new = Follower(0.0)
    assert new.waits_for(0.1) == NO_STATUS
    new.hear(sample(0.2, 40.0))
    assert new.step(0.2, SetPoint(REST, REST), LIMITS) is None
    assert new.state(0.2) is FollowState.WAITING
    for tenth in range(3, math.ceil(10 * UNKNOWN_S) + 2):
        new.hear(sample(tenth / 10, 40.0))
    assert new.step(tenth / 10, SetPoint(REST, REST), LIMITS) is not None, (
        "a robot without a status is followed"
    )


@pytest.mark.parametrize(
    ("unready", "words"),
    [
        (status(enabled=False, calibrated=False), "motors of the hardware are off"),
        (status(calibrated=False), "not calibrated"),
        (status(connected=False), "board of the hardware is not connected"),
    ],
)
def test_it_holds_its_place_while_the_hardware_is_not_ready(
    follower: Follower, unready: Status, words: str
) -> None:
    follower.hear_status(unready)
    follower.hear(sample(10.02, 30.0))
    assert follower.step(10.02, SetPoint(REST, REST), LIMITS) is None
    assert follower.state(10.02) is FollowState.WAITING
    assert words in follower.warnings(10.02)[0]


def test_it_waits_when_the_hardware_is_silent_and_trusts_it_again_after_its_next_status(
    follower: Follower,
) -> None:
    later = 10.0 + SILENT_S + 0.1
    assert follower.warnings(later) == [NO_SET_POINTS]
    follower.hold()
    assert follower.hear(sample(later, 20.0))
    assert follower.waits_for(later) == NO_STATUS
    follower.hear_status(status())
    step = follower.step(later, SetPoint(REST, REST), LIMITS)
    assert step is not None
    assert step.straight
    assert follower.state(later) is FollowState.APPROACHING


def test_it_holds_its_place_while_two_programs_publish_and_trusts_the_next_status(follower: Follower) -> None:
    follower.hear(sample(10.02, 5.0)._replace(contested=True))
    assert follower.step(10.02, SetPoint(REST, REST), LIMITS) is None
    assert follower.state(10.02) is FollowState.WAITING
    assert follower.warnings(10.02) == [CONTESTED]
    assert not follower.hear(sample(10.04, 0.0)._replace(contested=True))
    assert follower.hear(sample(10.06, 5.0)), "which of them has remained is not known"
    assert follower.waits_for(10.06) == NO_STATUS
    follower.hear_status(status())
    assert follower.step(10.06, SetPoint(REST, REST), LIMITS) is not None


def test_a_jump_of_the_set_point_is_reached_on_a_checked_path_at_the_default_speed(
    follower: Follower,
) -> None:
    follower.hear(sample(10.02, 40.0))
    step = follower.step(10.02, SetPoint(REST, REST), LIMITS)
    assert step is not None
    assert step.straight
    assert step.course.target == pytest.approx(deg(40, 40, 40))
    assert step.course.speed == pytest.approx((LIMITS.speed_default,) * 3)
    follower.accepted()
    follower.hear(sample(10.12, 40.0))
    assert follower.step(10.12, SetPoint(deg(1, 1, 1), REST), LIMITS) is None, "the path still leads there"
    follower.hear(sample(10.5, 40.0))
    near = follower.step(10.5, SetPoint(deg(38, 38, 38), REST), LIMITS)
    assert near is not None
    assert not near.straight
    assert follower.state(10.5) is FollowState.FOLLOWING


def test_a_refused_path_is_reported_and_planned_again_later(follower: Follower) -> None:
    follower.hear(sample(10.02, 40.0))
    assert follower.step(10.02, SetPoint(REST, REST), LIMITS) is not None
    follower.refused(10.02, "The head would lean 40.0°.")
    assert follower.state(10.02) is FollowState.WAITING
    assert "40.0°" in follower.warnings(10.02)[0]
    follower.hear(sample(10.2, 40.0))
    assert follower.step(10.2, SetPoint(REST, REST), LIMITS) is None
    again = 10.02 + RETRY_S
    for at_s in (10.5, 10.8, again):
        follower.hear(sample(at_s, 40.0))
    assert follower.step(again, SetPoint(REST, REST), LIMITS) is not None
    follower.accepted()
    assert follower.state(again) is FollowState.APPROACHING


# -- parting -------------------------------------------------------------------------------------


def places(*arms: float, velocity: float = 0.0, head: float | None = None) -> Places:
    each = deg(*(arms if len(arms) == 3 else arms * 3))
    yaw = sum(each) / 3 if head is None else math.radians(head)
    return Places(each, deg(velocity, velocity, velocity), (yaw, 0.0, 0.0))


def parted(simulation: Places, hardware: Places) -> str:
    """Return the text after the places have differed for LASTS_S, from an agreement at home."""
    parting = Parting()
    parting.compare(0.0, UPRIGHT, UPRIGHT)
    parting.compare(0.1, simulation, hardware)
    assert not parting.text, "one sample is no parting"
    parting.compare(0.1 + LASTS_S, simulation, hardware)
    return parting.text


@pytest.mark.parametrize(
    ("simulation", "hardware", "words"),
    [
        (places(10), places(10), ""),
        (places(10.0), places(10.4), ""),
        (places(10.0, velocity=60), places(15.0, velocity=60), ""),
        (
            places(10, 0, 0),
            places(-10, 0, 0),
            "the short arm of the hardware turns the other way, 20.0° away",
        ),
        (places(0, 10, 0), places(0, 0, 0), "the middle arm of the hardware stands still, 10.0° away"),
        (places(10, 10, 10), places(10, 10, 9.3), "the long arm of the hardware is 0.7° away"),
        (places(10), places(10, head=15), "their heads are 5.0° apart"),
        (places(1.0, head=179.9), places(1.0, head=-179.9), ""),
    ],
)
def test_the_ways_to_part(simulation: Places, hardware: Places, words: str) -> None:
    text = parted(simulation, hardware)
    assert words in text
    assert bool(text) == bool(words)


def test_a_parting_ends_when_the_places_agree_again() -> None:
    parting = Parting()
    for tenth in range(8):
        parting.compare(tenth / 10, places(10), places(5))
    assert parting.text
    for tenth in range(8, 16):
        parting.compare(tenth / 10, places(10), places(10))
    assert not parting.text


# -- the messages that a simulation follows, as foreign programs may publish them ------------------


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
