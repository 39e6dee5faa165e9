"""`--robot-file` in nodes, previews, `beatrix up` and `beatrix doctor`."""

from __future__ import annotations

import json
import signal
import sys
from pathlib import Path

import pytest
from robots import Process, Stage, free_endpoint, ready
from shell import beatrix

from beatrix_zenoh import Robot, Twin
from beatrix_zenoh.contract._generated.robot import LimitsData, RobotData
from sim_node.body import Simulation

CLI = (sys.executable, "-m", "beatrix_zenoh.cli")


@pytest.fixture
def lab(tmp_path: Path) -> Path:
    """A robot file with a smaller tilt limit."""
    path = tmp_path / "lab.toml"
    path.write_text("[limits]\ntilt_max = 20.0\n")
    return path


def doctor(alone: Stage) -> dict[str, str]:
    """Return the to-do lines of `beatrix doctor`, by topic."""
    done = beatrix("doctor", "--json", "--connect", alone.endpoint)
    return {found["what"]: found["todo"] for found in json.loads(done.stdout)["findings"] if found["todo"]}


def test_doctor_and_preview_report_twins_with_different_values(
    alone: Stage, monkeypatch: pytest.MonkeyPatch
) -> None:
    small = RobotData(limits=LimitsData(tilt_max=20.0))
    monkeypatch.setenv("MUJOCO_GL", "off")  # drawing is no part of this test
    alone.node("bea", Simulation("bea"))
    alone.node("bea")
    other = alone.node("other", Simulation("other", small), small)
    alone.node("other")
    with Twin("bea", connect=alone.endpoint, who="ana") as twin:
        ready(twin.sim)
        ready(twin.hw)
        assert twin.preview(yaw=5).verdict.endswith(" s.")
    with Twin("other", connect=alone.endpoint, who="ana") as twin:
        ready(twin.sim)
        assert "different values" in twin.preview(yaw=5).verdict
    assert doctor(alone) == {"other (sim, hw)": "start both with the same --robot-file, or without one"}
    other.close()
    assert doctor(alone) == {}


@pytest.mark.long("starts a robot twice")
def test_up_passes_its_robot_file_to_both_nodes(lab: Path) -> None:
    endpoint = free_endpoint()
    words = ("up", "--hw", "virtual:", "--name", "bea", "--connect", endpoint, "--robot-file", str(lab))
    process = Process(*CLI[1:], *words)
    try:
        process.expect("The output of all processes is in")
        for side in ("sim", "hw"):
            with Robot("bea", side, connect=endpoint, who="ana") as robot:
                assert robot.info().limits.tilt_max == 20
    finally:
        process.end(signal.SIGINT)
