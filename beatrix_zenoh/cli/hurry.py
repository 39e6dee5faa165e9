"""Ctrl-C while there is nothing to undo: a program is still importing itself."""

from __future__ import annotations

import os
import signal
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

INTERRUPTED = 130
"""Exit code that shells give to Ctrl-C."""


@contextmanager
def nothing_to_undo() -> Iterator[None]:
    """In here Ctrl-C ends the process at once.

    A KeyboardInterrupt would come out of somebody's half-done import: as another error, or as words
    of Python's own.
    """
    before = signal.getsignal(signal.SIGINT)
    if before is not signal.default_int_handler:  # somebody has decided already, as a shell does for its `&`
        yield
        return
    signal.signal(signal.SIGINT, leave)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)


def leave(_signal: int, _frame: FrameType | None) -> None:
    """End without a word."""
    os._exit(INTERRUPTED)
