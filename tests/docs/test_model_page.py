"""The commands and the program of the page about MJCF and URDF run as printed."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from beatrix_zenoh.cli import app

PAGE = Path(__file__).resolve().parents[2] / "docs/how-to/model.md"


def test_the_commands_write_what_the_program_loads(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    text = PAGE.read_text(encoding="utf-8")
    (commands,), (program,) = (
        re.findall(rf"```{kind}\n(.*?)```", text, re.DOTALL) for kind in ("sh", "python")
    )
    monkeypatch.chdir(tmp_path)
    for line in commands.splitlines():
        assert app.run(line.partition("#")[0].split()[1:]) == 0
    capsys.readouterr()
    exec(program, {})
    printed = capsys.readouterr().out.strip()
    assert program.rstrip().endswith(f"# {printed}")
