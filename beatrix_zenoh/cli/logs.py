"""Folders for what child processes write: gone with them, kept if one failed, swept up if nobody could."""

from __future__ import annotations

import contextlib
import os
import shutil
import sys
import tempfile
from pathlib import Path

PREFIX = "beatrix-"
OWNER = "pid"
"""File in a folder that is in use: the number of the process that will delete it."""


def make() -> Path:
    """A new folder of this process."""
    folder = Path(tempfile.mkdtemp(prefix=PREFIX))
    (folder / OWNER).write_text(str(os.getpid()), encoding="ascii")
    return folder


def keep(folder: Path) -> None:
    """Nobody deletes it but who reads it."""
    (folder / OWNER).unlink(missing_ok=True)


def remove(folder: Path) -> None:
    """It has been of no interest."""
    shutil.rmtree(folder, ignore_errors=True)


def sweep() -> None:
    """Delete our folders in use by processes that no longer live: they were killed."""
    if sys.platform == "win32":
        return  # there, asking whether a process lives may end it
    for owner in Path(tempfile.gettempdir()).glob(f"{PREFIX}*/{OWNER}"):
        with contextlib.suppress(OSError, ValueError):  # somebody else sweeps, or is just beginning
            if owner.parent.lstat().st_uid == os.getuid() and not lives(int(owner.read_text("ascii"))):
                remove(owner.parent)


def lives(process: int) -> bool:
    """Say whether a process of this number is there."""
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except PermissionError:
        pass
    return True
