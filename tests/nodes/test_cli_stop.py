"""`beatrix stop` and the verbs that send commands, on robots in real processes."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from shell import NAME, Shell

from beatrix_zenoh import Refused
from beatrix_zenoh.contract._generated.messages import Reason


@pytest.mark.parametrize(("seat", "how"), [("gustav", ()), ("emil", ("--emergency",))])
def test_top_counts_each_stop_of_a_seat_once(shell: Shell, seat: str, how: tuple[str, ...]) -> None:
    shell.good("stop", "--who", seat, *how)
    line = next(row for row in shell.good("top", "--once").splitlines() if row.startswith("STOP pressed: "))
    assert f"{seat} 2 times ({NAME} sim 1, {NAME} hw 1)" in line
    (stops,) = [one for one in shell.json("top")["stops"] if one["seat"] == seat]
    assert stops["count"] == 2
    if how:
        make_ready_again(shell)


def test_no_setting_prevents_stop(shell: Shell, tmp_path: Path) -> None:
    (tmp_path / "beatrix.toml").write_text('robot = "bea1', encoding="utf-8")
    done = shell.run("stop", "--json", cwd=tmp_path, BEATRIX_ROBOT="Bea 1", BEATRIX_WHO="Frau Müller")
    rows = json.loads(done.stdout)["robots"]
    assert {(row["robot"], row["side"]) for row in rows} == {(NAME, "sim"), (NAME, "hw")}
    assert done.returncode == 0
    for wrong in ("beatrix.toml", "'Bea 1'", "Frau"):
        assert wrong in done.stderr


def test_stop_without_a_robot_of_the_configured_name_explains_how_to_stop_all(shell: Shell) -> None:
    done = shell.run("stop", BEATRIX_ROBOT="bea9")
    assert (done.returncode, f"{NAME} (hw)" in done.stderr) == (6, True)
    assert "beatrix stop --all" in done.stderr


def make_ready_again(shell: Shell) -> None:
    rows = shell.json("reset", "--on", "both")["robots"]
    assert [row["side"] for row in rows] == ["sim", "hw"]
    assert {row["state"] for row in shell.json("ls")["robots"]} == {"motors off"}, "reset switches nothing on"
    shell.good("enable", "--on", "both")
    shell.good("calibrate", "--on", "both")


def test_after_an_emergency_stop_enable_is_refused_until_reset(shell: Shell) -> None:
    shell.good("stop", "--all", "--emergency")
    assert {row["fault"] for row in shell.json("ls")["robots"]} == {"EMERGENCY"}
    assert "EMERGENCY_STOP is latched" in shell.good("ls")
    refused = shell.run("enable", "--on", "hw")
    assert (refused.returncode, "`beatrix reset`" in refused.stderr) == (1, True)
    make_ready_again(shell)


def test_stop_with_a_wrong_name_stops_the_others_and_then_fails(free: Shell) -> None:
    with free.robot("hw") as robot:
        motion = robot.look(yaw=60, speed=10, wait=False)
        done = free.run("stop", "--name", "Bea 2", "--name", "bea7", "--name", NAME, "--json")
        assert (motion.exception(5.0) or Refused(Reason.OK)).reason is Reason.STOPPED
    document = json.loads(done.stdout)
    results = {(row["robot"], row["side"]): row["reason"] for row in document["robots"]}
    assert results == {
        (NAME, "sim"): "OK",
        (NAME, "hw"): "OK",
        ("Bea 2", ""): "BAD_VALUE",
        ("bea7", ""): "NO_SUCH_ROBOT",
    }
    assert (done.returncode, document["result"]) == (6, False)


def test_a_command_to_both_robots_names_the_robot_that_refuses(shell: Shell) -> None:
    shell.good("disable", "--on", "hw")
    done = shell.run("calibrate", "--on", "both")
    shell.good("enable", "--on", "hw")
    shell.good("calibrate", "--on", "both")
    assert (done.returncode, f"{NAME} (sim): " in done.stdout) == (1, True)
    assert f"\n{NAME} (hw): The motors are off" in done.stderr
