"""Files that are replaced completely or not at all, and the copy of the demo's recording on a full disk."""

from __future__ import annotations

import resource
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from beatrix_zenoh.contract.errors import Refused
from beatrix_zenoh.demo.verbs import RECORDING, copied
from beatrix_zenoh.files import replace_when_complete

SMALL = 2048
"""Largest file on the full disk, bytes."""


@contextmanager
def full_disk() -> Iterator[None]:
    """Limit the size of files in this block; Python raises OSError as on a full disk.

    Not a fixture: coverage writes its data between the phases of a test.
    """
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (SMALL, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)


def test_on_a_full_disk_an_existing_file_remains_and_no_incomplete_one_is_left(tmp_path: Path) -> None:
    new, out = tmp_path / "new.rrd", tmp_path / "out"
    new.write_bytes(bytes(2 * SMALL))
    out.mkdir()
    (out / RECORDING).write_text("old")
    with full_disk(), pytest.raises(Refused, match="could not be written"):
        copied(new, out)
    assert {path.name: path.read_text() for path in out.iterdir()} == {RECORDING: "old"}


def test_an_existing_file_is_replaced_by_a_complete_one(tmp_path: Path) -> None:
    path = tmp_path / "demo.csv"
    path.write_text("old")
    with replace_when_complete(path) as unfinished:
        unfinished.write_text("new")
    assert {path.name: path.read_text() for path in tmp_path.iterdir()} == {"demo.csv": "new"}
