"""Files of recordings: complete after close, never overwritten, ended in time on a full disk."""

from __future__ import annotations

import time
import warnings
from collections import Counter
from pathlib import Path

import numpy as np
import pytest
from rerun.chunk import RrdReader
from rerun.error_utils import RerunWarning

from beatrix_zenoh.body.figure import Figure
from beatrix_zenoh.contract.errors import Refused
from beatrix_zenoh.recording import outputs
from beatrix_zenoh.recording.outputs import FileOutput
from beatrix_zenoh.recording.rows import Frame, Numbers, RecordingRow, RobotSet, Say, of_robot
from beatrix_zenoh.recording.rrd.read import read
from beatrix_zenoh.recording.viewer import verify

SIM = ("bea", "sim")
BEGAN_NS = 1_763_000_000_000_000_000


def sample(index: int, values: tuple[float, ...] = (0.0, 0.0, 0.0)) -> list[RecordingRow]:
    """Return the rows of the sample with this index."""
    time_ns = BEGAN_NS + index * 20_000_000
    return [Numbers(of_robot(SIM, what), time_ns, time_ns, values) for what in ("arms", "commanded", "head")]


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
                self.output.write(sample(self.samples, tuple(values)))
                self.samples += 1
            now_ns = BEGAN_NS + self.samples * 20_000_000
            self.output.write([
                Frame(of_robot(SIM, "camera", "left"), now_ns, now_ns, picture) for picture in pictures
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
    """Until the end of a file Rerun keeps 1.4 kB of memory for each chunk, and a chunk takes 0.3 kB beside its rows."""
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
