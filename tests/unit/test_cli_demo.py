"""The report and the files of `beatrix demo`, also when files cannot be written."""

from __future__ import annotations

import errno
import json
import resource
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from beatrix_zenoh.cli import demo_files
from beatrix_zenoh.cli.demo import conclude
from beatrix_zenoh.cli.demo_report import Measured, Measurement
from beatrix_zenoh.contract._generated.messages import Head, PlantStatus, Positions, Steps, Vector3
from beatrix_zenoh.files import replace_when_complete

PLANT = PlantStatus(real_time_factor=1.0, late_steps=0, slipped_steps=0, re_placed=0)
SMALL = 2048
"""Largest file on the full disk, bytes."""


def measured(turned_rad: float) -> Measured:
    """Return the data of a robot that rests, turns and rests again."""
    samples = []
    for seq in range(200):
        angle = turned_rad * min(1.0, max(0.0, (seq - 50) / 50))
        arms = Vector3(angle, angle, angle)
        t_ns = seq * 20_000_000
        sample = Positions(
            seq=seq,
            t_mono_ns=t_ns,
            t_wall_ns=t_ns,
            position=arms,
            velocity=Vector3(0.0, 0.0, 0.0),
            commanded=arms,
            steps=Steps(0, 0, 0),
            head=Head(angle, 0.0, 0.0),
        )
        samples.append(sample)
    return Measured(samples, [0.002, 0.003])


@pytest.fixture
def done(monkeypatch: pytest.MonkeyPatch) -> Measurement:
    """Measurement of two robots that made the same movement; the process that draws the head makes an empty file."""
    monkeypatch.setattr(demo_files, "DRAW", "import pathlib, sys; pathlib.Path(sys.argv[1]).touch()")
    monkeypatch.delenv(
        "COVERAGE_PROCESS_CONFIG", raising=False
    )  # the subprocess would leave a damaged data file of coverage on a full disk
    return Measurement(measured(0.5), measured(0.5), PLANT)


@contextmanager
def full_disk() -> Iterator[None]:
    """Limit the size of files in this block; Python raises OSError as on a full disk.

    Not a fixture: coverage writes its data between the phases of a test.
    """
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (SMALL, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)


def names(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


def test_the_demo_writes_its_files_and_no_others(
    done: Measurement, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert conclude(done, tmp_path, None, as_json=True)
    report = json.loads(capsys.readouterr().out)
    assert names(tmp_path) == ["demo.csv", "demo.png", "head.png"]
    assert [Path(file).name for file in report["files"]] == names(tmp_path)
    assert report["unwritten"] == []


@pytest.mark.parametrize("as_json", [False, True])
def test_on_a_full_disk_the_demo_prints_its_report_and_leaves_no_incomplete_file(
    done: Measurement, tmp_path: Path, capsys: pytest.CaptureFixture[str], *, as_json: bool
) -> None:
    with full_disk():
        assert not conclude(done, tmp_path, None, as_json=as_json)
    out = capsys.readouterr().out
    assert "Both made the same movement" in out
    assert f"{tmp_path / 'demo.csv'} could not be written: File too large." in out
    assert names(tmp_path) == ["head.png"], "only the empty file fits"


def test_an_existing_file_is_replaced_only_by_a_complete_one(tmp_path: Path) -> None:
    path = tmp_path / "demo.csv"
    path.write_text("old")

    def fail() -> None:
        with replace_when_complete(path) as unfinished:
            unfinished.write_text("ne")
            raise OSError(errno.ENOSPC, "full")

    with pytest.raises(OSError, match="full"):
        fail()
    assert (names(tmp_path), path.read_text()) == (["demo.csv"], "old")
    with replace_when_complete(path) as unfinished:
        unfinished.write_text("new")
    assert (names(tmp_path), path.read_text()) == (["demo.csv"], "new")
