"""A pupil's program as it is read, and what a record counts: no check, no robot."""

from __future__ import annotations

from pathlib import Path

import pytest

from beatrix_zenoh.contract.errors import Refused
from beatrix_zenoh.lessons import bench, program, progress
from beatrix_zenoh.lessons.checking import Result, Verdict, count


@pytest.mark.parametrize(
    ("figures", "stuck"),
    [("aaaaa", 5), ("aab", 1), ("ababa", 4), ("abcab", 3), ("abcabd", 1), ("aa-", 0), ("aa-a", 1)],
    ids=["the same", "progress", "back and forth", "in a circle", "out of it", "passed", "again"],
)
def test_a_seat_is_stuck_while_checks_find_nothing_new(tmp_path: Path, figures: str, stuck: int) -> None:
    (tmp_path / "start.py").write_text("")
    checked_program = program.read(tmp_path / "start.py")
    record = progress.Record()
    for figure in figures:
        passed = figure == "-"
        verdict = Verdict(Result.PASSED) if passed else Verdict(Result.NOT_YET, figure)
        count(record, verdict, checked_program.sha256)
    assert (record.tries, record.stuck) == (len(figures), stuck)


def test_a_bench_that_cannot_be_loaded_says_why(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(bench, "MODULE", "not_installed.bench")
    with pytest.raises(Refused, match=r"No module named 'not_installed'.*beatrix install sim"):
        bench.start(None)
