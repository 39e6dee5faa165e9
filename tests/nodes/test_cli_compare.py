"""`beatrix compare`, `replay` and `record --motion`."""

from __future__ import annotations

import json
import signal
from pathlib import Path

import pytest
from PIL import Image
from shell import Shell
from stage import END_S, free_endpoint, until

from beatrix_zenoh.client import motion_file

TURN = "t_s,yaw_deg,pitch_deg,roll_deg\n0,0,0,0\n0.8,20,0,0\n1.2,20,0,0\n2,0,0,0\n"


@pytest.fixture
def turn(tmp_path: Path) -> str:
    path = tmp_path / "turn.csv"
    path.write_text(TURN, encoding="utf-8")
    return str(path)


def test_a_replay_with_a_lead_is_compared_live_and_from_its_recording(
    free: Shell, turn: str, tmp_path: Path
) -> None:
    free.good("home", "--on", "both")
    png, rrd = tmp_path / "both.png", tmp_path / "both.rrd"
    record = free.start("record", str(rrd), "--cameras", "0")
    compare = free.start(
        "compare", "--seconds", "6", "--json", "--png", str(png), "--max-lag", "0.1", "--max-rest", "0.5"
    )
    until(rrd.exists, "it records", 20.0)
    done = free.run("replay", turn, "--on", "both", "--lead", "0.3")
    assert done.returncode == 0, done.stderr
    assert "Checked: 2.0 s" in done.stderr
    assert "Replay: 0 of 2 s." in done.stderr
    output, _ = compare.communicate(timeout=END_S)
    live = json.loads(output.splitlines()[-1])
    assert compare.returncode == 1, output
    assert live["lag_s"] == pytest.approx(0.3, abs=0.1)
    (exceeded,) = live["exceeded"]
    assert exceeded.startswith("The lag is +0.")
    assert [robot["missed_steps"] for robot in live["robots"]] == [0, None]
    with Image.open(png) as picture:
        assert picture.width == 1500

    record.send_signal(signal.SIGINT)
    record.communicate(timeout=END_S)
    found = free.json("compare", str(rrd))
    assert found["lag_s"] == pytest.approx(live["lag_s"], abs=0.005)
    assert [axis["axis"] for axis in found["axes_deg"]] == [
        "short", "middle", "long", "yaw", "pitch", "roll", "head"
    ]  # fmt: skip
    done = free.run("replay", str(rrd), "--on", "sim", "--json")
    assert done.returncode == 0, done.stderr
    (ended,) = json.loads(done.stdout)["robots"]
    assert ended["head_deg"]["yaw"] == pytest.approx(0, abs=0.3)


def test_no_lag_is_measured_without_motion(free: Shell) -> None:
    done = free.run("compare", "--seconds", "1.5", "--max-lag", "1")
    assert done.returncode == 1, done.stderr
    assert "No lag can be measured: nothing moved." in done.stdout
    assert "the lag could not be measured" in done.stdout.splitlines()[-1]


def test_ctrl_c_ends_a_recording_of_a_motion_and_stops_a_replay(free: Shell, tmp_path: Path) -> None:
    path = tmp_path / "mine.csv"
    record = free.start("record", "--motion", str(path), "--on", "hw")
    until(path.exists, "it records", 10.0)
    free.good("look", "--yaw", "8", "--speed", "40", "--on", "hw", "--who", "cleo")
    record.send_signal(signal.SIGINT)
    output, _ = record.communicate(timeout=END_S)
    assert record.returncode == 0, output
    assert f"To replay it: beatrix replay {path}" in output
    points = motion_file.read(path).points
    assert points[-1].place == pytest.approx((8, 0, 0), abs=0.2)

    slow = free.start("replay", str(path), "--on", "hw", "--who", "cleo", "--speed-factor", "0.05")
    with free.robot("hw") as hardware:
        until(lambda: 1 < hardware.positions().commanded.short < 7, "it moves", 20.0)
        slow.send_signal(signal.SIGINT)
        output, _ = slow.communicate(timeout=END_S)
        assert slow.returncode == 130
        assert "(hw): Stopped;" in output
        assert hardware.positions().commanded.short < 7.9


@pytest.mark.parametrize(
    ("words", "code", "what"),
    [
        (("replay", "none.csv"), 2, "none.csv cannot be read"),
        (("replay", "none.csv", "--lead", "1"), 2, "--on both"),
        (("compare", "none.rrd"), 1, "none.rrd: there is no such file"),
        (("compare", "--max-rms", "-1"), 2, "give a number, 0 or more"),
        (("record", "--motion", "mine.rrd"), 2, "must end with .csv"),
        (("record", "mine.rrd", "--on", "hw"), 2, "--on needs --motion"),
    ],
)
def test_the_error_for_wrong_arguments_names_the_cause(words: tuple[str, ...], code: int, what: str) -> None:
    done = Shell(free_endpoint()).run(*words)
    assert (done.returncode, done.stdout) == (code, "")
    assert what in " ".join(done.stderr.split())
