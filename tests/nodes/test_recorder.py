"""A recorder, a simulation and a virtual robot as processes: the recording is read and checked."""

from __future__ import annotations

import re
import shutil
import signal
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from recorded_values import STATE, recorded_values
from robots import Stage, ready, until
from shell import Shell

from beatrix_zenoh import Interrupted, Refused
from beatrix_zenoh.cli import app
from beatrix_zenoh.client.subscription import positions
from beatrix_zenoh.contract._generated.messages import Positions
from beatrix_zenoh.recording.rrd.read import read, read_sound
from beatrix_zenoh.recording.samples import Recorded
from beatrix_zenoh.recording.viewer import verify

SIM, HW = ("bea", "sim"), ("bea", "hw")
PAGE = Path(__file__).resolve().parents[2] / "docs/how-to/record.md"


@dataclass(frozen=True)
class Lesson:
    """A recorded lesson."""

    path: Path
    recorded: Recorded
    published: dict[tuple[str, str], list[Positions]]
    """publications that another subscriber has received meanwhile"""
    output: list[str]


@pytest.fixture(scope="module")
def lesson(stage: Stage, tmp_path_factory: pytest.TempPathFactory) -> Lesson:
    """Record a lesson in which both robots turn, one motion is refused, and one is stopped."""
    path = tmp_path_factory.mktemp("lesson") / "lesson.rrd"
    process = stage.recorder(path)
    process.expect_all("Recording bea (hw).", "Recording bea (sim).")
    with positions(stage.client("witness")) as subscription:
        robots = [ready(stage.robot("bea", side)) for side in ("sim", "hw")]
        for robot in robots:
            for camera in robot.status().cameras:
                with robot.camera(camera.eye) as images:
                    next(iter(images))  # the recorder receives it, too, and lays out its view
        for motion in [robot.look(yaw=12, pitch=5, wait=False) for robot in robots]:
            motion.wait()
        with pytest.raises(Refused):
            robots[0].look(pitch=60)
        motion = robots[1].look(yaw=-60, wait=False)
        until(lambda: robots[1].positions().head.yaw < 8, "it turns")
        robots[1].stop()
        with pytest.raises(Interrupted):
            motion.wait()
        arrivals = subscription.take_arrivals(0.5)
        # When later samples of both robots have arrived, the recorder has received the publications above, too.
        until(
            lambda: {SIM, HW} <= {(a.robot, a.side) for a in subscription.take_arrivals(0.5)},
            "positions of both",
        )
    assert process.end(signal.SIGTERM) == 0
    published: dict[tuple[str, str], list[Positions]] = {SIM: [], HW: []}
    for arrival in arrivals:
        published[arrival.robot, arrival.side].append(arrival.value)
    return Lesson(path, read(path), published, process.lines)


def test_a_recorder_killed_after_seconds_loses_no_more_than_one(
    stage: Stage, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "killed.rrd"
    process = stage.recorder(path, "--name", "bea", "--cameras", "0")
    process.expect_all("Recording bea (hw).", "Recording bea (sim).")
    with positions(stage.client("witness"), "bea", "hw") as subscription:
        begun = subscription.next(1.0).t_wall_ns
        until(
            lambda: subscription.latest is not None and subscription.latest.t_wall_ns > begun + 1_500_000_000,
            "1.5 s",
        )
        last = subscription.take()[-1]
        process.end(signal.SIGKILL)
    assert verify(path) != ""
    assert app.run(["record", "--repair", str(path)]) == 0
    assert capsys.readouterr().out.startswith(f"{path} is repaired")
    assert verify(path) == ""
    assert path.with_name("killed.rrd.damaged").exists()
    assert read(path).robots[HW].robot_ns[-1] > last.t_wall_ns - 1_000_000_000
    assert app.run(["record", "--repair", str(path)]) == 0
    assert capsys.readouterr().out.startswith(f"{path} is complete: there is nothing to repair")


def test_the_file_is_complete(lesson: Lesson) -> None:
    assert verify(lesson.path) == ""
    assert read_sound([lesson.path], [SIM], 0, 2**62) == {}, "microphones stay off without --sound"
    assert lesson.output[-1].startswith(f"{lesson.path}: ")
    for line in lesson.output:  # a busy computer may lose pictures
        assert not re.search(r"(positions|events|states) (were|have)", line)


def test_every_published_sample_is_in_the_file(lesson: Lesson) -> None:
    for place, published in lesson.published.items():
        samples = lesson.recorded.robots[place]
        assert len(published) > 30
        written = {stamp: row for row, stamp in enumerate(samples.robot_ns.tolist())}
        assert {message.t_wall_ns for message in published} <= written.keys()
        for message in published:
            row, arms = written[message.t_wall_ns], message.position
            np.testing.assert_allclose(samples.arms[row], np.degrees([arms.x, arms.y, arms.z]), atol=1e-9)


def test_the_code_of_the_page_reads_a_recording(
    lesson: Lesson, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    shutil.copy(lesson.path, "lesson.rrd")
    (block,) = re.findall(r"```python\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)
    exec(block, {})
    assert re.search(r"^bea sim \d+ samples; at the end: \[", capsys.readouterr().out, re.MULTILINE)


@pytest.mark.long("records for eight seconds")
def test_rotated_files_are_complete(stage: Stage, tmp_path: Path) -> None:
    path = tmp_path / "day.rrd"
    options = "--rotate 0.1 --seconds 8 --cameras 0 --json"
    output = Shell(stage.endpoint).good("record", str(path), *options.split())
    first, second = (tmp_path / name for name in ("day-001.rrd", "day-002.rrd"))
    assert '"dropped":0' in output
    assert verify(first) == verify(second) == ""
    assert not path.exists()
    one, two = (read(file).robots[SIM].time_ns for file in (first, second))
    assert 0 < two[0] - one[-1] < 60_000_000  # no sample is lost between the files
    assert recorded_values(second, "/".join((*SIM, "state")), STATE)  # each file contains the state


@pytest.mark.long("starts a robot twice")
def test_a_robot_may_leave_and_return_during_a_recording(stage: Stage, tmp_path: Path) -> None:
    path = tmp_path / "guest.rrd"
    process = stage.recorder(path, "--name", "guest", "--cameras", "0")
    for _ in range(2):
        guest = stage.hardware("guest")
        with positions(stage.client("witness"), "guest") as subscription:
            until(lambda subscription=subscription: len(subscription.take(0.5)) > 0, "positions")  # type: ignore[misc]
            guest.end()
            until(lambda subscription=subscription: not subscription.take(0.8), "silence")  # type: ignore[misc]
    process.expect("Recording guest (hw).")
    assert process.end(signal.SIGTERM) == 0
    recorded = read(path)
    assert list(recorded.robots) == [("guest", "hw")]
    states = recorded_values(path, "guest/hw/state", STATE)
    # A busy computer may be silent for long enough to count as lost once more.
    assert states.count("lost") >= 2
    assert states[::2] == ["disabled"] * (len(states) // 2)
    assert states[1::2] == ["lost"] * (len(states) // 2)
    gaps = np.diff(recorded.robots["guest", "hw"].time_ns)
    assert np.max(gaps) > 500_000_000


def test_a_recording_without_robots_is_reported(stage: Stage, tmp_path: Path) -> None:
    words = ("record", str(tmp_path / "none.rrd"), "--name", "absent", "--seconds", "0.2")
    done = Shell(stage.endpoint).run(*words)
    assert (done.returncode, "No robot was online" in done.stderr) == (5, True)
