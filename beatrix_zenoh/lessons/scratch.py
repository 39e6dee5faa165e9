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

PREFIX: Final = "beatrix-lesson-"
"""Beginning of the names of these folders, and of those of the simulations of a check."""
OLD_S: Final = 24 * 3600.0
"""Age (s) of a folder that no check or turn uses any longer."""


@contextlib.contextmanager
def scratch() -> Iterator[Path]:
    """Yield a folder that is deleted at the end of the block, and delete those that killed processes have left."""
    remove_old()
    with tempfile.TemporaryDirectory(prefix=PREFIX) as folder:
        yield Path(folder)


def remove_old() -> None:
    """Delete this user's folders that are older than OLD_S."""
    for path in Path(tempfile.gettempdir()).glob(f"{PREFIX}*"):
        with contextlib.suppress(OSError):  # another check has deleted it
            found = path.lstat()
            own = (
                sys.platform == "win32" or found.st_uid == os.getuid()
            )  # there it is in the user's own folder
            if own and stat.S_ISDIR(found.st_mode) and time.time() - found.st_mtime > OLD_S:
                shutil.rmtree(path, ignore_errors=True)
