"""`beatrix demo`, from its start to its clean end."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from late_tests import in_time
from PIL import Image
from robots import ROOT, Process
from shell import CLI, beatrix

from beatrix_zenoh.recording.rrd.read import read
from beatrix_zenoh.recording.viewer import verify

RMS_DEG = 0.15
"""Largest RMS difference, with each motion shifted by its own lag: docs/explanation/what-the-twin-shows.md."""
GAP_S = 0.1
"""Longest time between two positions of a robot on a computer that is not busy."""


@pytest.mark.long("the whole demo, alone on the computer")
@pytest.mark.alone
@pytest.mark.measures_time
def test_demo_moves_both_robots_alike_and_writes_its_files(tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, *CLI, "demo", "--out", str(tmp_path), "--json"],
        capture_output=True,
        text=True,
        timeout=150,
        check=False,
        cwd=ROOT,
    )
    report = json.loads(done.stdout)
    rms_deg = max(axis["rms_after"] for axis in report["axes_deg"])
    if rms_deg > RMS_DEG:
        gap_s = max(robot["longest_ms"] for robot in report["robots"]) / 1e3
        in_time(gap_s, GAP_S, f"rms {rms_deg:.2f} deg; longest gap between positions")
    assert done.returncode == 0, done.stdout + done.stderr
    assert report["result"] is True
    assert rms_deg <= RMS_DEG
    assert max(axis["at_rest"] for axis in report["axes_deg"][:3]) < 0.5
    assert "look around" in done.stderr
    with Image.open(tmp_path / "compare.png") as picture:
        assert picture.width == 1500
    with Image.open(tmp_path / "demo.png") as picture:
        assert picture.size == (1200, 640), "four parts of the movement, two robots"
    assert not verify(tmp_path / "demo.rrd")
    assert set(read(tmp_path / "demo.rrd").robots) == {("demo", "sim"), ("demo", "hw")}


def test_an_interrupted_demo_stops_the_robots_and_ends_all_processes(tmp_path: Path) -> None:
    demo = Process(*CLI, "demo", "--out", str(tmp_path), traced=False)
    demo.expect("Both: nod")
    assert demo.end(signal.SIGINT) == 130
    assert not list(tmp_path.iterdir())


def test_demo_fails_at_once_if_it_cannot_write(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("", encoding="utf-8")
    done = beatrix("demo", "--out", str(tmp_path / "file"))
    assert (done.returncode, "--out" in done.stderr) == (1, True)
