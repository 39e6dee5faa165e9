"""`--robot-file` as nodes, previews, `beatrix up` and `beatrix doctor` understand it."""

from __future__ import annotations

import json
import math
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from stage import ROOT, Process, Stage, free_endpoint, ready

from beatrix_zenoh import Robot, Twin

CLI = (sys.executable, "-m", "beatrix_zenoh.cli")


@pytest.fixture
def stage() -> Iterator[Stage]:
    with Stage() as made:
        yield made


@pytest.fixture
def lab(tmp_path: Path) -> Path:
    """A robot that tilts less."""
    path = tmp_path / "lab.toml"
    path.write_text("[limits]\ntilt_max = 20.0\n")
    return path


def cli(*words: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run([*CLI, *words], capture_output=True, text=True, timeout=60, check=False, cwd=ROOT)


def doctor(stage: Stage) -> dict[str, str]:
    """What must be done, by what it is about."""
    done = cli("doctor", "--json", "--connect", stage.endpoint)
    return {found["what"]: found["todo"] for found in json.loads(done.stdout)["findings"] if found["todo"]}


@pytest.mark.parametrize("module", ["sim_node", "hw_node"])
def test_a_robot_file_changes_limits_and_says_so_in_info(stage: Stage, lab: Path, module: str) -> None:
    port = ("--port", "virtual:") if module == "hw_node" else ()
    process = stage.process(
        module, "--name", "bea", "--connect", stage.endpoint, "--robot-file", str(lab), *port
    )
    process.expect("ready")
    robot = stage.robot("bea", module.removesuffix("_node"))
    assert robot.info().limits.tilt_max == pytest.approx(math.radians(20))


def test_twins_with_different_values_are_told_by_doctor_and_in_a_preview(stage: Stage, lab: Path) -> None:
    stage.simulation("bea")
    stage.hardware("bea")
    other = stage.simulation("other", "--robot-file", str(lab))
    stage.hardware("other")
    with Twin("bea", connect=stage.endpoint, who="ana") as twin:
        ready(twin.sim)
        ready(twin.hw)
        assert twin.preview(yaw=5).verdict.endswith(" s.")
    with Twin("other", connect=stage.endpoint, who="ana") as twin:
        ready(twin.sim)
        assert "different values" in twin.preview(yaw=5).verdict
    assert doctor(stage) == {"other (sim, hw)": "start both with the same --robot-file, or without one"}
    other.end()
    assert doctor(stage) == {}


def test_up_gives_its_robot_file_to_both(lab: Path) -> None:
    endpoint = free_endpoint()
    words = ("up", "--hw", "virtual:", "--name", "bea", "--connect", endpoint, "--robot-file", str(lab))
    process = Process(*CLI[1:], *words)
    try:
        process.expect("What they write")
        for twin in ("sim", "hw"):
            with Robot("bea", twin, connect=endpoint, who="ana") as robot:
                assert robot.info().limits.tilt_max == pytest.approx(math.radians(20))
    finally:
        process.end(signal.SIGINT)


def test_up_with_a_robot_file_that_can_mean_nothing_starts_nothing(tmp_path: Path) -> None:
    path = tmp_path / "lab.toml"
    path.write_text("[limits]\ntilt_max = 95.0\n")
    done = cli("up", "--connect", free_endpoint(), "--robot-file", str(path))
    assert (done.returncode, done.stdout) == (2, "")
    assert "tilt_max = 95.0: 5 to 44 deg is allowed" in done.stderr
