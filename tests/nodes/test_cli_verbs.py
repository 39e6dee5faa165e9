"""The command line: exit codes, text and JSON; run as processes if pipes or signals matter."""

from __future__ import annotations

import json
import re
import subprocess
import sys

import pytest
from robots import END_S
from shell import NAME, Shell

from beatrix_zenoh import bus as zbus
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import CONTRACT


def wait_for(process: subprocess.Popen[str], words: str) -> str:
    """Return the next line of output with these words; only the timeout of the test limits the wait."""
    assert process.stdout is not None
    return next(line for line in process.stdout if words in line)


# -- reading -----------------------------------------------------------------------------------


def test_status_shows_all_values_in_groups_with_units(shell: Shell) -> None:
    text = shell.good("status", "--on", "hw")
    assert text.splitlines()[0] == f"{NAME} (hw): ready"
    assert re.search(r"^camera left +connected ", text, re.MULTILINE)
    assert re.search(r"^ +speed limit +0\.0°/s$", text, re.MULTILINE)
    (row,) = shell.json("status", "--on", "hw")["robots"]
    assert (row["state"], row["board"]["connected"], row["speed_limit_deg_s"]) == ("ready", True, 0.0)


def test_echo_shows_the_last_events_and_then_the_next_ones(free: Shell) -> None:
    free.run("look", "--pitch", "50", "--on", "hw")
    free.good("look", "--yaw", "5", "--speed", "60", "--on", "hw")
    echo = free.start("echo", "events", "--on", "hw")
    try:
        asked = "bea1 (hw)  ana asked look yaw 0.0°, pitch 50.0°, roll 0.0° at the default speed, from"
        assert f"{asked} the command line, refused OUT_OF_REACH: The head" in wait_for(echo, "REACH")
        assert "done: Arrived" in wait_for(echo, "ana motion pose ")
        free.good("calibrate", "--on", "hw")
        assert "line: The present position is home now." in wait_for(echo, "ana command CALIBRATE, from")
    finally:
        echo.terminate()
        echo.communicate(timeout=END_S)


def test_doctor_checks_each_step_from_the_router_to_the_cameras(shell: Shell) -> None:
    done = shell.run("doctor", "--json")
    rows = json.loads(done.stdout)["findings"]
    assert done.returncode == 0, done.stdout
    assert {"what", "found", "state", "todo", "advice"} == {*rows[0]}
    assert [(row["what"], row["found"]) for row in rows[:2]] == [
        ("router", "answers"),
        ("account", "none: this router is open to every program"),
    ]
    found = [row["found"] for row in rows if row["what"] == f"{NAME} (hw)"]
    steps = (
        "answers",
        "positions a second of 50",
        "its clock is",
        f"same messages ({CONTRACT})",
        "board",
        "camera",
    )
    assert all(step in text for step, text in zip(steps, found, strict=False))
    own = {row["what"]: row["found"] for row in rows}
    assert (own["hidden modules"], "OpenGL" in own["graphics"]) == ("none", True)


# -- moving ----------------------------------------------------------------------------------


def test_look_turns_the_simulation_by_default(shell: Shell) -> None:
    with shell.robot("hw") as hardware:
        before = hardware.positions().commanded
        (row,) = shell.json("look", "--yaw", "12", "--speed", "80")["robots"]
        assert row["side"] == "sim"
        assert row["head_deg"]["yaw"] == pytest.approx(12, abs=0.5)
        assert hardware.positions().commanded == before


def test_look_on_both_robots_is_previewed_and_turns_both(shell: Shell) -> None:
    done = shell.run("look", "--pitch", "-8", "--speed", "80", "--on", "both", "--json")
    assert "Preview" in done.stderr
    pitches = [row["head_deg"]["pitch"] for row in json.loads(done.stdout)["robots"]]
    assert pitches == pytest.approx([-8, -8], abs=0.5)


# -- exit codes ---------------------------------------------------------------------------------


def test_a_request_without_a_name_is_refused_with_the_names_of_all_robots(shell: Shell) -> None:
    with zbus.connect(shell.endpoint) as bus:
        bus.declare_token(keys.alive("bea4", "hw"))
        done = shell.run("look", "--yaw", "5")
    assert (done.returncode, f"{NAME}, bea4" in done.stderr) == (1, True)


def test_look_imports_no_slow_package(shell: Shell) -> None:
    slow = ("rich", "numpy", "matplotlib", "mujoco", "wasmtime")
    code = f"""
import sys
from beatrix_zenoh.cli.app import run
run(["look", "--yaw", "0"])
print("slow:", [name for name in {slow} if name in sys.modules])
"""
    done = subprocess.run(
        [sys.executable, "-c", code],
        capture_output=True,
        text=True,
        env=shell.environment(),
        timeout=30,
        check=False,
    )
    assert "slow: []" in done.stdout, done.stdout + done.stderr
