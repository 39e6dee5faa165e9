"""`beatrix demo`: the first minute, from start to nothing left behind."""

from __future__ import annotations

import csv
import json
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from bench import given_away, share_given_away
from PIL import Image
from stage import ROOT, Process

CLI = ("-m", "beatrix_zenoh.cli")
NOT_OURS = 0.05
"""Of the processors' time: no real time can be kept where the host gives more to others."""


def test_demo_makes_one_movement_on_both_robots_in_less_than_a_minute(tmp_path: Path) -> None:
    begin = time.monotonic()
    before = given_away()
    done = subprocess.run(
        [sys.executable, *CLI, "demo", "--out", str(tmp_path), "--json"],
        capture_output=True,
        text=True,
        timeout=55,
        check=False,
        cwd=ROOT,
    )
    if "too busy to tell" in done.stdout and (share := share_given_away(before)) > NOT_OURS:
        pytest.skip(f"the host gave {share:.0%} of this computer's time to others, and the demo said so")
    assert done.returncode == 0, done.stdout + done.stderr
    assert time.monotonic() - begin < 60
    report = json.loads(done.stdout)
    assert report["result"] is True
    assert [axis["axis"] for axis in report["axes"]] == ["short", "middle", "long", "yaw", "pitch", "roll"]
    assert max(axis["at_rest"] for axis in report["axes"][:3]) < 0.5
    assert report["real_time_factor"] == pytest.approx(1, abs=0.05)
    assert 45 < report["hw"]["positions_hz"] < 55
    assert "look around" in done.stderr
    for name, width in (("demo.png", 1500), ("head.png", 1280)):
        with Image.open(tmp_path / name) as picture:
            assert picture.width == width
    with (tmp_path / "demo.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) > 1500
    assert max(float(row["hw_yaw_deg"]) for row in rows) > 35


def test_interrupted_demo_stops_and_ends_everything(tmp_path: Path) -> None:
    demo = Process(*CLI, "demo", "--out", str(tmp_path), traced=False)
    demo.expect("Both: nod")
    begin = time.monotonic()
    assert demo.end(signal.SIGINT) == 130
    assert time.monotonic() - begin < 8
    assert not list(tmp_path.iterdir())


def test_demo_says_at_once_if_it_may_not_write(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("", encoding="utf-8")
    demo = Process(*CLI, "demo", "--out", str(tmp_path / "file"))
    assert demo.wait() == 1
    assert any("--out" in line for line in demo.lines)
