"""Wake a waiting thread from Zenoh's thread, without ever blocking Zenoh's thread."""

from __future__ import annotations

import contextlib
import threading
import time
from collections.abc import Callable


class Wakeup:
    """Lets one thread wait until another calls `set`; one `set` wakes one thread.

    Ctrl-C inside threading.Condition, on which Event, Future and queue.Queue are built, can leave its lock held: the
    next publication would then block Zenoh's thread for ever. Acquiring and releasing a bare lock is atomic.
    """

    def __init__(self) -> None:
        self._set = threading.Lock()
        self._set.acquire()

    def set(self) -> None:
        """Wake the waiting thread; if none waits, the next `wait_for` returns from its first wait at once."""
        with contextlib.suppress(RuntimeError):  # it was set before
            self._set.release()

    def wait_for(self, condition: Callable[[], object], timeout_s: float | None) -> bool:
        """Wait until `condition()`, checked at each `set`, is true; return False after `timeout_s` (s), if not None."""
        deadline_s = None if timeout_s is None else time.monotonic() + timeout_s
        while not condition():
            left_s = -1.0 if deadline_s is None else deadline_s - time.monotonic()
            if deadline_s is not None and left_s <= 0:
                return False
            self._set.acquire(timeout=min(left_s, threading.TIMEOUT_MAX))
        return True
