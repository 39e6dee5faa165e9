"""The command line: exit codes, text and JSON; run as processes if pipes or signals matter."""

from __future__ import annotations

import json
import math
import re
import signal
import subprocess
import sys

import pytest
from robots import END_S, free_endpoint, until
from shell import NAME, Shell, another

from beatrix_zenoh import Robot
from beatrix_zenoh import bus as zbus
from beatrix_zenoh.bus import Incoming
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import CONTRACT


def wait_for(process: subprocess.Popen[str], words: str) -> str:
    """Return the next line of output with these words; only the timeout of the test limits the wait."""
    assert process.stdout is not None
    return next(line for line in process.stdout if words in line)


def yaw_deg(robot: Robot) -> float:
    return robot.positions().commanded.short


# -- reading -----------------------------------------------------------------------------------


def test_ls_lists_both_robots(shell: Shell) -> None:
    rows = shell.json("ls")["robots"]
    assert [(row["robot"], row["side"], row["state"]) for row in rows] == [
        (NAME, "sim", "ready"),
        (NAME, "hw", "ready"),
    ]


def test_ls_warns_of_two_nodes_under_one_name(shell: Shell) -> None:
    with shell.robot("hw") as robot:  # as if two networks, each with such a node, were joined
        robot.client.bus.declare_token(f"beatrix/{NAME}/hw/@claim/ffff")
        assert "hw): 2 nodes serve this robot" in shell.good("ls")
        assert [row["nodes"] for row in shell.json("ls")["robots"]] == [1, 2]
    assert "2 nodes" not in shell.good("ls")


def test_info_gives_limits_in_degrees(shell: Shell) -> None:
    (row,) = shell.json("info", "--on", "hw")["robots"]
    assert row["limits"]["tilt_max_deg"] == pytest.approx(35)
    assert "35.0°" in shell.good("info")


def test_status_shows_all_values_in_groups_with_units(shell: Shell) -> None:
    text = shell.good("status", "--on", "hw")
    assert text.splitlines()[0] == f"{NAME} (hw): ready"
    for group, value in (
        ("state", "enabled"),
        ("lease", "holder"),
        ("board", "connected"),
        ("camera left", "connected"),
    ):
        assert re.search(rf"^{group} +{value} ", text, re.MULTILINE), group
    assert re.search(r"^ +speed limit +0\.0°/s$", text, re.MULTILINE)
    (row,) = shell.json("status", "--on", "hw")["robots"]
    assert (row["state"], row["board"]["connected"], row["speed_limit_deg_s"]) == ("ready", True, 0.0)


def test_echo_shows_the_requested_number(shell: Shell) -> None:
    lines = shell.good("echo", "--count", "3", "--json").splitlines()
    first, *_, last = (json.loads(line) for line in lines)
    assert (len(lines), last["seq"] - first["seq"]) == (3, 2)
    assert set(first["head_deg"]) == {"yaw", "pitch", "roll"}


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


def test_echo_of_events_ends_when_the_robot_is_lost(shell: Shell) -> None:
    with another(shell, "bea5") as node:
        echo = shell.start("echo", "events", "--name", "bea5")
        shell.good("stop", "--name", "bea5")
        wait_for(echo, "stop STOP")
        node.close()
        output, _ = echo.communicate(timeout=END_S)
    assert (echo.returncode, "bea5 (hw) is no longer online" in output) == (9, True)


def test_hz_counts_fifty_positions_a_second_and_no_loss(shell: Shell) -> None:
    (row,) = shell.json("hz", "--seconds", "1", "--on", "hw")["robots"]
    assert row["lost"] == 0
    assert 40 < row["hz"] < 60
    assert math.isfinite(row["age_ms"])


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


def test_doctor_reports_a_named_robot_that_is_not_online(shell: Shell) -> None:
    done = shell.run("doctor", "--json", "--name", "bea9")
    rows = [row for row in json.loads(done.stdout)["findings"] if row["what"] == "bea9"]
    found = f"not online; online: {NAME} (sim), {NAME} (hw)"
    assert (done.returncode, [(row["state"], row["found"]) for row in rows]) == (1, [("todo", found)])


def test_doctor_explains_what_to_do_without_a_router() -> None:
    done = Shell(free_endpoint()).run("doctor")
    assert done.returncode == 1
    assert "beatrix router" in done.stdout
    assert "account" not in done.stdout, "later checks depend on this one"


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


def test_disable_enable_and_calibrate_change_the_hardware(shell: Shell) -> None:
    assert "home is no longer known" in shell.good("disable", "--on", "hw")
    refused = shell.run("look", "--yaw", "5", "--on", "hw")
    assert (refused.returncode, "enable" in refused.stderr) == (1, True)
    shell.good("enable", "--on", "hw")
    assert shell.json("calibrate", "--on", "hw")["result"] is True
    shell.good("look", "--yaw", "5", "--on", "hw", "--speed", "80")


def test_a_refusal_is_printed_on_stderr_with_exit_code_one(shell: Shell) -> None:
    done = shell.run("look", "--pitch", "50")
    assert (done.returncode, done.stdout) == (1, "")
    assert "lean" in done.stderr


def test_an_interrupted_look_with_json_prints_a_document(free: Shell) -> None:
    with free.robot("hw") as robot:
        start = yaw_deg(robot)
        look = free.start("look", "--yaw", "100", "--speed", "20", "--on", "hw", "--json")
        until(lambda: yaw_deg(robot) > start + 2, "the robot moves, and the verb has its reply")
        look.send_signal(signal.SIGINT)
        output, _ = look.communicate(timeout=END_S)
        document = json.loads(output.splitlines()[-1])
        assert (look.returncode, document["result"], document["reason"]) == (130, False, "STOPPED")
        assert "Stopped; the arms rest at" in document["message"]
        assert not robot.status().moving
        assert yaw_deg(robot) < 90


def test_an_interrupted_look_on_both_robots_stops_both(free: Shell) -> None:
    with free.robot("hw") as hardware, free.robot("sim") as simulation:
        start = yaw_deg(hardware)  # the hardware begins last
        look = free.start("look", "--yaw", "-100", "--speed", "20", "--on", "both")
        until(lambda: yaw_deg(hardware) < start - 2, "both move, and the verb has its replies", 10.0)
        look.send_signal(signal.SIGINT)
        output, _ = look.communicate(timeout=END_S)
        assert look.returncode == 130
        assert "(sim): Stopped;" in output
        assert "(hw): Stopped;" in output
        assert not hardware.status().moving
        assert not simulation.status().moving


# -- exit codes ---------------------------------------------------------------------------------


def test_a_missing_router_has_exit_code_three() -> None:
    done = Shell(free_endpoint()).run("ls")
    assert (done.returncode, "beatrix router" in done.stderr) == (3, True)


def test_stop_names_a_robot_that_does_not_answer_and_has_its_exit_code(shell: Shell) -> None:
    unanswered: list[Incoming] = []
    with zbus.connect(
        shell.endpoint
    ) as bus:  # not a suspended node, which would count as lost after two seconds
        bus.serve(keys.stop("bea3", "hw", "*"), unanswered.append)
        bus.declare_token(keys.alive("bea3", "hw"))
        done = shell.run("stop", "--name", "bea3")
        for incoming in unanswered:
            incoming.finish()
    assert (done.returncode, "bea3 (hw) is online but did not answer" in done.stderr) == (10, True)


def test_a_request_without_a_name_is_refused_with_the_names_of_all_robots(shell: Shell) -> None:
    with another(shell, "bea4"):
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
