"""Files of recordings: complete after close, never overwritten, ended in time on a full disk; all rows are read."""

from __future__ import annotations

import time
import warnings
from collections import Counter
from pathlib import Path

import msgspec
import numpy as np
import pytest
from golden import same
from recorded_values import SCALARS, STATE, TEXT, recorded_values
from rerun.chunk import RrdReader
from rerun.error_utils import RerunWarning
from written_recordings import BEGAN_NS, STEP_NS, write_lesson

from beatrix_zenoh.body.figure import Figure
from beatrix_zenoh.client.session import Place
from beatrix_zenoh.contract._generated.messages import Info, LimitInfo
from beatrix_zenoh.contract.errors import Refused
from beatrix_zenoh.recording import outputs
from beatrix_zenoh.recording.outputs import FileOutput
from beatrix_zenoh.recording.rows import (
    Bar,
    Frame,
    Line,
    Numbers,
    RecordingRow,
    RobotSet,
    Say,
    of_difference,
    of_robot,
)
from beatrix_zenoh.recording.rrd.read import read, read_about
from beatrix_zenoh.recording.rrd.stream import RowStream
from beatrix_zenoh.recording.samples import About
from beatrix_zenoh.recording.viewer import verify

SIM, HW = ("bea", "sim"), ("bea", "hw")


def sample(index: int, place: Place = SIM, values: tuple[float, ...] | None = None) -> list[RecordingRow]:
    """Return the rows of the sample with this index, which the robot has published 7 ns earlier."""
    time_ns = BEGAN_NS + index * STEP_NS
    values = (index, 0.0, -index) if values is None else values
    return [
        Numbers(of_robot(place, what), time_ns, values, time_ns - 7) for what in ("arms", "commanded", "head")
    ]


@pytest.fixture
def messages() -> list[str]:
    return []


def test_an_existing_file_is_not_overwritten(tmp_path: Path, messages: list[str]) -> None:
    (tmp_path / "day-002.rrd").write_bytes(b"yesterday")
    with pytest.raises(Refused, match="exists and is not overwritten"):
        FileOutput(tmp_path / "day-002.rrd", messages.append)
    output = FileOutput(tmp_path / "day.rrd", messages.append, rotate_s=1.0)
    assert output.update(1e6)
    assert output.close()
    assert [path.name for path in output.files] == ["day-001.rrd", "day-003.rrd"]
    assert (tmp_path / "day-002.rrd").read_bytes() == b"yesterday"


