"""What can go wrong around a program of 2023: router, board, wire, and the program itself."""

from __future__ import annotations

import signal
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from itertools import count
from pathlib import Path

import pytest
import serial
from old_program import PATIENCE_S, Place, Program
from pty_board import PtyBoard
from stage import Stage, free_endpoint, ready, until, wait_status

from beatrix_zenoh import Robot
from beatrix_zenoh import bus as zbus
from beatrix_zenoh._generated.messages import Fault
from beatrix_zenoh.node import Node, Roads, Terminal
from beatrix_zenoh.node.legacy import UNANSWERED
from hw_node.body import Hardware

FAR_AHEAD = 500
"""Writes of a hundred lines: what a program without back-pressure gets rid of in a few seconds."""


def test_the_router_goes_and_an_old_program_is_stopped(tmp_path: Path) -> None:
    with Stage() as stage:
        router = stage.process("beatrix_zenoh.cli", "router", "--listen", endpoint := free_endpoint())
        router.expect("ready")
        node = ("--name", "bea", "--connect", endpoint, "--legacy", str(tmp_path / "COM4"))
        stage.process("sim_node", *node).expect("ready")
        program = Program(tmp_path / "COM4")
        program.begin()
        program.port.write(b"@MOVRALL 600 600 600\r@MOVRALL 300 300 300\r")
        assert program.read(1) == ["ACK\n"], "it moves"
        router.end(signal.SIGKILL)
        assert program.read(3) == ["NACK\n", "ACK\n", "NACK\n"]
        at = program.x
        assert program.say("@MOVRX 20 200") == ["ACK\n", "NACK\n"], "nobody could stop it"
        assert program.x == at < 500
        program.port.close()


def test_a_program_that_never_reads_holds_up_nobody(place: Place) -> None:
    with place.program() as program:
        program.begin()
        program.port.write_timeout = PATIENCE_S
        for _ in range(4000):
            program.port.write(b"@GETALLPOS\r")
        began_s = time.monotonic()
        assert place.robot.status().board.connected
        assert time.monotonic() - began_s < 1.0
        assert place.robot.stop().result
        program.port.timeout = 1.0
        answers = list(iter(program.port.readline, b""))
        assert answers[-1] in (b"ACK\n", b"NACK\n")
        assert set(answers) == {b"ACK\n", b"\n", b"0 0 0\n"} | (set(answers) & {b"NACK\n"}), "whole lines"


def test_its_stop_is_heard_behind_thousands_of_lines(place: Place) -> None:
    with place.program() as program:
        program.begin()
        program.port.write(place.turn(2000))
        until(place.far, "moving")
        program.port.write(b"@COMSTATUS\r" * 3000 + b"@STOPALL\r")
        until(lambda: not place.robot.status().moving, "it rests", 5.0)
        assert set(program.read(2 * 3002)) == {"ACK\n", "NACK\n"}
        assert abs(program.x) < 1500


def test_a_program_that_reads_gets_every_answer_however_far_it_is_ahead(place: Place) -> None:
    lines = UNANSWERED + 500
    with place.program() as program, ThreadPoolExecutor(1) as pool:
        program.begin()
        reading = pool.submit(program.read, 2 * lines + 2)
        program.port.write(place.turn(600) + b"@COMSTATUS\r" * lines)
        answers = reading.result(40.0)
        assert answers[::2] == ["ACK\n"] * (lines + 1)
        assert answers[1] == "ACK\n", "it moved"
        assert program.say("@COMSTATUS") == ["ACK\n", "ACK\n"], "in step"


def test_stop_leaves_an_answer_as_long_as_it_is(place: Place) -> None:
    with place.program() as program:
        program.begin()
        program.port.write(place.turn(600) + b"@MOVRX \xe9\r@COMSTATUS\r")
        until(place.far, "moving")
        assert place.robot.stop().result
        assert program.read(5) == ["ACK\n", "NACK\n", "NACK\n", "ACK\n", "ACK\n"]


def test_a_refusal_is_explained_by_its_true_reason_only(place: Place) -> None:
    with place.program() as program:
        program.begin()
        place.robot.emergency_stop()
        assert program.say("@CALNOW") == ["ACK\n", "ACK\n"]
        assert program.say("@MOVRX 5") == ["ACK\n", "NACK\n"]
        wait_status(
            place.robot, lambda status: "after an emergency stop" in " ".join(status.warnings), "told"
        )
        until_s = time.monotonic() + 1.0
        while time.monotonic() < until_s:
            assert "@CALNOW must come" not in " ".join(place.robot.status().warnings)
        place.robot.enable()
        assert program.say("@ENMOTORS ON", 2) == ["ACK\n", "ACK\n"]
        assert program.say("@MOVRX 5") == ["ACK\n", "NACK\n"]
        wait_status(place.robot, lambda status: "@CALNOW must come" in " ".join(status.warnings), "told")


def test_a_program_that_writes_moves_without_end_is_stopped_and_stays_stopped(place: Place) -> None:
    """It never reads, and is thousands of lines ahead; each of its lines is another try, so its pause does not end (last of these for that)."""
    with place.program() as program:
        program.begin()
        program.port.write_timeout = 0.2
        over, far_ahead = threading.Event(), threading.Event()
        there_and_back = (place.turn(2000) + b"@MOVHOME\r") * 50

        def write() -> None:
            for number in count():
                if over.is_set():
                    return
                try:
                    program.port.write(there_and_back)
                except serial.SerialTimeoutException:
                    far_ahead.set()
                if number == FAR_AHEAD:
                    far_ahead.set()

        with ThreadPoolExecutor(1) as pool:
            writing = pool.submit(write)
            try:
                until(place.far, "moving")
                assert far_ahead.wait(PATIENCE_S)
                assert "rest at" in place.robot.stop().message
                until_s = time.monotonic() + 2.5
                while time.monotonic() < until_s:
                    assert not place.robot.status().moving
                assert place.robot.stop().result
            finally:
                over.set()
                writing.result(PATIENCE_S)


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
def test_an_answer_that_the_wire_has_cut_is_whole_for_the_program(
    tmp_path: Path, line: str, lost: int, answer: list[str]
) -> None:
    with Stage() as stage, PtyBoard(tmp_path / "board") as board:
        arguments = ("--port", str(board.path), "--legacy", str(tmp_path / "COM4"))
        stage.process("hw_node", "--name", "bea", "--connect", stage.endpoint, *arguments).expect("ready")
        until(lambda: stage.robot("bea", "hw").status().board.connected, "found")
        program = Program(tmp_path / "COM4").begin()
        board.lost_text = lost
        assert program.say(line, len(answer)) == answer
        assert program.say("@GETALLPOS", 4)[::3] == ["ACK\n", "ACK\n"], "the next is whole again"
        program.port.close()


def test_a_board_that_is_lost_answers_nack_and_its_return_is_a_power_up(tmp_path: Path) -> None:
    with Stage() as stage, PtyBoard(tmp_path / "board") as board:
        roads = Roads.open(lambda: zbus.connect(stage.endpoint))
        node = Node(roads, "bea", Hardware(str(tmp_path / "board")), terminal=Terminal(tmp_path / "COM4"))
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
                robot, lambda status: "its zero for this program" in " ".join(status.warnings), "told"
            )
            until(lambda: robot.status().holder == "", "free", 3.0)
            ready(robot)
            program.port.close()
        finally:
            node.close()
