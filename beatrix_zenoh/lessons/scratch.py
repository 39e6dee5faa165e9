"""Temporary folders of checks and turns; those of killed ones are removed later."""

from __future__ import annotations

import contextlib
import os
import shutil
import stat
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Final

from beatrix_zenoh import files
from beatrix_zenoh.contract.errors import Refused

PREFIX: Final = "beatrix-lesson-"
"""Beginning of the names of these folders, and of those of the simulations of a check."""
OLD_S: Final = 24 * 3600.0
"""Age (s) of a folder that no check or turn uses any longer."""
FRESH_S: Final = 10.0
"""Age (s) until which the process that has made a folder may not have locked it yet."""
LOCK: Final = ".lock"
"""The file of a folder that its process locks as long as it uses the folder; the system ends the lock of a killed one."""


@contextlib.contextmanager
def scratch() -> Iterator[Path]:
    """Yield a folder that is deleted at the end of the block, and delete those that killed processes have left."""
    remove_old()
    with tempfile.TemporaryDirectory(prefix=PREFIX) as folder:
        path = Path(folder)
        with files.locked(path / LOCK, f"{path} is in use"):
            yield path


def remove_old() -> None:
    """Delete this user's folders whose process has ended, and those without a lock that are older than OLD_S."""
    for path in Path(tempfile.gettempdir()).glob(f"{PREFIX}*"):
        with contextlib.suppress(OSError):  # another check has deleted it
            found = path.lstat()
            own = (
                sys.platform == "win32" or found.st_uid == os.getuid()
            )  # there it is in the user's own folder
            if own and stat.S_ISDIR(found.st_mode) and _is_left(path, time.time() - found.st_mtime):
                shutil.rmtree(path, ignore_errors=True)


def _is_left(path: Path, age_s: float) -> bool:
    """Return whether no process uses a folder; a folder of simulations has no lock, so only its age tells."""
    lock = path / LOCK
    if not lock.is_file():
        return age_s > OLD_S
    if age_s < FRESH_S:
        return False
    try:
        with files.locked(lock, ""):
            return True
    except Refused:
        return False
