"""The only boundary between threads and Qt: calls that other threads post run in Qt's thread."""

from __future__ import annotations

import threading
from collections.abc import Callable, Hashable

from PyQt5.QtCore import QObject, pyqtSignal


class Bridge(QObject):
    """Runs calls of other threads in the thread that created this object, which is Qt's thread.

    `post` queues every call. `post_latest` keeps only the newest call of a slot, for pictures: a slow window skips
    pictures and never falls behind.
    """

    _queued = pyqtSignal(object)

    def __init__(self) -> None:
        super().__init__()
        self._lock = threading.Lock()
        self._newest: dict[Hashable, Callable[[], None]] = {}
        self._closed = False
        self._queued.connect(self._run)  # a call from another thread is queued by Qt

    def post(self, call: Callable[[], None]) -> None:
        """Run `call` in Qt's thread; any thread may post. No call begins after `close`."""
        if not self._closed:
            self._queued.emit(call)

    def post_latest(self, slot: Hashable, call: Callable[[], None]) -> None:
        """Run `call` as `post` does, but replace a waiting call of the same slot."""
        with self._lock:
            waiting = slot in self._newest
            self._newest[slot] = call
        if not waiting:
            self.post(lambda: self._run_newest(slot))

    def _run_newest(self, slot: Hashable) -> None:
        with self._lock:
            call = self._newest.pop(slot)
        call()

    def _run(self, call: Callable[[], None]) -> None:
        if not self._closed:
            call()

    def close(self) -> None:
        """Drop the calls that wait, and all later ones."""
        self._closed = True
