"""Files that are written completely or not at all, also on a full disk."""

from __future__ import annotations

import resource
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from beatrix_zenoh.contract.errors import Refused
from beatrix_zenoh.files import new_file

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
    path = tmp_path / "demo.rrd"
    path.write_text("old")
    with full_disk(), pytest.raises(Refused, match="cannot be written"), new_file(path) as unfinished:
        unfinished.write_bytes(bytes(2 * SMALL))
    assert {found.name: found.read_text() for found in tmp_path.iterdir()} == {"demo.rrd": "old"}


def test_an_existing_file_is_replaced_by_a_complete_one(tmp_path: Path) -> None:
    path = tmp_path / "demo.rrd"
    path.write_text("old")
    with new_file(path) as unfinished:
        unfinished.write_text("new")
    assert {found.name: found.read_text() for found in tmp_path.iterdir()} == {"demo.rrd": "new"}
