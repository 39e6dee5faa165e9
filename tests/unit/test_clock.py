"""Simulated time and wall time: absolute deadlines, delays and stalls."""

from __future__ import annotations

import threading

import pytest
from robots import until
from threaded_board import ThreadedPort

from beatrix_zenoh.board.board import Board
from beatrix_zenoh.board.state import NO_TELEMETRY, TimedPort
from beatrix_zenoh.contract._generated.serial import FrameType, MoveStraight
from sim_node.body import LATE_S, PERIOD_S, SLICE_S, STALL_S, Simulation, StepClock

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


class BlockedReader:
    """The port of the simulation; a test can block the thread that reads from it."""

    name = "blocked:"
    boot_s = 0.0

    def __init__(self, port: TimedPort) -> None:
        self._port = ThreadedPort(port)
        self.write, self.wake = port.write, port.wake
        self.running = threading.Event()
        self.running.set()

    def read(self, timeout_s: float) -> bytes:
        self.running.wait(10)
        return self._port.read(timeout_s)

    def close(self) -> None:
        """Keep the board open."""


def test_the_simulation_waits_while_the_reading_thread_is_blocked() -> None:
    simulation = Simulation("bea")
    port, virtual = BlockedReader(simulation.timed_port()), simulation._board
    board = Board(lambda: port, lambda _: None, lambda: None)
    board.start()
    try:
        assert board.wait_for(lambda _: True, 5.0)
        board.enable(on=True)
        board.request(FrameType.CALIBRATE)
        board.move(MoveStraight(7, (500, 500, 500), 800))
        port.running.clear()
        seen: list[tuple[int, int, int]] = []

        def late() -> bool:
            seen.append(
                simulation.pose(NO_TELEMETRY, 0).steps
            )  # as the publisher does, which makes the due steps
            return virtual.host_is_late

        def at_rest() -> bool:
            late()
            return len(seen) > 30 and seen[-1] == seen[-31]

        until(late, "the host is late")
        until(at_rest, "at rest")
        assert seen[-1] < (500, 500, 500)
        port.running.set()
        assert board.wait_for(lambda telemetry: telemetry.position == (500, 500, 500), 5.0)
    finally:
        port.running.set()
        board.close()
        simulation.close()
