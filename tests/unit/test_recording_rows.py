"""Conversion of publications to rows: numbers always, states and orientations only if they change."""

from __future__ import annotations

import math

import msgspec
import pytest
from hypothesis import given
from hypothesis import strategies as st
from statuses import BOARD, READY

from beatrix_zenoh.body.figure import Figure
from beatrix_zenoh.contract._generated.messages import (
    Event,
    EventKind,
    Fault,
    FollowState,
    Phase,
    Reason,
)
from beatrix_zenoh.recording.rows import (
    GRID_NS,
    Bar,
    BarState,
    Difference,
    Line,
    RobotRows,
    state_of,
)
from beatrix_zenoh.recording.sources import Delay, Timebase

NOW_NS = 1_763_000_000_123_456_789


def event(kind: EventKind, **fields: object) -> Event:
    """Return an event of this kind."""
    given = {"seq": 1, "t_mono_ns": 0, "t_wall_ns": NOW_NS, "kind": kind, **fields}
    return msgspec.convert(given, Event)


@pytest.fixture
def rows_of_robot() -> RobotRows:
    return RobotRows(("bea", "hw"), Figure())


@pytest.mark.parametrize(
    ("fields", "state"),
    [
        ({"enabled": False, "calibrated": False}, BarState.DISABLED),
        ({"calibrated": False}, BarState.ENABLED),
        ({}, BarState.READY),
        ({"moving": True}, BarState.MOVING),
        ({"moving": True, "following": FollowState.FOLLOWING}, BarState.FOLLOWING),
        ({"following": FollowState.PARTED}, BarState.PARTED),
        ({"following": FollowState.WAITING}, BarState.READY),
        ({"fault": Fault.EMERGENCY, "enabled": False}, BarState.EMERGENCY),
        ({"fault": Fault.ASSEMBLY_LEFT}, BarState.FAULT),
        ({"fault": Fault.BOARD_LOST}, BarState.LOST),
        ({"board": msgspec.structs.replace(BOARD, connected=False)}, BarState.LOST),
    ],
)
def test_each_status_is_converted_to_one_state(fields: dict[str, object], state: BarState) -> None:
    assert state_of(msgspec.structs.replace(READY, **fields)) is state


def test_a_robot_without_positions_is_lost_until_they_return(rows_of_robot: RobotRows) -> None:
    rows = [
        *rows_of_robot.status(READY, NOW_NS),
        *rows_of_robot.lost(NOW_NS),
        *rows_of_robot.lost(NOW_NS),
        *rows_of_robot.back(NOW_NS),
        *rows_of_robot.status(READY, NOW_NS),
    ]
    assert [row.state for row in rows if isinstance(row, Bar)] == ["ready", "lost", "ready"]


@pytest.mark.parametrize(
    ("kind", "fields", "text", "level"),
    [
        (EventKind.MOTION, {"phase": Phase.ACCEPTED, "message": "Accepted: 1.2 s."}, "ana motion pose accepted: Accepted: 1.2 s.", "INFO"),
        (EventKind.MOTION, {"phase": Phase.ACCEPTED, "reason": Reason.ARM_GAP, "message": "Too close."}, "ana motion pose refused ARM_GAP: Too close.", "WARN"),
        (EventKind.MOTION, {"phase": Phase.DONE, "reason": Reason.STOPPED, "seat": "", "message": "Stopped."}, "motion pose ended STOPPED: Stopped.", "INFO"),
        (EventKind.STOP, {"action": "STOP", "message": "At rest."}, "ana stop STOP: At rest.", "ERROR"),
        (EventKind.COMMAND, {"action": "ENABLE", "reason": Reason.EMERGENCY, "count": 3, "message": "No."}, "ana command ENABLE refused EMERGENCY (3 times): No.", "WARN"),
        (EventKind.BOARD, {"reason": Reason.BOARD_LOST, "seat": "", "action": "", "message": "Gone."}, "board BOARD_LOST: Gone.", "WARN"),
        (EventKind.LOG, {"action": "ERROR", "seat": "", "message": "Oh."}, "log ERROR: Oh.", "ERROR"),
    ],
)  # fmt: skip
def test_each_event_is_converted_to_one_line(
    rows_of_robot: RobotRows, kind: EventKind, fields: dict[str, object], text: str, level: str
) -> None:
    happened = event(kind, **{"action": "pose", "seat": "ana"} | fields)
    line = next(row for row in rows_of_robot.event(happened, NOW_NS) if isinstance(row, Line))
    assert (line.path, line.text) == ("bea/hw/events", f"02:13:20.123  bea hw:  {text}")
    assert line.level == level


# -- the difference of two robots on a grid of times, and their common time line -------------------


MS = 1_000_000
BEA = ("bea", "sim")


@given(st.lists(st.tuples(st.sampled_from(("sim", "hw")), st.integers(0, 300)), max_size=60))
def test_every_point_of_the_grid_is_returned_once_and_in_order(samples: list[tuple[str, int]]) -> None:
    difference = Difference()
    times = [time_ns for side, ms in samples for time_ns, _ in difference.add(side, ms * MS, (math.sin(ms),))]
    assert times == sorted(set(times))
    assert all(time_ns % GRID_NS == 0 for time_ns in times)


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
