"""`beatrix stop` and the verbs that switch, as people use them: real processes."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from shell import NAME, Shell, another
from stage import until

pytestmark = pytest.mark.xdist_group("cli")


def test_stop_ends_a_motion_and_its_asker_is_told(free: Shell) -> None:
    with free.robot("hw") as robot:
        look = free.start("look", "--yaw", "100", "--speed", "20", "--on", "hw")
        until(lambda: robot.status().moving, "the motion begins")
        rows = free.json("stop", "--who", "ben")["robots"]
        output, _ = look.communicate(timeout=10)
    assert {(row["on"], row["result"]) for row in rows} == {("sim", True), ("hw", True)}
    assert (look.returncode, "STOP" in output) == (1, True)


def test_no_setting_stands_in_the_way_of_stop(shell: Shell, tmp_path: Path) -> None:
    (tmp_path / "beatrix.toml").write_text('robot = "bea1', encoding="utf-8")
    done = shell.run("stop", "--json", cwd=tmp_path, BEATRIX_ROBOT="Bea 1", BEATRIX_WHO="Frau Müller")
    rows = json.loads(done.stdout)["robots"]
    assert {(row["robot"], row["on"]) for row in rows} == {(NAME, "sim"), (NAME, "hw")}
    assert done.returncode == 0
    for wrong in ("beatrix.toml", "'Bea 1'", "Frau"):
        assert wrong in done.stderr


def test_stop_takes_several_names_and_both_twins(shell: Shell) -> None:
    with another(shell, "bea2"):
        rows = shell.json("stop", "--name", "bea2", "--name", NAME, "--on", "hw", "--on", "sim")["robots"]
    assert {(row["robot"], row["on"]) for row in rows} == {(NAME, "sim"), (NAME, "hw"), ("bea2", "hw")}


def test_stop_that_finds_nobody_of_the_name_that_is_set_says_how_to_stop_all(shell: Shell) -> None:
    done = shell.run("stop", BEATRIX_ROBOT="bea9")
    assert (done.returncode, f"{NAME} (hw)" in done.stderr) == (3, True)
    assert "`beatrix stop --all` stops every robot." in done.stderr


def test_emergency_stop_of_all_robots_needs_enable_afterwards(shell: Shell) -> None:
    shell.good("stop", "--all", "--emergency")
    assert {row["fault"] for row in shell.json("ls")["robots"]} == {"EMERGENCY"}
    assert "EMERGENCY_STOP was pressed" in shell.good("ls")
    shell.good("enable", "--on", "both")
    shell.good("calibrate", "--on", "both")


def test_of_both_robots_the_one_that_refuses_is_named(shell: Shell) -> None:
    shell.good("disable", "--on", "hw")
    done = shell.run("calibrate", "--on", "both")
    shell.good("enable", "--on", "hw")
    shell.good("calibrate", "--on", "both")
    assert (done.returncode, f"{NAME} (sim): " in done.stdout) == (1, True)
    assert f"\n{NAME} (hw): The motors are off" in done.stderr


def test_stop_that_finds_nobody_is_exit_code_three(shell: Shell) -> None:
    assert shell.run("stop", "--name", "bea7").returncode == 3


def test_hardware_taken_for_want_of_a_simulation_is_told(shell: Shell) -> None:
    with another(shell, "bea2"):
        told = shell.run("enable", "--name", "bea2").stderr
        asked = shell.run("enable", "--name", "bea2", "--on", "hw").stderr
        shown = shell.run("info", "--name", "bea2").stderr
    assert told == "No simulation of bea2 is on line: this goes to the hardware.\n"
    assert asked == shown == ""
