"""A simulation that follows: its decisions, and what it says when hardware and simulation part."""

from __future__ import annotations

import math

import pytest
from msgspec.structs import replace
from statuses import AT_HOME, BOARD, READY

from beatrix_zenoh.contract._generated.messages import FollowState, Head, Status
from beatrix_zenoh.contract._generated.robot import ROBOT
from beatrix_zenoh.motion.gear import Arms
from beatrix_zenoh.motion.limits import MotionLimits
from beatrix_zenoh.node.planner import vector
from sim_node.following.follower import (
    LASTS_S,
    NO_SET_POINTS,
    NO_STATUS,
    RETRY_S,
    SILENT_S,
    Follower,
    HardwareSample,
    Parting,
    Places,
    SetPoint,
    Step,
)

LIMITS = MotionLimits(ROBOT)
REST: Arms = (0.0, 0.0, 0.0)


def deg(*angles: float) -> Arms:
    x, y, z = map(math.radians, angles)
    return x, y, z


def sample(at_s: float, place: float) -> HardwareSample:
    """Return positions of the hardware, all arms at one angle (deg), at `at_s`; its clock is 1000 s ahead."""
    arms = deg(place, place, place)
    message = replace(
        AT_HOME,
        t_mono_ns=round((at_s + 1000) * 1e9),
        position=vector(arms),
        commanded=vector(arms),
        head=Head(arms[0], 0.0, 0.0),
    )
    return HardwareSample.of(message, at_s)


def status(*, enabled: bool = True, calibrated: bool = True, connected: bool = True) -> Status:
    board = replace(BOARD, connected=connected)
    return replace(READY, enabled=enabled, calibrated=calibrated, board=board)


def step(follower: Follower, at_s: float, hardware: float, own: float = 0.0) -> Step | None:
    """Let the hardware publish its place (deg), and return the step of a simulation that is elsewhere."""
    follower.hear(sample(at_s, hardware))
    return follower.step(at_s, SetPoint(deg(own, own, own), REST), LIMITS)


@pytest.fixture
def follower() -> Follower:
    """A follower that has reached the hardware at home, at 10 s."""
    made = Follower(9.9)
    made.hear_status(status())
    assert step(made, 10.0, 0.0) is not None
    assert made.state(10.0) is FollowState.FOLLOWING
    return made


def test_it_waits_for_a_status_before_it_trusts_set_points() -> None:
    new = Follower(0.0)
    assert new.waits_for(0.1) == NO_STATUS
    assert step(new, 0.2, 40.0) is None
    assert new.state(0.2) is FollowState.WAITING
    new.hear_status(status())
    assert step(new, 0.2, 40.0) is not None


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
    assert step(follower, 10.02, 30.0) is None
    assert follower.state(10.02) is FollowState.WAITING
    assert words in follower.warnings(10.02)[0]


def test_it_waits_when_the_hardware_is_silent_and_trusts_it_again_after_its_next_status(
    follower: Follower,
) -> None:
    later = 10.0 + SILENT_S + 0.1
    assert follower.warnings(later) == [NO_SET_POINTS]
    follower.hold()
    assert step(follower, later, 20.0) is None
    assert follower.waits_for(later) == NO_STATUS
    follower.hear_status(status())
    again = step(follower, later, 20.0)
    assert again is not None
    assert again.straight
    assert follower.state(later) is FollowState.APPROACHING


def test_a_jump_of_the_set_point_is_reached_on_a_checked_path_at_the_default_speed(
    follower: Follower,
) -> None:
    jump = step(follower, 10.02, 40.0)
    assert jump is not None
    assert jump.straight
    assert jump.course.target == pytest.approx(deg(40, 40, 40))
    assert jump.course.speed == pytest.approx((LIMITS.default_speed,) * 3)
    follower.accepted()
    assert step(follower, 10.12, 40.0, own=1.0) is None, "the path still leads there"
    near = step(follower, 10.5, 40.0, own=38.0)
    assert near is not None
    assert not near.straight
    assert follower.state(10.5) is FollowState.FOLLOWING


def test_a_refused_path_is_reported_and_planned_again_later(follower: Follower) -> None:
    assert step(follower, 10.02, 40.0) is not None
    follower.refused(10.02, "The head would lean 40.0°.")
    assert follower.state(10.02) is FollowState.WAITING
    assert "40.0°" in follower.warnings(10.02)[0]
    assert step(follower, 10.2, 40.0) is None
    again = 10.02 + RETRY_S
    for at_s in (10.5, 10.8):
        follower.hear(sample(at_s, 40.0))
    assert step(follower, again, 40.0) is not None
    follower.accepted()
    assert follower.state(again) is FollowState.APPROACHING


# -- parting -------------------------------------------------------------------------------------


def places(*arms: float, velocity: float = 0.0, head: float | None = None) -> Places:
    each = deg(*(arms if len(arms) == 3 else arms * 3))
    yaw = sum(each) / 3 if head is None else math.radians(head)
    return Places(each, deg(velocity, velocity, velocity), (yaw, 0.0, 0.0))


def parted(simulation: Places, hardware: Places) -> str:
    """Return the text after the places have differed for LASTS_S; it ends when they have agreed for as long."""
    parting = Parting()
    parting.compare(0.1, simulation, hardware)
    assert not parting.text, "one sample is no parting"
    parting.compare(0.1 + LASTS_S, simulation, hardware)
    text = parting.text
    for again in range(3):
        parting.compare(1.0 + LASTS_S * (1 + again), simulation, simulation)
    assert not parting.text
    return text


@pytest.mark.parametrize(
    ("simulation", "hardware", "words"),
    [
        (places(10), places(10), ""),
        (places(10.0), places(10.4), ""),
        (places(10.0, velocity=60), places(15.0, velocity=60), ""),
        (places(10, 0, 0), places(-10, 0, 0), "the short arm of the hardware is 20.0° away"),
        (places(10, 10, 10), places(10, 10, 9.3), "the long arm of the hardware is 0.7° away"),
        (places(10), places(10, head=15), "their heads are 5.0° apart"),
        (places(1.0, head=179.9), places(1.0, head=-179.9), ""),
    ],
)
def test_the_ways_to_part(simulation: Places, hardware: Places, words: str) -> None:
    text = parted(simulation, hardware)
    assert words in text
    assert bool(text) == bool(words)
