"""Start of the package's threads."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar

PREFIX = "beatrix-"


class Owner:
    """A robot whose work a thread does; a robot that is started anew is another owner of the same name."""

    def __init__(self, name: str) -> None:
        self.name = name


OWNER: ContextVar[Owner | None] = ContextVar("owner", default=None)
"""The robot whose work the present thread does; threads started by `start` inherit it. None: all robots of the process."""


@contextmanager
def owned_by(owner: Owner | None) -> Iterator[None]:
    """Do the work of this robot in a block; None: of all robots."""
    before = OWNER.set(owner)
    try:
        yield
    finally:
        OWNER.reset(before)


def start(work: Callable[[], None], name: str) -> threading.Thread:
    """Start a daemon thread `beatrix-<name>` that calls `work`, and return it when it runs.

    The wait takes a fraction of a millisecond. Without it, on CPython 3.11 two threads that start together under a
    debugger or coverage can fail with "Cannot install a trace function while another …".
    """
    begun, owner = threading.Event(), OWNER.get()

    def run() -> None:
        OWNER.set(owner)
        begun.set()
        work()

    thread = threading.Thread(target=run, name=f"{PREFIX}{name}", daemon=True)
    thread.start()
    begun.wait()
    return thread


def show_error(error: Exception) -> None:
    """Pass an unexpected error to `threading.excepthook`, which shows it, and let the thread continue."""
    values = type(error), error, error.__traceback__, threading.current_thread()
    threading.excepthook(threading.ExceptHookArgs(values))


def ours() -> bool:
    """Return whether the calling thread was started here."""
    return threading.current_thread().name.startswith(PREFIX)
