"""Recordings that Rerun's own program has changed, and files of other programs: read, or refused in one sentence."""

from __future__ import annotations

import io
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import rerun as rr
from PIL import Image
from written_recordings import BEGAN_NS, STEP_NS, times, write_lesson

from beatrix_zenoh.cli import app
from beatrix_zenoh.contract.codec import encode_json
from beatrix_zenoh.contract.errors import Refused
from beatrix_zenoh.recording.rows import NOTES, Bar, Frame, Line, Numbers, RecordingRow, SoundRow
from beatrix_zenoh.recording.rrd.read import read, read_about, read_eyes
from beatrix_zenoh.recording.samples import About, Note
from beatrix_zenoh.recording.verbs.files import read_recording
from beatrix_zenoh.recording.viewer import tool, verify

SIM, HW = ("bea", "sim"), ("bea", "hw")
ROWS = 60


def more() -> list[RecordingRow]:
    """Return rows of everything else that a recorder writes; each becomes a chunk."""
    file = io.BytesIO()
    Image.new("RGB", (32, 24)).save(file, "JPEG")
    found: list[RecordingRow] = []
    for index, at in enumerate(times(ROWS)):
        found.append(SoundRow("bea/sim/microphones", at, bytes([index]) * 3840, 48_000, index))
        found += [Numbers(f"{name}/{side}/seq", at, (index,)) for name, side in (SIM, HW)]
        if index % 10 == 3:
            found.append(Frame("bea/sim/camera/left", at, file.getvalue()))
            found.append(Line(NOTES, at, "n", "INFO", encode_json(Note(at, "ana", f"n{index}")).decode()))
            found.append(Line("bea/sim/events", at, f"line {index}", "INFO"))
            found.append(Bar("bea/sim/state", at, f"state {index}"))
            found.append(Numbers("bea/sim/clock", at, (0.5, 0.1)))
    return found


