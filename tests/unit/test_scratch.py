"""Temporary folders of checks: old ones of killed checks are removed, and nothing else."""

from __future__ import annotations

import os
import time
from pathlib import Path

import pytest

from beatrix_zenoh.lessons.sandbox import OLD_S, PREFIX, scratch


def test_folders_that_a_killed_check_has_left_are_removed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    for name in (f"{PREFIX}killed", f"{PREFIX}running", "another"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "program.py").touch()
    (tmp_path / f"{PREFIX}link").symlink_to(tmp_path / "another")
    (tmp_path / f"{PREFIX}file").touch()
    long_ago = time.time() - OLD_S - 60
    for path in tmp_path.iterdir():
        if path.name != f"{PREFIX}running":
            os.utime(path, (long_ago, long_ago), follow_symlinks=False)
    with scratch() as folder:
        assert folder.parent == tmp_path
    assert {path.name for path in tmp_path.iterdir()} == {
        "another",
        f"{PREFIX}running",
        f"{PREFIX}link",
        f"{PREFIX}file",
    }
    assert (tmp_path / "another/program.py").exists()
