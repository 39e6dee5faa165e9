"""Verbs that read a recording."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from golden import same
from written_recordings import BEGAN_NS, write_lesson

from beatrix_zenoh.client.session import Place
from beatrix_zenoh.contract.errors import Refused
from beatrix_zenoh.motion.trajectory import plan
from beatrix_zenoh.recording.rows import Numbers, RecordingRow, of_robot
from beatrix_zenoh.recording.series import Floats
from beatrix_zenoh.recording.verbs.compare import compare, recorded
from beatrix_zenoh.recording.verbs.files import read_recording
from beatrix_zenoh.recording.verbs.replay import recorded_path

LAG_S, OFF_DEG = 0.2, 1.5


def turning(t: Floats) -> Floats:
    """Return the angles (n, 3; deg) of arms that turn from 1 s on and turn back from 3 s on."""
    motion = plan((0.0,) * 3, (0.0,) * 3, (20.0, 30.0, 10.0), (60.0,) * 3, 180.0, straight=True)
    return np.array([np.array(motion.at(max(0.0, k - 1))[0]) - motion.at(max(0.0, k - 3))[0] for k in t])


def write(path: Path, robots: dict[Place, float]) -> None:
    """Write a recording of robots with these lags (s); the hardware's middle arm is off by OFF_DEG."""
    rows: list[RecordingRow] = []
    t = np.arange(0.0, 6.0, 0.02)
    for place, lag_s in robots.items():
        commanded = turning(t - lag_s)
        arms = np.add(commanded, (0.0, OFF_DEG if place[1] == "hw" else 0.0, 0.0))
        for name, angles in (("arms", arms), ("commanded", commanded), ("head", arms)):
            rows += [
                Numbers(of_robot(place, name), BEGAN_NS + round(at * 1e9), tuple(row))
                for at, row in zip(t, angles, strict=True)
            ]
    write_lesson(path, [*robots], 0, rows)


@pytest.fixture(scope="module")
def lesson(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A recording of two robots, one of them without hardware."""
    path = tmp_path_factory.mktemp("lesson") / "lesson.rrd"
    write(path, {("ada", "sim"): 0.0, ("ada", "hw"): LAG_S, ("bob", "sim"): 0.0})
    return path


def test_the_table_names_every_axis_and_the_lag(lesson: Path, capsys: pytest.CaptureFixture[str]) -> None:
    compare(str(lesson), name="ada")
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in lines[1:8]] == [
        "short", "middle", "long", "yaw", "pitch", "roll", "head"
    ]  # fmt: skip
    same("cli recordings.the table names every axis and the lag 1", lines[-2])
    same("cli recordings.the table names every axis and the lag 2", lines[-1])


def test_the_error_for_a_missing_robot_lists_the_robots_of_the_recording(
    lesson: Path, tmp_path: Path
) -> None:
    with pytest.raises(
        Refused, match=r"simulation and hardware of ada \(hw\), ada \(sim\): choose one robot"
    ):
        recorded(lesson, "bob")
    with pytest.raises(Refused, match=r"positions of ada \(sim\), bob \(sim\): choose one robot with --name"):
        recorded_path(read_recording(lesson), lesson, "cleo")
    several = tmp_path / "several.rrd"
    write_lesson(several, [(name, side) for name in ("ada", "bob") for side in ("sim", "hw")], 5)
    with pytest.raises(Refused, match="choose one robot with --name"):
        recorded(several, None)


def test_the_only_robot_of_a_recording_is_replayed_under_any_name(tmp_path: Path) -> None:
    path = tmp_path / "hw.rrd"
    write(path, {("ada", "hw"): LAG_S})
    found = recorded_path(read_recording(path), path, "cleo")
    assert found.source == f"{path}, ada (hw)"
    assert np.max(found.arms, axis=0) == pytest.approx([20, 30, 10], abs=0.01), "its set points"
    assert found.duration_s == pytest.approx(3.9, abs=0.3)


def middle_of_a_message(recording: bytes) -> int:
    """Return an offset within a message of data: each has a kind and a length of 8 bytes, after a header of 12."""
    begin = end = 12
    while end < len(recording) // 2:
        begin, end = end, end + 16 + int.from_bytes(recording[end + 8 : end + 16], "little")
    return (begin + 16 + end) // 2


def test_a_note_about_an_incomplete_recording_contains_the_repair_command(
    lesson: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    recorded(lesson, "ada")
    assert capsys.readouterr().err == ""

    complete = lesson.read_bytes()
    lesson = tmp_path / "lesson.rrd"
    lesson.write_bytes(complete[: middle_of_a_message(complete)])
    with pytest.raises(Refused, match=rf"is damaged .* only in part. `beatrix record --repair {lesson}`"):
        recorded(lesson, "ada")

    lesson.write_bytes(complete[: complete.rindex(b"RRF2FOOT")])
    recorded(lesson, "ada")
    err = capsys.readouterr().err
    assert f"The end of {lesson} is missing" in err
    assert f"`beatrix record --repair {lesson}`" in err
