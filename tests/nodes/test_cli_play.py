"""The lead and choreographies on the command line."""

from __future__ import annotations

import json
import re
import signal
from pathlib import Path

import pytest
from late_tests import in_time
from robots import END_S, raw_positions, until
from shell import Shell, beatrix

MINE = """t_s,yaw_deg,pitch_deg,roll_deg,short_deg,middle_deg,long_deg,speed_deg_s,figure
0.0,0,8,0,,,,60,yes
0.5,0,0,0,,,,,
1.0,,,,6,6,6,,turn
"""


LAG_ERROR_S = 0.15
"""Largest difference between the lead and the lag that the verb reports (s)."""


@pytest.fixture
def mine(tmp_path: Path) -> str:
    path = tmp_path / "mine.csv"
    path.write_text(MINE, encoding="utf-8")
    return str(path)


# -- lead ---------------------------------------------------------------------------------------


@pytest.mark.long("a lead in real time")
@pytest.mark.measures_time
def test_look_with_a_lead_counts_down_and_reports_the_lag(free: Shell) -> None:
    free.good(
        "home", "--on", "both"
    )  # another file may have left a robot at this goal, which then does not begin
    done = free.run("look", "--yaw", "8", "--speed", "60", "--on", "both", "--lead", "1", "--json")
    assert done.returncode == 0, done.stderr
    lines = [line for line in done.stderr.splitlines() if "moves in" in line]
    assert [line.split(",")[0] for line in lines] == ["The hardware moves in 1 s"]
    lag = re.search(r"The hardware began (\S+) s after the simulation", done.stderr)
    assert lag is not None
    assert float(lag[1]) > 1.0 - LAG_ERROR_S
    in_time(float(lag[1]), 1.0 + LAG_ERROR_S, "lag of a lead of 1 s")
    yaws = [row["head_deg"]["yaw"] for row in json.loads(done.stdout)["robots"]]
    assert yaws == pytest.approx([8, 8], abs=0.5)


def test_ctrl_c_within_the_lead_leaves_the_hardware_unmoved_and_reports_it(free: Shell) -> None:
    free.good("home", "--on", "both")
    with free.robot("hw") as hardware, free.robot("sim") as simulation:
        before = raw_positions(hardware).steps
        look = free.start("look", "--yaw", "60", "--speed", "30", "--on", "both", "--lead", "20")
        until(lambda: simulation.positions().commanded.short > 2, "the simulation moves")
        look.send_signal(signal.SIGINT)
        output, _ = look.communicate(timeout=END_S)
        assert look.returncode == 130
        assert "(sim): Stopped;" in output
        assert "(hw): not moved." in output
        assert raw_positions(hardware).steps == before
        assert not simulation.status().moving


# -- speed --------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "words",
    [
        ("move", "1", "2", "3", "--speed", "10,20"),
        ("move", "1", "2", "3", "--speed", "fast"),
        ("look", "--lead", "2"),
        ("router", "--class", "class.toml", "--listen", "tcp/0.0.0.0:7447"),
        ("look", "--lead", "2", "--on", "sim"),
        ("look", "--lead", "-1", "--on", "both"),
        ("look", "--lead", "nan", "--on", "both"),
        ("play", "hello", "--lockstep"),
        ("play", "hello", "--lockstep", "--lead", "1", "--on", "both"),
        ("play", "hello", "--speed", "0"),
        ("play", "no-such-file.csv"),
    ],
)
def test_invalid_or_contradictory_options_are_wrong_usage(words: tuple[str, ...]) -> None:
    assert beatrix(*words).returncode == 2


# -- play ---------------------------------------------------------------------------------------


@pytest.mark.long("plays in real time")
@pytest.mark.parametrize("options", [("--on", "sim"), ("--on", "both", "--lockstep")])
def test_play_shows_each_pose_and_where_it_ends(free: Shell, mine: str, options: tuple[str, ...]) -> None:
    free.good("home", "--on", "both")
    done = free.run("play", mine, *options, "--json")
    assert done.returncode == 0, done.stderr
    shown = [line for line in done.stderr.splitlines() if re.match(r"\d/3 ", line)]
    assert shown == [
        "1/3 yes: yaw +0°, pitch +8°, roll +0°",
        "2/3 yes: yaw +0°, pitch +0°, roll +0°",
        "3/3 turn: arms short +6°, middle +6°, long +6°",
    ]
    rows = json.loads(done.stdout)["robots"]
    assert [row["arms_deg"]["short"] for row in rows] == pytest.approx([6.0] * len(rows), abs=0.5)
    assert len(rows) == 1 + ("both" in options)


def test_play_of_a_bad_file_names_the_line(tmp_path: Path) -> None:
    path = tmp_path / "bad.csv"
    path.write_text(MINE.replace("6,6,6", "6,6,"), encoding="utf-8")
    done = beatrix("play", str(path))
    assert (done.returncode, done.stdout) == (2, "")
    assert f"{path}, line 4: long_deg is empty: give a number" in done.stderr


def test_ctrl_c_stops_a_choreography_on_both_robots(free: Shell, tmp_path: Path) -> None:
    free.good("home", "--on", "both")
    path = tmp_path / "long.csv"
    path.write_text(MINE.replace("0,8,0", "100,0,0").replace("60", "20"), encoding="utf-8")
    with free.robot("hw") as hardware, free.robot("sim") as simulation:
        play = free.start("play", str(path), "--on", "both")
        until(lambda: hardware.positions().commanded.short > 2, "the hardware moves")
        play.send_signal(signal.SIGINT)
        output, _ = play.communicate(timeout=END_S)
        assert play.returncode == 130
        assert "(sim): Stopped;" in output
        assert "(hw): Stopped;" in output
        assert [robot.status().moving for robot in (hardware, simulation)] == [False, False]
