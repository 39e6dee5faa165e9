"""`beatrix export`: files for pandas and spreadsheets, and refusals of tables, films and sounds."""

from __future__ import annotations

import shutil
import signal
from pathlib import Path

import pandas as pd
import pytest
from shell import settings_of_this_process
from written_recordings import BEGAN_NS, times, write_lesson

from beatrix_zenoh.cli import app
from beatrix_zenoh.recording import export
from beatrix_zenoh.recording.rows import Frame, RecordingRow, SoundRow
from beatrix_zenoh.recording.rrd.read import read
from beatrix_zenoh.shutdown import SIGNALS

PLACES = ("ada", "sim"), ("ada", "hw"), ("bob", "sim")
NOT_READ = b"no picture"


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A recording of 6 s of two robots, one of them without hardware; both sides of the other one see and hear."""
    path = tmp_path_factory.mktemp("lesson") / "lesson.rrd"
    more: list[RecordingRow] = [Frame("ada/sim/camera/left", BEGAN_NS, NOT_READ)]
    for side in ("sim", "hw"):
        more += [Frame(f"ada/{side}/camera/right", at, NOT_READ) for at in times(2)]
        more.append(SoundRow(f"ada/{side}/microphones", BEGAN_NS, bytes(3840), 48_000, 0))
    write_lesson(path, PLACES, more=more)
    return path


@pytest.fixture
def lesson(written: Path, tmp_path: Path) -> Path:
    """The recording, alone in a folder."""
    return Path(shutil.copy(written, tmp_path))


def test_csv_and_parquet_hold_the_same_table(lesson: Path, capsys: pytest.CaptureFixture[str]) -> None:
    csv, parquet = lesson.with_suffix(".csv"), lesson.with_suffix(".parquet")
    assert app.run(["export", str(lesson), str(csv)]) == 0
    assert capsys.readouterr().out == f"{csv}: 300 rows of ada (hw), ada (sim), bob (sim).\n"
    assert app.run(["export", str(lesson), str(parquet)]) == 0
    pd.testing.assert_frame_equal(pd.read_csv(csv), pd.read_parquet(parquet), check_exact=True)
    rows = pd.read_csv(csv)
    assert rows.time_s.iloc[0] == 0.0
    assert rows.time_s.iloc[-1] == 5.98
    last = read(lesson).robots["ada", "hw"].arms[-1, 1]
    assert rows.ada_hw_middle_deg.iloc[-1] == pytest.approx(last, abs=1e-6)
    text = csv.read_bytes()
    assert text.startswith(b"time_s,unix_time_s,ada_hw_short_deg,")
    assert text.isascii()
    assert b"\r" not in text


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_a_signal_leaves_no_incomplete_file(
    lesson: Path, number: signal.Signals, monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupted(path: Path, _blocks: object) -> int:
        path.write_text("time_s,")
        signal.raise_signal(number)
        return 1

    monkeypatch.setattr(export, "write_table", interrupted)
    with settings_of_this_process():
        for each in SIGNALS:
            signal.signal(each, lambda _signal, _frame: None)
        assert app.run(["export", str(lesson), str(lesson.with_suffix(".csv"))]) == 130
    assert [path.name for path in lesson.parent.iterdir()] == ["lesson.rrd"]


@pytest.mark.parametrize(
    ("words", "code", "says"),
    [
        ("lesson.csv", 2, "lesson.csv is not the name of a recording"),
        ("lesson.rrd", 2, "must end with .csv, .parquet or .mcap"),
        ("lesson.rrd lesson.xlsx", 2, "must end with .csv, .parquet or .mcap"),
        ("lesson.rrd lesson.mp4", 2, "A film is named by --video"),
        ("lesson.rrd lesson.wav", 2, "a sound by --sound FILE.wav"),
        ("new.csv lesson.rrd", 2, "named last"),
        ("lesson.rrd ./lesson.rrd new.csv", 1, "contain the same time of ada (sim)"),
        ("lesson.rrd new.csv --from 3 --to 2", 2, "--to 2 is before --from 3"),
        ("lesson.rrd new.csv --to nan", 2, "nan is not a finite number"),
        ("lesson.rrd kept.csv", 1, "kept.csv exists and is not overwritten"),
        ("lesson.rrd new.csv --from 7", 1, "lasts 6.0 s"),
        ("lesson.rrd new.csv --from 1.001 --to 1.002", 1, "no samples are in this part"),
        ("lesson.rrd new.csv --name cleo", 1, "contains ada, bob, and not cleo"),
        ("lesson.rrd missing/new.csv", 1, "cannot be written: No such file"),
        ("missing.rrd new.csv", 2, "there is no such file. The recordings there: lesson.rrd."),
        ("lesson.rrd --eye left", 2, "--eye needs --video FILE.mp4"),
        ("lesson.rrd --video new.avi", 2, "must end in .mp4"),
        ("lesson.rrd --video new.mp4 --on hw", 2, "--on chooses the robot of --eye or --sound"),
        ("lesson.rrd --video new.mp4", 1, "positions of ada (sim), bob (sim): choose one robot with --name"),
        ("lesson.rrd --video new.mp4 --name ada --eye right", 1, "pictures of the right eye (`record --cameras 5`) of ada (hw), ada (sim): choose one robot"),
        ("lesson.rrd --video new.mp4 --name ada --eye left --on hw", 1, "pictures of the left eye (`record --cameras 5`) of ada (sim): choose"),
        ("lesson.rrd --video new.mp4 --name ada --eye left --from 1", 1, "of no robot"),
        ("lesson.rrd --video new.mp4 --name ada --eye left", 1, "this span contains no whole picture"),
        ("lesson.rrd --sound new.wav", 1, "of ada (hw), ada (sim): choose one robot with --name, and --on"),
        ("lesson.rrd --sound new.wav --name bob", 1, "the sound (`record --sound`) of no robot"),
    ],
)  # fmt: skip
def test_refusals_name_the_cure_and_write_nothing(
    lesson: Path, words: str, code: int, says: str, monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:  # fmt: skip
    monkeypatch.chdir(lesson.parent)
    Path("kept.csv").write_text("mine")
    assert app.run(["export", *words.split()]) == code
    assert says in " ".join(capsys.readouterr().err.split())
    assert sorted(path.name for path in lesson.parent.iterdir()) == ["kept.csv", "lesson.rrd"]
    assert Path("kept.csv").read_text() == "mine"
