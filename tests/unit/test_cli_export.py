"""`beatrix export`: files for pandas and spreadsheets, and refusals."""

from __future__ import annotations

import json
import shutil
import signal
from pathlib import Path

import pandas as pd
import pytest
import written_recordings
from shell import settings_of_this_process
from written_recordings import BEGAN_NS, write_lesson

from beatrix_zenoh.cli import app
from beatrix_zenoh.recording import export
from beatrix_zenoh.recording.rrd.read import read
from beatrix_zenoh.shutdown import SIGNALS

PLACES = ("ada", "sim"), ("ada", "hw"), ("bob", "sim")


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A recording of 6 s of two robots, one of them without hardware."""
    path = tmp_path_factory.mktemp("lesson") / "lesson.rrd"
    write_lesson(path, PLACES)
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


def test_the_pauses_between_files_are_named(
    lesson: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    later, csv = lesson.with_name("later.rrd"), lesson.with_suffix(".csv")
    monkeypatch.setattr(written_recordings, "BEGAN_NS", BEGAN_NS + 10_500_000_000)
    write_lesson(later, PLACES, rows=50)
    assert app.run(["export", str(lesson), str(later), str(csv)]) == 0
    assert capsys.readouterr().out.splitlines() == [
        f"{csv}: 575 rows of ada (hw), ada (sim), bob (sim).",
        "Between the files nothing was recorded: 4.5 s from 6.0 s on.",
    ]
    assert app.run(["export", str(lesson), str(later), str(lesson.with_name("p.csv")), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["pauses"] == [{"from_s": 5.98, "lasts_s": 4.52}]
    assert app.run(["export", str(lesson), str(later), str(lesson.with_name("q.csv")), "--to", "5"]) == 0
    assert "nothing was recorded" not in capsys.readouterr().out


@pytest.mark.parametrize(
    ("words", "code", "says"),
    [
        (["lesson.csv"], 2, "lesson.csv is not the name of a recording"),
        (["lesson.rrd"], 2, "must end with .csv or .parquet"),
        (["lesson.rrd", "lesson.xlsx"], 2, "must end with .csv or .parquet"),
        (["lesson.rrd", "lesson.mp4"], 2, "is the name of a film: write --video lesson.mp4"),
        (["new.csv", "lesson.rrd"], 2, "named last"),
        (["lesson.rrd", "./lesson.rrd", "new.csv"], 2, "given twice"),
        (["lesson.rrd", "new.csv", "--from", "3", "--to", "2"], 2, "--to 2 is before --from 3"),
        (["lesson.rrd", "new.csv", "--to", "nan"], 2, "nan is not a finite number"),
        (["lesson.rrd", "kept.csv"], 1, "kept.csv exists and is not overwritten"),
        (["lesson.rrd", "new.csv", "--from", "7"], 1, "lasts 6.0 s"),
        (["lesson.rrd", "new.csv", "--from", "1.001", "--to", "1.002"], 1, "no samples are in this part"),
        (["lesson.rrd", "new.csv", "--name", "cleo"], 1, "contains ada, bob, and not cleo"),
        (["lesson.rrd", "missing/new.csv"], 1, "cannot be written: No such file"),
        (["missing.rrd", "new.csv"], 2, "there is no such file. The recordings there: lesson.rrd."),
    ],
)
def test_refusals_name_the_cure_and_write_nothing(
    lesson: Path, words: list[str], code: int, says: str, monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:  # fmt: skip
    monkeypatch.chdir(lesson.parent)
    Path("kept.csv").write_text("mine")
    assert app.run(["export", *words]) == code
    assert says in " ".join(capsys.readouterr().err.split())
    assert sorted(path.name for path in lesson.parent.iterdir()) == ["kept.csv", "lesson.rrd"]
    assert Path("kept.csv").read_text() == "mine"


# -- `beatrix record` with the name of another kind of file names the command for it ---------------


@pytest.mark.parametrize(
    ("words", "says", "says_not"),
    [
        (["q.csv"], "To write a motion file for `beatrix replay`, add --motion;", "--repair"),
        (["q.CSV"], "record, and then `beatrix export FILE.rrd q.CSV`.", "--repair"),
        (["q.parquet"], "record, and then `beatrix export FILE.rrd q.parquet`.", "--motion"),
        (["q.mp4"], "it must end with .rrd.", "--motion"),
        (["q.csv", "--repair"], "it must end with .rrd.", "--motion"),
    ],
)
def test_a_wrong_ending_names_the_command_for_it(
    words: list[str], says: str, says_not: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:  # fmt: skip
    monkeypatch.chdir(tmp_path)
    assert app.run(["record", *words]) == 2
    err = " ".join(capsys.readouterr().err.split())
    assert says in err
    assert says_not not in err
    assert list(tmp_path.iterdir()) == []
