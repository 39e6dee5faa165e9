"""Lessons of the window: child processes that start one, give a hint, and check at each save until STOP."""

from __future__ import annotations

import time
from pathlib import Path

import pytest
from robots import PATIENCE_S, until

from gui.console.link.jobs import Jobs
from gui.console.link.lesson_runs import LessonRuns
from gui.console.state.actions import RunLesson


def test_a_lesson_is_started_hinted_and_checked_until_stop(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    jobs = Jobs("test")
    runs = LessonRuns(jobs)
    runs.do(RunLesson("hint", 1))
    until(lambda: "lesson start 1" in runs.newest.note, "the refusal of a hint")
    runs.do(RunLesson("start", 1, "de"))
    until(lambda: "01-hello" in runs.newest.programs, "the start of the lesson")
    program = Path(runs.newest.programs["01-hello"])
    assert program == tmp_path / "lessons/01-hello/start.py"
    program.write_text("if x\n")
    runs.do(RunLesson("watch", 1))
    runs.do(RunLesson("hint", 1))
    until(lambda: runs.newest.report.outcome == "not_yet", "the verdict")
    assert "SyntaxError" in runs.newest.report.found
    until(lambda: runs.newest.hint.startswith("Hinweis"), "the hint")
    assert runs.newest.watched == 1
    runs.end()
    until(lambda: runs.newest.watched == 0, "the end of the check")
    jobs.close()
    jobs.join(time.monotonic() + PATIENCE_S)