@pytest.fixture(scope="module")
def lesson(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A recording of both robots with everything in it; do not change it."""
    path = tmp_path_factory.mktemp("lesson") / "lesson.rrd"
    write_lesson(path, [SIM, HW], ROWS, more(), About(BEGAN_NS, "0.1.0", title="Lesson"))
    return path


def rerun(*words: object) -> None:
    """Run `rerun rrd`, which must succeed."""
    done = tool("rrd", *map(str, words))
    assert done.returncode == 0, done.stderr


def split(path: Path, folder: Path) -> list[Path]:
    """Cut a recording in three parts."""
    rerun("split", "-o", folder, "--timeline", "time", "-n", "3", path)
    return sorted(folder.glob(f"{path.stem}_*.rrd"))


def changed(verb: str, path: Path, folder: Path, *words: str) -> list[Path]:
    """Let a verb of `rerun rrd` write one file."""
    rerun(verb, *words, path, "-o", folder / "new.rrd")
    return [folder / "new.rrd"]


def repaired(path: Path, folder: Path) -> list[Path]:
    """Complete a recording whose end is missing, with our own verb."""
    copy, whole = folder / "copy.rrd", path.read_bytes()
    copy.write_bytes(whole[: whole.rindex(b"RRF2FOOT") - 30])
    assert verify(copy) != ""
    for _ in range(2):  # afterwards there is nothing to repair
        assert app.run(["record", "--repair", str(copy)]) == 0
        assert verify(copy) == ""
    assert [path.name for path in folder.glob("*.damaged")] == ["copy.rrd.damaged"]
    return [copy]


def merged_parts(path: Path, folder: Path) -> list[Path]:
    rerun("merge", *split(path, folder), "-o", folder / "new.rrd")
    return [folder / "new.rrd"]


WHOLE: dict[str, Callable[[Path, Path], list[Path]]] = {
    "split": split,
    "filter": lambda path, folder: changed("filter", path, folder, "--drop-timeline", "robot_time"),
    "optimize": lambda path, folder: changed("optimize", path, folder),
    "repair": repaired,
    "merge parts": merged_parts,
}  # fmt: skip


def contents(files: list[Path], folder: Path) -> dict[str, object]:
    """Return the table, the sound, the pictures and all samples of a recording."""
    names = [str(path) for path in files]
    assert app.run(["export", *names, str(folder / "grid.csv"), "--sound", str(folder / "sound.wav")]) == 0
    arrays = {
        f"{place} {name}": values.tobytes()
        for place, samples in read(*files).robots.items()
        for name, values in vars(samples).items()
    }
    return {
        "grid": (folder / "grid.csv").read_text(),
        "sound": (folder / "sound.wav").read_bytes(),
        "pictures": {eye: dict(found) for eye, found in read_eyes(files, [SIM, HW], 0, 2**62).items()},
        **arrays,
    }


@pytest.fixture(scope="module")
def wanted(lesson: Path, tmp_path_factory: pytest.TempPathFactory) -> dict[str, object]:
    """The contents of the recording as it was written."""
    found = contents([lesson], tmp_path_factory.mktemp("before"))
    assert [len(pictures) for pictures in found["pictures"].values()] == [6]  # type: ignore[attr-defined]
    return found


@pytest.mark.parametrize("change", WHOLE)
def test_what_rerun_makes_of_a_recording_has_the_rows_of_the_whole(
    lesson: Path, wanted: dict[str, object], tmp_path: Path, change: str
) -> None:
    files = WHOLE[change](lesson, tmp_path)
    found = contents(files, tmp_path)
    changed = {name for name, values in found.items() if values != wanted[name]}
    assert changed == ({f"{place} robot_ns" for place in (SIM, HW)} if change == "filter" else set())
    for file in files:
        part = read_recording(file)
        assert part.about is not None
        assert part.about == read_about(file)
        assert app.run(["compare", str(file), "--json"]) in (0, 1)


def numbers(stream: rr.RecordingStream, entity: str, width: int) -> None:
    """Write 20 rows of zeros."""
    index = rr.TimeColumn("time", timestamp=np.array(times(20)).astype("datetime64[ns]"))
    rows = rr.Scalars.columns(scalars=np.zeros(20 * width)).partition([width] * 20)
    stream.send_columns(entity, [index], rows)


def other(folder: Path, write: Callable[[rr.RecordingStream], None]) -> Path:
    """Let another program write a file."""
    with rr.RecordingStream("other") as stream:
        stream.save(folder / "new.rrd")
        write(stream)
    return folder / "new.rrd"


def merged(lesson: Path, folder: Path, shift_ns: int) -> Path:
    """Merge a recording with another one of the same robot."""
    rows: list[RecordingRow] = [
        Numbers(f"bea/sim/{what}", BEGAN_NS + shift_ns + index * STEP_NS, (1.0, 2.0, 3.0))
        for what in ("arms", "commanded", "head")
        for index in range(100)
    ]
    write_lesson(folder / "other.rrd", [], 0, rows)
    return changed("merge", lesson, folder, str(folder / "other.rrd"))[0]


NO_POSITIONS, FOREIGN = "contains no positions of a robot", "are not as `beatrix record`"
REFUSED: dict[str, tuple[str, Callable[[Path, Path], Path]]] = {
    "filter the time": (NO_POSITIONS, lambda path, folder: changed("filter", path, folder, "--drop-timeline", "time")[0]),
    "merge the same time": ("contain the same time of bea \\(sim\\)", lambda path, folder: merged(path, folder, 7)),
    "merge another day": ("are 24.0 h apart", lambda path, folder: merged(path, folder, 86_400_000_000_000)),
    "points": (NO_POSITIONS, lambda _, folder: other(folder, lambda stream: stream.log("p", rr.Points3D([[1, 2, 3]])))),
    "angles of four arms": (FOREIGN, lambda _, folder: other(folder, lambda stream: numbers(stream, "/x/sim/arms", 4))),
}  # fmt: skip


@pytest.mark.parametrize("case", REFUSED)
def test_a_file_that_is_not_one_recording_is_refused_in_one_sentence(
    lesson: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], case: str
) -> None:
    words, make = REFUSED[case]
    path = make(lesson, tmp_path)
    with pytest.raises(Refused, match=words) as refused:
        read(path)
    assert str(path) in str(refused.value)
    capsys.readouterr()
    for verb in (
        ["export", str(path), str(tmp_path / "a.csv")],
        ["compare", str(path)],
        ["record", "--repair", str(path)],
    ):
        assert app.run(verb) == 1, verb
        assert capsys.readouterr().err == f"{refused.value}\n", verb


def test_what_another_program_adds_or_leaves_out_does_no_harm(lesson: Path, tmp_path: Path) -> None:
    """A file without some entities is read, and entities with other names are not."""
    without = changed(
        "filter", lesson, tmp_path, "--drop-entity", "/bea/sim/head", "--drop-entity", "/bea/hw/seq"
    )
    found = read(without[0])
    assert list(found.robots) == [HW]
    assert found.robots[HW].lost is None
    path = other(tmp_path, lambda stream: numbers(stream, "/bea/sim/more", 7))
    path = path.rename(tmp_path / "more.rrd")
    (both,) = changed("merge", lesson, tmp_path, str(path))
    assert sorted(read(both).robots) == [HW, SIM]
