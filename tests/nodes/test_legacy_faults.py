"""Faults around programs of 2023: lost router, lost board, damaged frames, programs that do not read."""

from __future__ import annotations

import contextlib
import signal
import threading
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest
import serial
from old_programs import PATIENCE_S, Place, Program
from pty_board import PtyBoard
from robots import Stage, free_endpoint, ready, until, wait_status

from beatrix_zenoh import Robot
from beatrix_zenoh import bus as zbus
from beatrix_zenoh.bus import Sessions
from beatrix_zenoh.contract._generated.messages import Command, Fault
from beatrix_zenoh.legacy import Terminal
from beatrix_zenoh.node import Node
from hw_node.body import Hardware

pytestmark = pytest.mark.bodies("hw")


def test_the_loss_of_the_router_stops_an_old_program(tmp_path: Path) -> None:
    with Stage() as stage:
        router = stage.process("beatrix_zenoh.cli", "router", "--listen", endpoint := free_endpoint())
        router.expect("ready")
        node = ("--name", "bea", "--connect", endpoint, "--legacy", str(tmp_path / "COM4"))
        stage.process("sim_node", *node).expect("ready")
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
        began_s = time.monotonic()
        assert place.robot.status().board.connected
        assert time.monotonic() - began_s < 1.0
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


def test_stop_does_not_change_the_number_of_answers(place: Place) -> None:
    with place.program() as program:
        program.begin()
        program.port.write(place.turn(600) + b"@MOVRX \xe9\r@COMSTATUS\r")
        until(place.far, "moving")
        assert place.robot.stop().result
        assert program.read(5) == ["ACK\n", "NACK\n", "NACK\n", "ACK\n", "ACK\n"]


def test_the_emergency_latch_is_the_only_reason_in_the_warning(place: Place) -> None:
    with place.program() as program:
        program.begin()
        place.robot.emergency_stop()
        assert program.say("@CALNOW") == ["ACK\n", "ACK\n"]
        assert program.say("@MOVRX 5") == ["ACK\n", "NACK\n"]
        wait_status(
            place.robot,
            lambda status: "EMERGENCY_STOP is latched" in " ".join(status.warnings),
            "the warning",
        )
        until_s = time.monotonic() + 1.0
        while time.monotonic() < until_s:
            assert "send @CALNOW first" not in " ".join(place.robot.status().warnings)
        place.robot.command(Command.RESET)
    with place.program() as program:  # a new program, because the first one stays stopped
        assert program.say("@ENMOTORS ON", 2) == ["ACK\n", "ACK\n"]
        assert program.say("@MOVRX 5") == ["ACK\n", "NACK\n"]
        wait_status(
            place.robot, lambda status: "send @CALNOW first" in " ".join(status.warnings), "the warning"
        )


def test_a_program_that_writes_motions_without_end_stays_stopped(place: Place) -> None:
    """Each motion restarts the pause of the seat, so this must be the last test on `place`."""
    with place.program() as program:
        program.begin()
        program.port.write_timeout = 0.2
        over = threading.Event()
        there_and_back = place.turn(2000) + b"@MOVHOME\r"

        def write() -> None:
            while not over.is_set():
                with contextlib.suppress(serial.SerialTimeoutException):
                    program.port.write(there_and_back)

        with ThreadPoolExecutor(1) as pool:
            writing = pool.submit(write)
            try:
                until(place.far, "moving")
                assert "rest at" in place.robot.stop().message
                until_s = time.monotonic() + 2.5
                while time.monotonic() < until_s:
                    assert not place.robot.status().moving
                assert place.robot.stop().result
            finally:
                over.set()
                writing.result(PATIENCE_S)


@pytest.fixture(scope="module")
def cut(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[PtyBoard, Path]]:
    """A board whose replies can be lost, and the port of its node for old programs."""
    folder = tmp_path_factory.mktemp("cut")
    with Stage() as stage, PtyBoard(folder / "board") as board:
        terminal = Terminal(folder / "COM4")
        sessions = Sessions(lambda: zbus.connect(stage.endpoint))
        node = Node(sessions, "bea", Hardware(str(board.path)), terminal=terminal).start()
        try:
            until(lambda: node.snapshot.status().board.connected, "found")
            yield board, folder / "COM4"
        finally:
            node.close()


@pytest.mark.parametrize(
    ("line", "lost", "answer"),
    [
        ("@COMSTATUS", 1, ["ACK\n", "ACK\n"]),
        ("@MOVRX 10 200", 1, ["ACK\n", "ACK\n"]),
        ("@MOVRX 10 200", 2, ["ACK\n", "NACK\n"]),
        ("@GETXPOS", 1, ["ACK\n", "NACK\n"]),
        ("@GETXPOS", 2, ["ACK\n", "NACK\n"]),
        ("@GETALLPOS", 3, ["ACK\n", "NACK\n"]),
        ("@GETALLPOS", 4, ["ACK\n", "NACK\n"]),
    ],
)
def test_an_answer_that_lost_lines_on_the_serial_link_has_its_full_length(
    cut: tuple[PtyBoard, Path], line: str, lost: int, answer: list[str]
) -> None:
    board, path = cut
    program = Program(path).begin()
    board.lost_text = lost
    assert program.say(line, len(answer)) == answer
    assert program.say("@GETALLPOS", 4)[::3] == ["ACK\n", "ACK\n"], "the next answer is complete"
    program.port.close()


def test_lines_to_a_lost_board_are_answered_nack_and_its_return_clears_the_zero(tmp_path: Path) -> None:
    with Stage() as stage, PtyBoard(tmp_path / "board") as board:
        sessions = Sessions(lambda: zbus.connect(stage.endpoint))
        terminal = Terminal(tmp_path / "COM4")
        node = Node(sessions, "bea", Hardware(str(tmp_path / "board")), terminal=terminal).start()
        try:
            robot: Robot = stage.robot("bea", "hw")
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
            wait_status(
                robot, lambda status: "its zero for this program" in " ".join(status.warnings), "the warning"
            )
            until(lambda: robot.status().holder == "", "free", 3.0)
            ready(robot)
            program.port.close()
        finally:
            node.close()
