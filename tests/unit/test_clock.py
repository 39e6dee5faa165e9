"""Simulated time and wall time: absolute deadlines, delays and stalls."""

from __future__ import annotations

import pytest

from sim_node.body import LATE_S, PERIOD_S, SLICE_S, STALL_S, StepClock

STEP_S = 0.002


@pytest.fixture
def clock() -> StepClock:
    return StepClock(STEP_S, 100.0)


def test_steps_follow_absolute_deadlines(clock: StepClock) -> None:
    turns = [100.0 + turn * PERIOD_S * 1.1 for turn in range(1, 1001)]
    steps = sum(clock.due(now_s) for now_s in turns)
    assert steps * STEP_S == pytest.approx(turns[-1] - 100.0, abs=STEP_S)
    assert clock.real_time_factor(turns[-1]) == pytest.approx(1, abs=0.001)
    assert clock.late == 0


def test_a_delay_is_made_up_in_slices_and_counted(clock: StepClock) -> None:
    assert clock.due(100.0 + 2 * SLICE_S) == round(SLICE_S / STEP_S)
    assert clock.wait_s(100.0 + 2 * SLICE_S) < PERIOD_S
    assert clock.due(100.0 + 2 * SLICE_S) == round(SLICE_S / STEP_S)
    assert clock.due(100.0 + 2 * SLICE_S) == 0
    assert clock.late > (SLICE_S - LATE_S) / STEP_S


@pytest.mark.parametrize(("behind_s", "host_is_late"), [(1.1 * STALL_S, False), (PERIOD_S, True)])
def test_simulated_time_does_not_advance_in_a_stall_or_for_a_late_host(
    clock: StepClock, *, behind_s: float, host_is_late: bool
) -> None:
    assert clock.due(100.0 + behind_s, host_is_late=host_is_late) == 0
    assert clock.due(100.0 + behind_s) == 0
    assert clock.due(100.0 + behind_s + PERIOD_S) == PERIOD_S / STEP_S
    assert clock.real_time_factor(100.0 + behind_s + PERIOD_S) < 1
