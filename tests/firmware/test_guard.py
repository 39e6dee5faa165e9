"""The firmware has the last word: no limit is crossed, whatever is asked for and when."""

from __future__ import annotations

import ctypes
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from rig import ARM_SPACING, GAP_MIN, ROOT, SPEED_MAX, YAW_SUM_MAX, Rig, Steps, least_gap

from beatrix_zenoh._generated.serial import Error, FrameType, Outcome, State

TARGETS = st.one_of(
    st.tuples(*[st.integers(-900, 900)] * 3),
    st.builds(lambda c, d: (c + d, c, c + d // 2), st.integers(-2300, 2300), st.integers(-1058, 1058)),
)
SPEEDS = st.tuples(*[st.integers(200, SPEED_MAX)] * 3)
MOVES = st.tuples(TARGETS, SPEEDS, st.booleans(), st.integers(1, 600), st.integers(0, 9))


@settings(max_examples=25)
@given(st.lists(MOVES, min_size=2, max_size=10))
def test_no_limit_is_ever_crossed(script: list[tuple[Steps, Steps, bool, int, int]]) -> None:
    rig = Rig().ready()
    for target, speed, straight, ms, dice in script:
        rig.move(target, speed, straight=straight)
        if dice == 0:
            rig.ask(FrameType.STOP)
        for tick in range(ms):
            if tick % 400 == 0:
                rig.ask(FrameType.PING)
            rig.tick()
            assert least_gap(rig.steps) >= GAP_MIN
            assert abs(sum(rig.steps)) <= YAW_SUM_MAX


def test_arms_that_would_meet_on_the_way_are_stopped_in_time(ready: Rig) -> None:
    assert ready.move((1500, 1500, 1500), (SPEED_MAX, 400, SPEED_MAX)) == Error.OK
    ready.run()
    assert ready.outcome == Outcome.GAP
    assert ready.state == State.ENABLED | State.CALIBRATED
    assert GAP_MIN <= least_gap(ready.steps) <= GAP_MIN + 3


def test_a_turn_that_would_go_too_far_on_the_way_is_stopped_in_time(ready: Rig) -> None:
    assert ready.move((2300, 2300, 2300)) == Error.OK
    ready.run()
    assert ready.move((1900, 2500, 2500), SPEED_MAX) == Error.OK
    ready.run()
    assert ready.outcome == Outcome.YAW
    assert YAW_SUM_MAX - 300 <= sum(ready.steps) <= YAW_SUM_MAX


def test_the_way_back_from_a_limit_is_open(ready: Rig) -> None:
    ready.move((1500, 1500, 1500), (SPEED_MAX, 400, SPEED_MAX))
    ready.run()
    assert ready.move((0, 0, 0), straight=True) == Error.OK
    ready.run()
    assert (ready.steps, ready.outcome) == ((0, 0, 0), Outcome.DONE)


@pytest.mark.parametrize("target", [(529, -529, 0), (1058, 0, 529), (0, 529, -529), (2324, 2325, 2325)])
def test_a_target_on_the_limit_is_reached(ready: Rig, target: Steps) -> None:
    assert ready.move(target, straight=True) == Error.OK
    ready.run()
    assert (ready.steps, ready.outcome) == (target, Outcome.DONE)


def test_a_straight_motion_near_the_limit_can_be_replaced(ready: Rig) -> None:
    # From the line with its slow arm to full ramps for all would end too close: braked first, then done.
    for ms in range(100, 1200, 37):
        ready.move((0, 0, 0), straight=True)
        ready.run()
        assert ready.move((1200, 250, 700), straight=True) == Error.OK
        ready.tick(ms)
        assert ready.move((-100, 0, 100), straight=True) == Error.OK
        while State.MOVING in ready.state:
            ready.tick()
            assert least_gap(ready.steps) >= GAP_MIN
            if len(ready.telemetry) % 40 == 0:
                ready.ask(FrameType.PING)
        assert ready.outcome == Outcome.DONE


@pytest.fixture(scope="module")
def first_tick(
    build: Callable[..., Path], tmp_path_factory: pytest.TempPathFactory
) -> Callable[[Steps, Steps], int]:
    """The guard's verdict on the first tick from any place, allowed or not, to any other."""
    build("host", "g++")
    library = tmp_path_factory.mktemp("probe") / "probe.so"
    core = [ROOT / f"firmware/core/{name}.cpp" for name in ("axis", "guard")]
    probe = Path(__file__).with_name("probe.cpp")
    subprocess.run(
        [
            "g++",
            "-shared",
            "-fPIC",
            "-std=gnu++11",
            "-I",
            ROOT / "firmware/core",
            probe,
            *core,
            "-o",
            library,
        ],
        check=True,
    )
    guard = ctypes.CDLL(str(library)).guard_first_tick
    triple = ctypes.c_int32 * 3
    return lambda start, target: int(guard(triple(*start), triple(*target)))


TOO_CLOSE = (ARM_SPACING - GAP_MIN + 50, 0, 0)
TOO_FAR = (2400, 2400, 2400)


@pytest.mark.parametrize(
    ("start", "target", "verdict"),
    [
        (TOO_CLOSE, (0, 0, 0), Outcome.NONE),
        (TOO_CLOSE, (TOO_CLOSE[0], 100, 0), Outcome.NONE),
        (TOO_CLOSE, (TOO_CLOSE[0] + 1, 0, 0), Outcome.GAP),
        (TOO_CLOSE, (TOO_CLOSE[0], -1, 0), Outcome.GAP),
        (TOO_FAR, (0, 0, 0), Outcome.NONE),
        (TOO_FAR, (2401, 2400, 2400), Outcome.YAW),
        ((-2400, -2400, -2400), (0, 0, 0), Outcome.NONE),
        ((-2400, -2400, -2400), (-2400, -2401, -2400), Outcome.YAW),
        ((0, 0, 0), (10, -10, 5), Outcome.NONE),
    ],
)
def test_from_beyond_a_limit_only_the_way_back_is_open(
    first_tick: Callable[[Steps, Steps], int], start: Steps, target: Steps, verdict: Outcome
) -> None:
    assert first_tick(start, target) == verdict
