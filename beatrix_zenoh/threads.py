"""Start of the package's threads."""

from __future__ import annotations

import threading
from collections.abc import Callable

PREFIX = "beatrix-"


def start(work: Callable[[], None], name: str) -> threading.Thread:
    """Start a daemon thread `beatrix-<name>` that calls `work`, and return it when it runs.

    The wait takes a fraction of a millisecond. Without it, on CPython 3.11 two threads that start together under a
    debugger or coverage can fail with "Cannot install a trace function while another …".
    """
    begun = threading.Event()

    def run() -> None:
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
