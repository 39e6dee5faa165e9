"""Locks of files between the processes of `make test`, so that one test can have the computer for itself."""

from __future__ import annotations

import contextlib
import fcntl
from collections.abc import Iterator
from pathlib import Path


class Turns:
    """Tests run side by side; one that needs the computer alone waits for the running ones, and the next wait for it.

    The system frees the locks of a process that is killed, and pytest-timeout ends one that hangs.
    """

    def __init__(self, folder: Path) -> None:
        """Use two files in `folder`, which is the same for all processes."""
        self._next, self._running = folder / "next.lock", folder / "running.lock"

    @contextlib.contextmanager
    def turn(self, *, alone: bool) -> Iterator[None]:
        """Wait for the turn of a test, and keep it until the block ends."""
        with self._running.open("w") as running:
            with self._next.open("w") as begins:
                fcntl.flock(
                    begins, fcntl.LOCK_EX
                )  # without it, a test that waits alone would never get its turn
                fcntl.flock(running, fcntl.LOCK_EX if alone else fcntl.LOCK_SH)
            yield
