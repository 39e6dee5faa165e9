"""`beatrix compare`, `replay` and `record --motion`."""

from __future__ import annotations

import json
import signal
from pathlib import Path

import pytest
from PIL import Image
from robots import END_S, until
from shell import Shell

from beatrix_zenoh.cli import app
from beatrix_zenoh.client import motion_file

TURN = "t_s,yaw_deg,pitch_deg,roll_deg\n0,0,0,0\n2,20,0,0\n2.4,20,0,0\n4.4,0,0,0\n"
"""Slow, so that a short delay of a robot on a busy computer is a small part of a motion."""


@pytest.fixture
def turn(tmp_path: Path) -> str:
    path = tmp_path / "turn.csv"
    path.write_text(TURN, encoding="utf-8")
    return str(path)


@pytest.mark.long("three verbs for half a minute")
def test_a_replay_with_a_lead_is_compared_live_and_from_its_recording(
    free: Shell, turn: str, tmp_path: Path
) -> None:
    free.good("home", "--on", "both")
    png, rrd = tmp_path / "both.png", tmp_path / "both.rrd"
    record = free.start("record", str(rrd), "--cameras", "0")
    compare = free.start(
        "compare", "--seconds", "11", "--json", "--png", str(png), "--max-lag", "0", "--max-rest", "0.5"
    )
    assert record.stdout is not None
    assert record.stdout.readline().startswith("ready"), "the file exists before the recorder subscribes"
    done = free.run("replay", turn, "--on", "both", "--lead", "0.3")
    assert done.returncode == 0, done.stderr
    assert "Checked: 4.4 s" in done.stderr
    output, _ = compare.communicate(timeout=END_S)
    live = json.loads(output.splitlines()[-1])
    assert compare.returncode == 1, output
    assert live["lag_s"] == pytest.approx(0.0, abs=0.1), "without the lead"
    assert live["leads"][0].startswith("Lead of 0.3 s, ")
    (exceeded,) = live["exceeded"]
    assert exceeded.startswith("The lag is ")
    assert [robot["missed_steps"] for robot in live["robots"]] == [0, None]
    with Image.open(png) as picture:
        assert picture.width == 1500

    record.send_signal(signal.SIGINT)
    record.communicate(timeout=END_S)
    found = free.json("compare", str(rrd))
    assert found["lag_s"] == pytest.approx(live["lag_s"], abs=0.005), (found["motions"], live["motions"])
    assert [axis["axis"] for axis in found["axes_deg"]] == [
        "short", "middle", "long", "yaw", "pitch", "roll", "head"
    ]  # fmt: skip
    done = free.run("replay", str(rrd), "--on", "sim", "--json")
    assert done.returncode == 0, done.stderr
    (ended,) = json.loads(done.stdout)["robots"]
    assert ended["head_deg"]["yaw"] == pytest.approx(0, abs=0.3)


def ended_at(path: Path) -> motion_file.Place:
    """Return the place (deg) of the last point in a motion file."""
    return motion_file.read(path).points[-1].place


@pytest.mark.parametrize(("number", "background"), [(signal.SIGINT, False), (signal.SIGTERM, True)])
def test_signals_end_a_recording_of_a_motion_with_its_summary(
    free: Shell, tmp_path: Path, number: signal.Signals, *, background: bool
) -> None:
    path = tmp_path / "mine.csv"
    free.good("home", "--on", "hw")
    record = free.start("record", "--motion", str(path), "--on", "hw", background=background)
    until(path.exists, "it records")
    free.good("look", "--yaw", "8", "--speed", "40", "--on", "hw")
    record.send_signal(number)
    output, _ = record.communicate(timeout=END_S)
    assert record.returncode == 0, output
    assert f"To replay it: beatrix replay {path}" in output
    assert ended_at(path) == pytest.approx((8, 0, 0), abs=0.2)


@pytest.mark.parametrize(
    ("words", "code", "what"),
    [
        (("replay", "none.csv"), 2, "none.csv cannot be read"),
        (("replay", "none.csv", "--lead", "1"), 2, "--on both"),
        (("compare", "none.rrd"), 2, "none.rrd: there is no such file"),
        (("replay", "none.rrd"), 2, "none.rrd: there is no such file"),
        (("view", "none.rrd"), 2, "none.rrd: there is no such file"),
        (("compare", "--max-rms", "-1"), 2, "give a number, 0 or more"),
        (("record", "--motion", "mine.rrd"), 2, "must end with .csv"),
        (("record", "mine.rrd", "--on", "hw"), 2, "--on needs --motion"),
        (("record", "mine.rrd", "--keep-rest"), 2, "--keep-rest needs --motion"),
        (("replay", "none.csv", "--from", "-1"), 2, "'--from': -1.0 is not in the range"),
    ],
)
def test_the_error_for_wrong_arguments_names_the_cause(
    words: tuple[str, ...], code: int, what: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert app.run(list(words)) == code
    printed = capsys.readouterr()
    assert printed.out == ""
    assert what in " ".join(printed.err.split())
