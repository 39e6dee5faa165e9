"""Title and notes of a recording: notes reach every running recording, with the seat that sent them."""

from __future__ import annotations

import json
import signal
from pathlib import Path

import pytest
from recorded_values import SCALARS, recorded_values
from robots import Stage, ask_raw
from shell import Shell

from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.recording.rrd.read import read, read_about


def test_a_note_without_a_recording_says_how_to_begin_one(stage: Stage) -> None:
    shell = Shell(stage.endpoint)
    done = shell.run("note", "trial", "3")
    assert done.returncode == 5
    assert "No recording is running" in done.stderr
    assert "beatrix record FILE.rrd" in done.stderr
    assert json.loads(shell.run("note", "trial 3", "--json").stdout)["reason"] == "NO_ANSWER"


@pytest.mark.long("starts several recorders")
def test_notes_of_all_seats_are_in_every_recording(stage: Stage, tmp_path: Path) -> None:
    shell = Shell(stage.endpoint)
    first, second = tmp_path / "one.rrd", tmp_path / "two.rrd"
    options = ("--cameras", "0", "--who", "teacher")
    processes = [
        stage.recorder(first, *options, "--title", "Lesson 2", "--note", "group A"),
        stage.recorder(second, *options),
    ]
    for process in processes:
        process.expect_all("Recording bea (hw).", "Recording bea (sim).")
    lines = sorted(shell.good("note", "trial 3", "begins").splitlines())
    assert [line.partition(": noted at ")[0] for line in lines] == ["one.rrd (Lesson 2)", "two.rrd"]
    found = shell.json("note", "a\nforged \x1b[31mline", "--who", "ben")
    assert [row["result"] for row in found["recordings"]] == [True, True]
    answers = ask_raw(stage.client("foreign"), keys.note("cem", "*") + "?text=in%20plain%20words")
    assert len(answers) == 2
    assert shell.run("note", " ").returncode == 1
    assert [process.end(signal.SIGTERM) for process in processes] == [0, 0]

    one, two = read(first), read(second)
    noted = [("ana", "trial 3 begins"), ("ben", "a forged ?[31mline"), ("cem", "in plain words")]
    assert [(note.seat, note.text) for note in two.notes] == noted
    assert [(note.seat, note.text) for note in one.notes] == [("teacher", "group A"), *noted]
    assert {row["t_wall_ns"] // 10**9 for row in found["recordings"]} <= {
        note.time_ns // 10**9 + k for note in two.notes for k in (-1, 0, 1)
    }
    about = read_about(first)
    assert about is not None
    assert about == one.about
    assert (about.title, about.note, about.seat) == ("Lesson 2", "group A", "teacher")
    assert [(robot.robot, robot.side, robot.firmware != "") for robot in about.robots] == [
        ("bea", "hw", True),
        ("bea", "sim", True),
    ]
    assert about.seats == ("ana", "ben", "cem", "teacher")
    assert len({robot.fingerprint for robot in about.robots}) == 1
    for name, side in one.robots:
        offset_s, bound_s, *_ = recorded_values(first, f"{name}/{side}/clock", SCALARS)
        assert abs(offset_s) <= max(bound_s, 0.01)
