"""`beatrix record` with the name of another kind of file names the command for it."""

from __future__ import annotations

from pathlib import Path

import pytest

from beatrix_zenoh.cli import app


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
