"""Simulated time against wall time: absolute deadlines, what is made up for and what is left out."""

from __future__ import annotations

import threading

import pytest
from stage import until

from beatrix_zenoh._generated.serial import FrameType, MoveStraight
from beatrix_zenoh.board.board import Board
from beatrix_zenoh.board.virtual import VirtualBoard
from sim_node.body import Simulation
from sim_node.clock import LATE_S, PERIOD_S, SLICE_S, STALL_S, Pace

STEP_S = 0.002


@pytest.fixture
def pace() -> Pace:
    return Pace(STEP_S, 100.0)


def test_time_keeps_to_absolute_deadlines(pace: Pace) -> None:
    turns = [100.0 + turn * PERIOD_S * 1.1 for turn in range(1, 1001)]
    steps = sum(pace.due(now_s) for now_s in turns)
    assert steps * STEP_S == pytest.approx(turns[-1] - 100.0, abs=STEP_S)
    assert pace.real_time_factor(turns[-1]) == pytest.approx(1, abs=0.001)
    assert pace.late == 0


def test_a_delay_is_made_up_for_in_slices_and_counted(pace: Pace) -> None:
    assert pace.due(100.0 + 2 * SLICE_S) == round(SLICE_S / STEP_S)
    assert pace.wait_s(100.0 + 2 * SLICE_S, resting=False) < PERIOD_S
    assert pace.due(100.0 + 2 * SLICE_S) == round(SLICE_S / STEP_S)
    assert pace.due(100.0 + 2 * SLICE_S) == 0
    assert pace.late > (SLICE_S - LATE_S) / STEP_S


@pytest.mark.parametrize(("behind_s", "host_is_late"), [(1.1 * STALL_S, False), (PERIOD_S, True)])
def test_a_stall_and_a_late_host_are_left_out(pace: Pace, *, behind_s: float, host_is_late: bool) -> None:
    assert pace.due(100.0 + behind_s, host_is_late=host_is_late) == 0
    assert pace.due(100.0 + behind_s) == 0
    assert pace.due(100.0 + behind_s + PERIOD_S) == PERIOD_S / STEP_S
    assert pace.real_time_factor(100.0 + behind_s + PERIOD_S) < 1


class ForgottenReader:
    """The simulation's port, whose reader's thread can be made to stand still."""

    name = "forgotten:"
    boot_s = 0.0

    def __init__(self, board: VirtualBoard) -> None:
        self._board = board
        self.write = board.write
        self.running = threading.Event()
        self.running.set()

    def read(self, timeout_s: float) -> bytes:
        self.running.wait(10)
        return self._board.read(timeout_s)

    def close(self) -> None:
        """The board behind stays."""


def test_a_simulation_waits_for_a_host_whose_thread_is_forgotten() -> None:
    simulation = Simulation("bea")
    virtual = simulation.open_port()
    assert isinstance(virtual, VirtualBoard)
    port = ForgottenReader(virtual)
    board = Board(lambda: port, lambda _: None, lambda: None)
    board.start()
    try:
        assert board.wait_for(lambda _: True, 5.0)
        board.enable(on=True)
        board.request(FrameType.CALIBRATE)
        board.move(MoveStraight(7, (500, 500, 500), 800))
        port.running.clear()
        until(lambda: virtual.host_is_late, "that nobody reads")
        seen: list[tuple[int, int, int]] = []

        def at_rest() -> bool:
            with virtual.lock:
                seen.append(virtual.firmware.steps())
            return len(seen) > 30 and seen[-1] == seen[-31]

        until(at_rest, "at rest")
        assert seen[-1] < (500, 500, 500)
        port.running.set()
        assert board.wait_for(lambda telemetry: telemetry.position == (500, 500, 500), 5.0)
    finally:
        port.running.set()
        board.close()
        simulation.close()
