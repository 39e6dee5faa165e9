"""Locks on files between the processes that run tests; none on Windows, where one process runs them."""

from __future__ import annotations

import sys
from typing import IO, Any

if sys.platform != "win32":
    import fcntl


def lock(file: IO[Any], *, shared: bool = False) -> None:
    """Wait until no other process has a lock on this file (`shared`: one that is not shared); it ends with the file."""
    if sys.platform != "win32":
        fcntl.flock(file, fcntl.LOCK_SH if shared else fcntl.LOCK_EX)
