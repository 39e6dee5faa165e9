"""`beatrix demo`, from its start to its clean end."""

from __future__ import annotations

import csv
import json
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from late_tests import in_time
from PIL import Image
from robots import ROOT, Process

from beatrix_zenoh.cli.demo_report import BUSY_FACTOR
from beatrix_zenoh.recording.rrd.read import read
from beatrix_zenoh.recording.viewer import verify

CLI = ("-m", "beatrix_zenoh.cli")
RMS_DEG = 0.15
"""Largest RMS difference, with each motion shifted by its own lag: docs/explanation/what-the-twin-shows.md."""
MOTIONS_S = 34.0
"""Time that the demo's motions take."""


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
    if "too busy for a result" in report["message"]:
        in_time(MOTIONS_S / report["real_time_factor"], MOTIONS_S / BUSY_FACTOR, report["message"])
    assert done.returncode == 0, done.stdout + done.stderr
    assert report["result"] is True
    assert [axis["axis"] for axis in report["axes"]] == [
        "short", "middle", "long", "yaw", "pitch", "roll", "head"
    ]  # fmt: skip
    assert max(axis["rms_after"] for axis in report["axes"]) <= RMS_DEG
    assert max(axis["at_rest"] for axis in report["axes"][:3]) < 0.5
    assert report["real_time_factor"] == pytest.approx(1, abs=0.05)
    assert 45 < report["hw"]["positions_hz"] < 55
    assert "look around" in done.stderr
    for name, width in (("demo.png", 1500), ("head.png", 1280)):
        with Image.open(tmp_path / name) as picture:
            assert picture.width == width
    with Image.open(tmp_path / "twins.png") as picture:
        assert picture.width > 1000
    assert not verify(tmp_path / "demo.rrd")
    recorded = read(tmp_path / "demo.rrd")
    assert set(recorded.robots) == {("demo", "sim"), ("demo", "hw")}
    with (tmp_path / "demo.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) > 1500
    assert max(float(row["hw_yaw_deg"]) for row in rows) > 35


def test_an_interrupted_demo_stops_the_robots_and_ends_all_processes(tmp_path: Path) -> None:
    demo = Process(*CLI, "demo", "--out", str(tmp_path), traced=False)
    demo.expect("Both: nod")
    begin = time.monotonic()
    assert demo.end(signal.SIGINT) == 130
    assert time.monotonic() - begin < 8
    assert not list(tmp_path.iterdir())


def test_demo_fails_at_once_if_it_cannot_write(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("", encoding="utf-8")
    demo = Process(*CLI, "demo", "--out", str(tmp_path / "file"), traced=False)
    assert demo.wait() == 1
    assert any("--out" in line for line in demo.lines)