def test_a_full_disk_ends_the_recording_with_a_complete_file(
    tmp_path: Path, messages: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    output = FileOutput(tmp_path / "lesson.rrd", messages.append)
    output.show(RobotSet({SIM: Figure()}))
    output.write(sample(0))
    monkeypatch.setattr(outputs, "SPARE_BYTES", 1 << 60)
    output.update(1e6)
    assert output.full
    assert len(messages) == 1
    assert "MB are left on this disk" in messages[0]
    output.write(sample(1))
    assert output.close()
    assert len(messages) == 1, "the end does not repeat it with another figure"
    assert verify(tmp_path / "lesson.rrd") == ""
    assert len(read(tmp_path / "lesson.rrd").robots[SIM].time_ns) == 1


class Recorded:
    """A file of samples at 50 Hz, recorded as fast as it goes: `update` gets the time at which they would arrive."""

    def __init__(self, path: Path, say: Say) -> None:
        self.path, self.output = path, FileOutput(path, say)
        self.output.show(RobotSet({SIM: Figure()}))
        self.length = path.stat().st_size
        """bytes before the samples"""
        self.samples, self._began_s = 0, time.monotonic()
        self._random = np.random.default_rng(1)

    def until(self, passed_s: float, *pictures: bytes) -> None:
        """Record until this time after the begin, with these pictures in each half second."""
        while self.samples < passed_s * 50:
            for values in np.degrees(self._random.normal(0.0, 0.5, (25, 3)).astype(np.float32)).tolist():
                self.output.write(sample(self.samples, values=tuple(values)))
                self.samples += 1
            now_ns = BEGAN_NS + self.samples * STEP_NS
            self.output.write([
                Frame(of_robot(SIM, "camera", "left"), now_ns, picture) for picture in pictures
            ])  # fmt: skip
            self.output.update(self._began_s + self.samples / 50)

    @property
    def chunks(self) -> Counter[str]:
        """Number of chunks of each entity that have times, so far."""
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", RerunWarning)  # the file has no end yet
            chunks = RrdReader(self.path).stream()
        return Counter(chunk.entity_path for chunk in chunks if not chunk.is_static)


def test_chunks_become_few_in_a_long_recording(tmp_path: Path, messages: list[str]) -> None:
    """Until the end of a file Rerun keeps 1 kB of memory for each chunk, and a chunk takes 0.3 kB beside its rows."""
    recorded = Recorded(tmp_path / "long.rrd", messages.append)
    recorded.until(300.0)
    first, length = recorded.chunks, recorded.path.stat().st_size
    assert max(first.values()) < 60
    assert (length - recorded.length) / (3 * recorded.samples) < 50, "bytes of a row of three numbers"
    recorded.until(600.0)
    assert max((recorded.chunks - first).values()) <= 8, "chunks of an entity in five minutes"
    before = recorded.path.stat().st_size
    assert recorded.output.close()
    written = recorded.path.stat().st_size - before
    assert written < 1_000_000, "the end writes a minute of rows and a table of the chunks"
    assert len(read(recorded.path).robots[SIM].time_ns) == recorded.samples
    assert verify(recorded.path) == ""


@pytest.mark.parametrize(("passed_s", "lost_s"), [(2.0, 0.5), (700.0, 61.0)])
def test_a_killed_recorder_loses_a_tenth_and_at_most_a_minute(
    tmp_path: Path, messages: list[str], passed_s: float, lost_s: float
) -> None:
    recorded = Recorded(tmp_path / "killed.rrd", messages.append)
    recorded.until(passed_s)
    assert len(read(recorded.path).robots[SIM].time_ns) > (passed_s - lost_s) * 50
    assert recorded.output.close()


# -- what is read ---------------------------------------------------------------------------------


def test_samples_events_states_and_differences_are_written_and_read(tmp_path: Path) -> None:
    path = tmp_path / "lesson.rrd"
    other = [
        Line(of_robot(SIM, "events"), BEGAN_NS, "ana stop: At rest.", "ERROR"),
        Line(of_robot(SIM, "events"), BEGAN_NS, "ben look: Refused.", "WARN"),  # at the same time
        Bar(of_robot(SIM, "state"), BEGAN_NS, "ready"),
        Bar(of_robot(SIM, "state"), BEGAN_NS + STEP_NS, "moving"),
        Numbers(of_difference("bea", "arms"), BEGAN_NS, (1.0, 2.0, 3.0)),
    ]
    samples = [row for index in range(10) for place in (SIM, HW) for row in sample(index, place)]
    write_lesson(path, [SIM, HW], 0, [*samples, *other])
    assert verify(path) == ""
    recorded = read(path)
    assert list(recorded.robots) == [HW, SIM]
    for found in recorded.robots.values():
        assert found.time_ns.tolist() == [BEGAN_NS + index * STEP_NS for index in range(10)]
        assert found.robot_ns.tolist() == [BEGAN_NS + index * STEP_NS - 7 for index in range(10)]
        for angles in (found.arms, found.commanded, found.head):
            np.testing.assert_array_equal(angles, [(index, 0.0, -index) for index in range(10)])
        assert np.isnan(found.head_measured).all()
    for entity, component, values in (
        (of_robot(SIM, "events"), TEXT, ["ana stop: At rest.", "ben look: Refused."]),
        (of_robot(SIM, "state"), STATE, ["ready", "moving"]),
        (of_difference("bea", "arms"), SCALARS, [1.0, 2.0, 3.0]),
    ):
        assert recorded_values(path, entity, component) == values


def test_a_recording_says_what_it_is(tmp_path: Path) -> None:
    """A later description replaces an earlier one, as robots and seats come."""
    path = tmp_path / "lesson.rrd"
    first = About(BEGAN_NS, "0.1.0", "abc", "Lesson 2", "trial 3", "ana")
    limits = LimitInfo(
        tilt_max=0.6, gap_min=0.5, yaw_max=3.1, speed_default=1.0, speed_max=1.5, acceleration=3.0
    )
    info = Info(
        robot="bea", side="sim", version="0.1.0", contract="abc", firmware="1.2.0", steps_per_turn=4184.6,
        arms=[], limits=limits, fingerprint="0123abcd", commands=[], reasons=[],
        keys=[], examples=[],
    )  # fmt: skip
    last = first.with_seat("ben").with_seat("ana").with_seat("").with_robot(SIM, info).with_robot(SIM, info)
    stream = RowStream("one", path.stem)
    stream.to_file(path)
    stream.describe(first)
    stream.send([*sample(0), Numbers(of_robot(SIM, "clock"), BEGAN_NS, (-12.5, 0.25))])
    assert stream.flush(30.0)
    stream.describe(last)
    assert stream.flush(30.0)
    stream.close()
    recorded = read(path)
    assert recorded.about == last
    assert last.seats == ("ana", "ben")
    assert [str(robot) for robot in last.robots] == [
        "bea (sim): beatrix 0.1.0, firmware 1.2.0, contract abc, robot file 0123abcd"
    ]
    assert recorded_values(path, of_robot(SIM, "clock"), SCALARS) == [-12.5, 0.25]
    assert read_about(path) == last
    assert last.lines() == [
        "Lesson 2, begun 2025-11-13 02:13:20 UTC by ana with beatrix 0.1.0.",
        "Note: trial 3",
        "bea (sim): beatrix 0.1.0, firmware 1.2.0, contract abc, robot file 0123abcd.",
        "Requests and notes came from ana, ben.",
    ]
    other = msgspec.structs.replace(info, fingerprint="fedc")
    (warning,) = last.with_robot(HW, other).with_robot(("ada", "hw"), other).warnings()
    same("recording read.a recording says what it is", warning)


def test_a_file_that_is_no_recording_of_positions_is_refused(tmp_path: Path) -> None:
    for name, content, words in (
        ("missing.rrd", None, "there is no such file"),
        ("text.rrd", "no recording", "is not a recording"),
        ("nothing.rrd", "", "is empty"),
        ("mine.csv", "t_s,yaw_deg,pitch_deg,roll_deg\n", "is a motion file.* use `beatrix replay"),
        ("empty.rrd", None, "no positions"),
    ):
        if content is not None:
            (tmp_path / name).write_text(content)
        elif name == "empty.rrd":
            write_lesson(tmp_path / name, [], 0)
        with pytest.raises(Refused, match=words) as refused:
            read(tmp_path / name)
        assert "--repair" not in str(refused.value)
