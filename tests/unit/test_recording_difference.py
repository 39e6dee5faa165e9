"""The difference of two robots on a grid of times, and their common time line."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from beatrix_zenoh.recording.rows import GRID_NS, WAITING, AngleDifference, Difference
from beatrix_zenoh.recording.sources import Delay, Timebase

MS = 1_000_000
BEA = ("bea", "sim")


def fed(samples: list[tuple[str, int, float]]) -> list[AngleDifference]:
    """Return all differences of these samples: twin, time in ms, angle in deg."""
    difference = Difference()
    return [apart for side, ms, angle in samples for apart in difference.add(side, ms * MS, (angle,))]


def test_the_number_of_waiting_samples_is_bounded() -> None:
    difference = Difference()
    for index in range(10 * WAITING):
        assert not list(difference.add("sim", index * GRID_NS, (0.0,)))
    found = list(difference.add("hw", 10 * WAITING * GRID_NS, (1.0,)))
    found += difference.add("sim", 10 * WAITING * GRID_NS, (0.0,))
    assert [apart.angles for apart in found] == [(1.0,)]


@given(st.lists(st.tuples(st.sampled_from(("sim", "hw")), st.integers(0, 300)), max_size=60))
def test_every_point_of_the_grid_is_returned_once_and_in_order(samples: list[tuple[str, int]]) -> None:
    times = [apart.time_ns for apart in fed([(side, ms, math.sin(ms)) for side, ms in samples])]
    assert times == sorted(set(times))
    assert all(time_ns % GRID_NS == 0 for time_ns in times)


def test_two_computers_share_one_time_line() -> None:
    timebase = Timebase(mono_ns=1_000 * MS, wall_ns=5_000_000 * MS)
    timebase.learn(BEA, offset_ns=300 * MS, bound_ns=1 * MS)
    assert timebase.time_ns(BEA, 1_310 * MS) == 5_000_010 * MS == timebase.own_ns(1_010 * MS)


def test_a_much_less_accurate_offset_does_not_replace_an_accurate_one_at_once() -> None:
    timebase = Timebase(0, 0)
    timebase.learn(BEA, 0, 1 * MS)
    timebase.learn(BEA, 9 * MS, 10 * MS)  # a round trip delayed by other traffic
    assert timebase.time_ns(BEA, 0) == 0
    for _ in range(5):  # but clocks drift: the offset is used after some measurements
        timebase.learn(BEA, 9 * MS, 10 * MS)
    assert timebase.time_ns(BEA, 0) == -9 * MS


@pytest.mark.parametrize(
    ("mono_ms", "arrived_ms", "delay"),
    [
        (1_100, 1_002, Delay.NONE),
        (2_900, 1_002, Delay.NONE),
        (1_100, 3_500, Delay.LATE),
        (1_100, 61_000, Delay.LATE),
        (1_100, 500_000, Delay.IMPOSSIBLE),
        (9_000, 1_002, Delay.IMPOSSIBLE),
        (-(2**63) // MS, 1_002, Delay.IMPOSSIBLE),
    ],
)
def test_late_times_are_told_apart_from_impossible_ones(mono_ms: int, arrived_ms: int, delay: Delay) -> None:
    """A sample of 3 s ago may have waited in a queue; one of the future, or of an hour ago, shows another clock."""
    timebase = Timebase(0, 0)
    timebase.learn(BEA, 100 * MS, 1 * MS)
    assert timebase.delay(BEA, mono_ms * MS, arrived_ms * MS) is delay
