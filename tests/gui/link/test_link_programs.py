"""The link of the window: programs of Python as child processes."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from gui_links import Linked, look, rests, short
from present import present
from robots import END_S, Stage, until

from beatrix_zenoh.contract._generated.messages import Reason
from gui.console.link.programs import LINES
from gui.console.state.actions import EndProgram, Play, RunProgram, Send, SendStop

START_S = 60.0
TURNS = """
import math, time
from beatrix_zenoh import Robot
with Robot() as robot:
    begin = time.monotonic()
    while True:
        robot.look(yaw=20 * math.sin(time.monotonic() - begin), wait=False)
        time.sleep(0.04)
"""
"""A program that turns the head to and fro until it is ended."""


@pytest.fixture
def own(tmp_path: Path) -> Path:
    """The file of a program that turns the head."""
    file = tmp_path / "turns.py"
    file.write_text(TURNS, encoding="utf-8")
    return file


def turning(linked: Linked, row: int, own: Path) -> None:
    """Start the program, and wait until the simulation turns."""
    linked.do(RunProgram(row, own))
    assert linked.world.program.runs(own)
    linked.until(lambda world: abs(short(world, "sim")) > 3, "the head turns", START_S)


def test_the_user_ends_the_program(linked: Linked, own: Path) -> None:
    turning(linked, 3, own)
    linked.do(EndProgram())
    assert linked.end_of(3).accepted
    world = linked.until(lambda world: rests(world, "sim"), "the head rests")
    assert not world.program.running


@pytest.mark.long("starts the program three times")
def test_a_newer_motion_or_play_replaces_the_program(linked: Linked, own: Path) -> None:
    turning(linked, 1, own)
    linked.do(Send(2, look(-30), ("sim",)))
    assert linked.end_of(2, "sim").accepted
    assert linked.end_of(1).reason is Reason.REPLACED
    assert short(linked.world, "sim") == pytest.approx(-30, abs=0.2)
    turning(linked, 3, own)
    linked.do(Play(4, ("sim",), gesture="no"))
    assert linked.end_of(3).reason is Reason.REPLACED
    assert linked.end_of(4, "sim").accepted
    assert short(linked.world, "sim") == pytest.approx(0, abs=0.2)


def test_stop_of_another_seat_ends_the_program_and_names_the_seat(
    stage: Stage, linked: Linked, own: Path
) -> None:
    turning(linked, 1, own)
    with Linked(stage.endpoint, who="ben") as other:
        other.online("sim")
        other.do(SendStop(1))
        assert other.end_of(1, "sim").accepted
        end = linked.end_of(1)
    linked.until(lambda world: rests(world, "sim"), "the head rests")
    assert (end.reason, end.detail and end.detail.presser) == (Reason.STOPPED, "ben")


ENDS = (
    ("import sys\nprint(sys.argv[1:])", Reason.OK, "", 0, ("['sim']",)),
    ("def f():\n    raise ValueError('no')\n\nf()", Reason.BAD_VALUE, "result.program_failed", 2, None),
    ("print(1", Reason.BAD_VALUE, "result.program_failed", 1, None),
    ("print(1)\ninput()", Reason.BAD_VALUE, "result.no_keyboard", 2, None),
    ("for i in range(5000):\n    print(i)", Reason.OK, "", 0, tuple(map(str, range(5001 - LINES, 5000)))),
    ("print('ä', end='')", Reason.OK, "", 0, ("ä",)),
    ("\nfrom beatrix_zenoh import Robot\nRobot().look(yaw=500)", Reason.YAW_LIMIT, "", 3, ()),
    ("from beatrix_zenoh import Robot\nRobot('absent').positions()", Reason.NO_SUCH_ROBOT, "", 2, ()),
)
"""Programs; the reason, the text and the line with which they end, and the begin of their output."""


@pytest.mark.long("starts eight programs")
def test_a_program_ends_with_a_reason_its_line_and_its_output(linked: Linked, own: Path) -> None:
    for row, (text, reason, key, line, output) in enumerate(ENDS):
        own.write_text(text, encoding="utf-8")
        linked.do(RunProgram(row, own, ("sim",)))
        end = linked.end_of(row, timeout_s=START_S)
        seen = linked.world.program
        assert (end.accepted, end.reason, end.key, seen.line) == (reason is Reason.OK, reason, key, line)
        assert output is None or seen.output[: len(output) or None] == output


IGNORES = """
import signal, subprocess, sys
signal.signal(signal.SIGTERM, signal.SIG_IGN)
print(subprocess.Popen([sys.executable, "-c", "print('ready', flush=True); import time; time.sleep(99)"]).pid)
while True:
    pass
"""


def test_stop_ends_a_program_that_does_not_want_to_and_what_it_has_started(linked: Linked, own: Path) -> None:
    own.write_text(IGNORES, encoding="utf-8")
    linked.do(RunProgram(1, own))
    linked.until(lambda world: "ready" in world.program.output, "the program runs", START_S)
    linked.do(SendStop(2))
    assert linked.end_of(1, timeout_s=2.0).reason is Reason.STOPPED
    started = next(line for line in linked.world.program.output if line.isdigit())
    until(lambda: not runs(int(started)), "its child is gone")


def runs(process: int) -> bool:
    """Return whether a process does anything; one that has ended may not have been reaped yet."""
    command = Path(f"/proc/{process}/cmdline")
    return command.exists() and bool(command.read_bytes())


def test_the_program_ends_when_its_parent_is_killed(tmp_path: Path) -> None:
    program = tmp_path / "waits.py"
    program.write_text("import time\nprint('ready', flush=True)\ntime.sleep(100)", encoding="utf-8")
    command = [sys.executable, "-m", "beatrix_zenoh.cli", "--with-parent", "--program", str(program)]
    child = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE)
    with child:
        assert present(child.stdout).readline() == b"ready\n"
        present(child.stdin).close()  # as the end of the parent does
        assert child.wait(END_S) != 0
