"""Callbacks on Zenoh's threads that keep their Python thread state."""

from __future__ import annotations

import ctypes
import threading
from collections.abc import Callable
from typing import Final, TypeVar

from zenoh.handlers import Callback

T = TypeVar("T")


class _Kept(threading.local):
    """Whether the calling thread keeps its state; part of that state, so a thread with a new state keeps it anew."""

    done = False


_KEPT: Final = _Kept()


def direct(handle: Callable[[T], None], drop: Callable[[], None] | None = None) -> Callback[T]:
    """Return a callback that runs `handle` on Zenoh's thread, which must return at once.

    Python makes a thread state for a thread of another language whenever it calls Python, and deletes it afterwards,
    with memory mapped and unmapped each time. That costs 30 us for each message, more than all else together (decision
    0082). A second PyGILState_Ensure, which is never released, keeps the state. Zenoh has few threads, and they live as
    long as the process.
    """

    def receive(value: T) -> None:
        if not _KEPT.done:
            ctypes.pythonapi.PyGILState_Ensure()
            _KEPT.done = True
        handle(value)

    return Callback(receive, drop, indirect=False)
