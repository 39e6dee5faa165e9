"""Faults around programs of 2023: lost router, lost board, damaged frames, programs that do not read."""

from __future__ import annotations

import signal
from pathlib import Path

import pytest
from old_programs import PATIENCE_S, Place, Program
from pty_board import PtyBoard
from robots import Stage, free_endpoint, ready, until, wait_status

from beatrix_zenoh.contract._generated.messages import Fault
from beatrix_zenoh.legacy import Terminal
from hw_node.body import Hardware

pytestmark = pytest.mark.bodies("hw")


def test_the_loss_of_the_router_stops_an_old_program(alone: Stage, tmp_path: Path) -> None:
    router = alone.process("beatrix_zenoh.cli", "router", "--listen", endpoint := free_endpoint())
    router.expect("ready")
    node = ("--name", "bea", "--connect", endpoint, "--legacy", str(tmp_path / "COM4"))
    alone.process("hw_node", *node, "--port", "virtual:").expect("ready")
    program = Program(tmp_path / "COM4")
    program.begin()
    program.port.write(b"@MOVRALL 600 600 600\r@MOVRALL 300 300 300\r")
    assert program.read(1) == ["ACK\n"], "the robot moves"
    router.end(signal.SIGKILL)
    assert program.read(3) == ["NACK\n", "ACK\n", "NACK\n"]
    at = program.x
    assert program.say("@MOVRX 20 200") == ["ACK\n", "NACK\n"], "no client could stop it"
    assert program.x == at < 500
    program.port.close()


def test_a_program_that_never_reads_delays_no_client(place: Place) -> None:
    with place.program() as program:
        program.begin()
        program.port.write_timeout = PATIENCE_S
        for _ in range(400):
            program.port.write(b"@GETALLPOS\r")
        assert place.robot.status().board.connected
        assert place.robot.stop().result
        program.port.timeout = 1.0
        answers = list(iter(program.port.readline, b""))
        assert answers[-1] in (b"ACK\n", b"NACK\n")
        assert set(answers) == {b"ACK\n", b"\n", b"0 0 0\n"} | (set(answers) & {b"NACK\n"}), "whole lines"


def test_stopall_is_carried_out_before_hundreds_of_waiting_lines(place: Place) -> None:
    with place.program() as program:
        program.begin()
        program.port.write(place.turn(2000))
        until(place.far, "moving")
        program.port.write(b"@COMSTATUS\r" * 300 + b"@STOPALL\r")
        until(lambda: not place.robot.status().moving, "it rests", 5.0)
        assert set(program.read(2 * 302)) == {"ACK\n", "NACK\n"}
        assert abs(program.x) < 1500
        assert program.say("@COMSTATUS") == ["ACK\n", "ACK\n"], "every line was answered"


@pytest.mark.long("waits for a board to return")
def test_lines_to_a_lost_board_are_answered_nack_and_its_return_clears_the_zero(
    alone: Stage, tmp_path: Path
) -> None:
    with PtyBoard(tmp_path / "board") as board:
        hardware, terminal = Hardware(str(tmp_path / "board")), Terminal(tmp_path / "COM4")
        alone.node("bea", hardware, terminal=terminal)
        robot = alone.robot("bea", "hw")
        wait_status(robot, lambda status: status.board.connected, "board there")
        program = Program(tmp_path / "COM4").begin()
        program.port.write(b"@MOVRALL 600 600 600\r@MOVRX 5 5\r")
        until(lambda: robot.status().moving, "moving")
        board.unplug()
        assert program.read(4) == ["ACK\n", "NACK\n"] * 2
        assert program.say("@COMSTATUS") == ["ACK\n", "NACK\n"]
        wait_status(robot, lambda status: status.fault is Fault.BOARD_LOST, "lost")
        board.plug()
        wait_status(robot, lambda status: status.board.connected, "back")
        assert program.say("@COMSTATUS") == ["ACK\n", "ACK\n"]
        assert program.say("@MOVRX 5 5") == ["ACK\n", "NACK\n"]
        wait_status(robot, lambda status: "need @CALNOW" in " ".join(status.warnings), "the warning")
        until(lambda: robot.status().holder == "", "free")
        ready(robot)
        program.port.close()
        alone.end_nodes()  # before its board
