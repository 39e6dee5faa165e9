"""Files of recordings: complete after close, never overwritten, ended in time on a full disk."""

from __future__ import annotations

from pathlib import Path

import pytest

from beatrix_zenoh.contract.errors import Refused
from beatrix_zenoh.recording import outputs
from beatrix_zenoh.recording.figure import Figure
from beatrix_zenoh.recording.outputs import FileOutput
from beatrix_zenoh.recording.rows import Numbers, RecordingRow, RobotSet, of_robot
from beatrix_zenoh.recording.rrd.read import read
from beatrix_zenoh.recording.viewer import verify

SIM = ("bea", "sim")
BEGAN_NS = 1_763_000_000_000_000_000


def sample(index: int) -> list[RecordingRow]:
    """Return the rows of the sample with this index."""
    time_ns = BEGAN_NS + index * 20_000_000
    return [
        Numbers(of_robot(SIM, what), time_ns, time_ns, (0.0, 0.0, 0.0))
        for what in ("arms", "commanded", "head")
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
