"""Where requests wait: commands in order, of each seat's motions only the newest, before all of them what STOP brings."""

from __future__ import annotations

import math
import queue
import threading
from collections import deque
from collections.abc import Callable, Hashable
from dataclasses import dataclass

from beatrix_zenoh._generated.messages import Reason
from beatrix_zenoh.errors import BeatrixError, Refused

CAPACITY = 64
"""Entries that may wait. A motion takes about a millisecond, a command that the telemetry must show ten: the last waits for
some tenths of a second, STOP for one."""


@dataclass(frozen=True)
class Task:
    """Something to do on the reader's thread, or to decline on the poster's."""

    run: Callable[[], None]
    decline: Callable[[BeatrixError], None]


class Mailbox:
    """A bounded queue with one reader, in which a newer entry under the same key replaces the older."""

    def __init__(self) -> None:
        self._urgent: deque[Task] = deque()
        self._entries: dict[Hashable, Task] = {}
        self._lock = threading.Lock()
        self._arrived: queue.SimpleQueue[None] = queue.SimpleQueue()
        """As many as there are entries, and one to close: wakes its reader in half the time a Condition takes."""
        self._count = 0
        self._closed = False

    def post(self, task: Task) -> None:
        """Queue behind the others; declined as BUSY if too many wait, as SHUTDOWN once closed."""
        self._queue(task, most=CAPACITY)

    def post_event(
        self, run: Callable[[], None], decline: Callable[[BeatrixError], None] = lambda _: None
    ) -> None:
        """Queue something that happened; declined only once closed, for there are few of them."""
        self._queue(Task(run, decline), most=math.inf)

    def post_urgent(
        self, run: Callable[[], None], decline: Callable[[BeatrixError], None] = lambda _: None
    ) -> None:
        """As `post_event`, in front of all that is not urgent: STOP, and what the board shows."""
        self._queue(Task(run, decline), most=math.inf, urgent=True)

    def post_latest(self, key: Hashable, task: Task) -> None:
        """Queue in place of the entry under the same key, which is declined as REPLACED."""
        with self._lock:
            no = self._refusal(full=key not in self._entries and len(self._entries) >= CAPACITY)
            replaced = None if no is not None else self._entries.pop(key, None)
            if replaced is not None:
                self._entries[key] = task
            elif no is None:
                self._put(key, task)
        if no is not None:
            task.decline(no)
        if replaced is not None:
            replaced.decline(
                Refused(Reason.REPLACED, "A newer motion from this seat came before this one began.")
            )

    def _queue(self, task: Task, *, most: float, urgent: bool = False) -> None:
        with self._lock:
            no = self._refusal(full=len(self._entries) >= most)
            if no is None and urgent:
                self._urgent.append(task)
                self._arrived.put(None)
            elif no is None:
                self._count += 1
                self._put(self._count, task)
        if no is not None:
            task.decline(no)

    def _put(self, key: Hashable, task: Task) -> None:
        self._entries[key] = task
        self._arrived.put(None)

    def take(self) -> Task | None:
        """Wait for the next entry; None once the mailbox is closed and empty."""
        self._arrived.get()
        with self._lock:
            if self._urgent:
                return self._urgent.popleft()
            return self._entries.pop(next(iter(self._entries))) if self._entries else None

    def close(self) -> None:
        """Let the reader finish what waits and end."""
        with self._lock:
            self._closed = True
            self._arrived.put(None)

    def _refusal(self, *, full: bool) -> Refused | None:
        if self._closed:
            return Refused(Reason.SHUTDOWN, "The node is closing.")
        return busy() if full else None


def busy() -> Refused:
    """What to tell who finds no room."""
    return Refused(Reason.BUSY, f"{CAPACITY} requests are waiting already: send fewer a second.")
