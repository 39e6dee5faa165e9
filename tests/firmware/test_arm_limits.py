"""Limits of the firmware: no sequence of requests crosses them."""

from __future__ import annotations

import ctypes
import shutil
import subprocess
from pathlib import Path

import pytest
from firmware_host import ARM_SPACING, GAP_MIN, ROOT, SPEED_MAX, YAW_SUM_MAX, Rig, Steps, least_gap
from hypothesis import given, settings
from hypothesis import strategies as st

from beatrix_zenoh.contract._generated.serial import BoardOutcome, BoardState, Error, FrameType

CORE = ROOT / "firmware/beatrix/src/core"
TARGETS = st.one_of(
    st.tuples(*[st.integers(-900, 900)] * 3),
    st.builds(lambda c, d: (c + d, c, c + d // 2), st.integers(-2300, 2300), st.integers(-1058, 1058)),
)
SPEEDS = st.tuples(*[st.integers(200, SPEED_MAX)] * 3)
MOVES = st.tuples(TARGETS, SPEEDS, st.booleans(), st.integers(1, 600), st.integers(0, 9))


@settings(max_examples=8)
@given(st.lists(MOVES, min_size=2, max_size=10))
def test_no_sequence_of_moves_crosses_a_limit(script: list[tuple[Steps, Steps, bool, int, int]]) -> None:
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


def test_arms_that_come_too_close_on_their_path_are_stopped(ready: Rig) -> None:
    assert ready.move((1500, 1500, 1500), (SPEED_MAX, 400, SPEED_MAX)) == Error.OK
    ready.run()
    assert ready.outcome == BoardOutcome.GAP
    assert ready.state == BoardState.ENABLED | BoardState.CALIBRATED
    assert GAP_MIN <= least_gap(ready.steps) <= GAP_MIN + 3


def test_arms_that_turn_too_far_on_their_path_are_stopped(ready: Rig) -> None:
    assert ready.move((2300, 2300, 2300)) == Error.OK
    ready.run()
    assert ready.move((1900, 2500, 2500), SPEED_MAX) == Error.OK
    ready.run()
    assert ready.outcome == BoardOutcome.YAW
    assert YAW_SUM_MAX - 300 <= sum(ready.steps) <= YAW_SUM_MAX


@pytest.fixture(scope="module")
def probe(tmp_path_factory: pytest.TempPathFactory) -> ctypes.CDLL:
    """The core and probe.cpp as a library."""
    if shutil.which("g++") is None:
        pytest.skip("g++ is not installed: apt-get install g++")
    library = tmp_path_factory.mktemp("probe") / "probe.so"
    core = [CORE / f"{name}.cpp" for name in ("axis", "limits", "motion", "fixed_point")]
    source = Path(__file__).with_name("probe.cpp")
    options = ["-shared", "-fPIC", "-O2", "-std=gnu++11", "-I", str(CORE)]
    subprocess.run(["g++", *options, source, *core, "-o", library], check=True)
    return ctypes.CDLL(str(library))


@pytest.mark.parametrize(
    "seed", [0, *(pytest.param(n, marks=pytest.mark.long("millions of ticks")) for n in range(1, 4))]
)
def test_no_limit_is_crossed_in_millions_of_ticks_close_to_the_limits(probe: ctypes.CDLL, seed: int) -> None:
    life = ctypes.c_int64 * 5
    seen = life()
    probe.live(seed, 15_000, seen)
    ticks, crossed, steep, trips, missed = seen
    assert ticks > 5_000_000
    assert trips > 100
    assert (crossed, steep, missed) == (0, 0, 0)


TOO_CLOSE = (ARM_SPACING - GAP_MIN + 50, 0, 0)
TOO_FAR = (2400, 2400, 2400)


@pytest.mark.parametrize(
    ("start", "target", "verdict"),
    [
        (TOO_CLOSE, (0, 0, 0), BoardOutcome.NONE),
        (TOO_CLOSE, (TOO_CLOSE[0], 100, 0), BoardOutcome.NONE),
        (TOO_CLOSE, (TOO_CLOSE[0] + 1, 0, 0), BoardOutcome.GAP),
        (TOO_CLOSE, (TOO_CLOSE[0], -1, 0), BoardOutcome.GAP),
        (TOO_FAR, (0, 0, 0), BoardOutcome.NONE),
        (TOO_FAR, (2401, 2400, 2400), BoardOutcome.YAW),
        ((-2400, -2400, -2400), (0, 0, 0), BoardOutcome.NONE),
        ((-2400, -2400, -2400), (-2400, -2401, -2400), BoardOutcome.YAW),
        ((0, 0, 0), (10, -10, 5), BoardOutcome.NONE),
    ],
)
def test_from_beyond_a_limit_only_motions_back_are_allowed(
    probe: ctypes.CDLL, start: Steps, target: Steps, verdict: BoardOutcome
) -> None:
    triple = ctypes.c_int32 * 3
    assert probe.check_first_tick(triple(*start), triple(*target)) == verdict
