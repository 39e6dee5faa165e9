"""The link of the window: gestures, and the program that follows a face, as a child process."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from gui_links import Linked, look, rests, short
from present import present
from robots import END_S, Stage

from beatrix_zenoh.contract._generated.messages import Reason
from gui.console.link.programs import SHIPPED
from gui.console.state.actions import EndFollowing, FollowFace, Play, Send, SendStop, WriteFile

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
"""A program of a user that turns the head to and fro until it is ended; it needs no eye."""

FAILED = "result.program_failed"


@pytest.fixture(autouse=True)
def own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The file of the user's own program, in a home folder of this test; it does not exist yet."""
    monkeypatch.setenv("HOME", str(tmp_path))
    return tmp_path / "beatrix-programs/follow_the_face.py"


def write(own: Path, text: str) -> None:
    own.parent.mkdir()
    own.write_text(text, encoding="utf-8")


def turning(linked: Linked, row: int) -> None:
    """Start the user's program, and wait until the simulation turns."""
    linked.do(FollowFace(row, ("sim",)))
    assert linked.world.face.running
    linked.until(lambda world: abs(short(world, "sim")) > 3, "the head turns", START_S)


def test_the_program_is_copied_once_and_then_it_is_the_one_that_runs(linked: Linked, own: Path) -> None:
    assert (linked.world.face.file, linked.world.face.own_file, linked.world.face.own) == (
        SHIPPED,
        own,
        False,
    )
    linked.do(WriteFile(1, own, SHIPPED))
    assert linked.end_of(1).accepted
    assert own.read_text(encoding="utf-8") == SHIPPED.read_text(encoding="utf-8")
    assert linked.world.face.own
    own.write_text(TURNS, encoding="utf-8")
    linked.do(WriteFile(2, own, SHIPPED))
    assert linked.end_of(2).accepted
    assert own.read_text(encoding="utf-8") == TURNS
    turning(linked, 3)
    linked.do(EndFollowing())
    assert linked.end_of(3).accepted
    world = linked.until(lambda world: rests(world, "sim"), "the head rests")
    assert not world.face.running


@pytest.mark.long("starts the program three times")
def test_a_newer_motion_or_play_replaces_the_program(linked: Linked, own: Path) -> None:
    write(own, TURNS)
    turning(linked, 1)
    linked.do(Send(2, look(-30), ("sim",)))
    assert linked.end_of(2, "sim").accepted
    assert linked.end_of(1).reason is Reason.REPLACED
    assert short(linked.world, "sim") == pytest.approx(-30, abs=0.2)
    turning(linked, 3)
    linked.do(Play(4, ("sim",), gesture="no"))
    assert linked.end_of(3).reason is Reason.REPLACED
    assert linked.end_of(4, "sim").accepted
    assert short(linked.world, "sim") == pytest.approx(0, abs=0.2)


def test_stop_ends_the_program(linked: Linked, own: Path) -> None:
    write(own, TURNS)
    turning(linked, 1)
    linked.do(SendStop(2))
    assert linked.end_of(1).reason is Reason.STOPPED
    world = linked.until(lambda world: rests(world, "sim"), "the head rests")
    assert not world.face.running


def test_stop_of_another_seat_ends_the_program_and_names_the_seat(
    stage: Stage, linked: Linked, own: Path
) -> None:
    write(own, TURNS)
    turning(linked, 1)
    with Linked(stage.endpoint, who="ben") as other:
        other.online("sim")
        other.do(SendStop(1))
        assert other.end_of(1, "sim").accepted
        end = linked.end_of(1)
    assert (end.reason, end.detail and end.detail.presser) == (Reason.STOPPED, "ben")


ENDS = (
    ("import sys\nprint(sys.argv[1:])", Reason.OK, "['sim']"),
    ("raise ValueError('no face')", Reason.BAD_VALUE, "ValueError: no face"),
    ("from beatrix_zenoh import Robot\nRobot().look(yaw=500)", Reason.YAW_LIMIT, "500"),
    ("from beatrix_zenoh import Robot\nRobot('absent').positions()", Reason.NO_SUCH_ROBOT, "absent"),
)
"""Programs, the reason with which they end, and a part of their last line."""


@pytest.mark.long("starts the program")
def test_a_program_that_ends_gives_a_reason_and_its_last_line(linked: Linked, own: Path) -> None:
    own.parent.mkdir()
    for row, (text, reason, line) in enumerate(ENDS):
        own.write_text(text, encoding="utf-8")
        linked.do(FollowFace(row, ("sim",)))
        end = linked.end_of(row, timeout_s=START_S)
        assert (end.accepted, end.reason) == (reason is Reason.OK, reason)
        assert (end.key == FAILED) == (reason is Reason.BAD_VALUE)
        assert line in linked.world.face.line
        assert (end.detail is None) == (reason in (Reason.OK, Reason.BAD_VALUE))


def test_the_program_ends_when_its_parent_is_killed(tmp_path: Path) -> None:
    program = tmp_path / "waits.py"
    program.write_text("import time\nprint('ready', flush=True)\ntime.sleep(100)", encoding="utf-8")
    command = [sys.executable, "-m", "beatrix_zenoh.cli", "--with-parent", "--program", str(program)]
    child = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE)
    with child:
        assert present(child.stdout).readline() == b"ready\n"
        present(child.stdin).close()  # as the end of the parent does
        assert child.wait(END_S) != 0
