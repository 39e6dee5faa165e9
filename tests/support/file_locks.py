"""File locks between the processes of `make test`, so that a test can have the computer for itself."""

from __future__ import annotations

import contextlib
import fcntl
from collections.abc import Iterator
from pathlib import Path


class Turns:
    """Lets tests run in parallel, and a test that needs exclusive use of the computer run by itself.

    Such a test waits for the running tests, and later tests wait for it. The system frees the locks of a process that
    is killed, and pytest-timeout ends one that hangs.
    """

    def __init__(self, folder: Path) -> None:
        """Use two files in `folder`, which is the same for all processes."""
        self._next, self._running = folder / "next.lock", folder / "running.lock"

    @contextlib.contextmanager
    def turn(self, *, alone: bool) -> Iterator[None]:
        """Wait for the turn of a test, and keep it until the block ends."""
        with self._running.open("w") as running:
            with self._next.open("w") as begins:
                # Without this lock, new tests could delay a test that needs exclusive use indefinitely.
                fcntl.flock(begins, fcntl.LOCK_EX)
                fcntl.flock(running, fcntl.LOCK_EX if alone else fcntl.LOCK_SH)
            yield
