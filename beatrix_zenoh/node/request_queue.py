"""The request queue: commands in order, only the newest motion of each seat; STOP and board changes come first."""

from __future__ import annotations

import contextlib
import heapq
import itertools
import math
import queue
import threading
import time
from collections import deque
from collections.abc import Callable, Hashable
from dataclasses import dataclass

from beatrix_zenoh.contract import refusals
from beatrix_zenoh.contract.errors import BeatrixError, Refused

CAPACITY = 64
"""Largest number of waiting entries. Beginning a motion takes about 1 ms, and a command that waits for telemetry 10 ms;
so the last entry waits for some tenths of a second, and STOP for one entry."""


@dataclass(frozen=True)
class Task:
    """Work for the reader's thread; if the queue rejects or replaces it, `decline` runs on the posting thread."""

    run: Callable[[], None]
    decline: Callable[[BeatrixError], None]


class RequestQueue:
    """A bounded queue with one reader, in which `post_latest` replaces an entry with the same key."""

    def __init__(self) -> None:
        self._urgent: deque[Task] = deque()
        self._entries: dict[Hashable, Task] = {}
        self._lock = threading.Lock()
        self._arrived: queue.SimpleQueue[None] = queue.SimpleQueue()
        """One item for each entry and for `close`; a SimpleQueue wakes the reader in half the time of a Condition."""
        self._count = 0
        self._later: list[tuple[float, int, Callable[[], None]]] = []
        """Heap of the entries of `post_later`: time (s), number, function."""
        self._numbers = itertools.count()
        self._closed = False

    def post(self, task: Task) -> None:
        """Append an entry; decline it as BUSY if the queue is full, as SHUTDOWN once closed."""
        self._queue(task, most=CAPACITY)

    def post_event(self, run: Callable[[], None]) -> None:
        """Append an entry even if the queue is full; drop it once closed."""
        self._queue(Task(run, lambda _: None), most=math.inf)

    def post_urgent(
        self, run: Callable[[], None], decline: Callable[[BeatrixError], None] = lambda _: None
    ) -> None:
        """Put an entry before all entries that are not urgent; decline it once closed.

        This is for STOP and changes of the board.
        """
        self._queue(Task(run, decline), most=math.inf, urgent=True)

    def post_later(self, due_s: float, run: Callable[[], None]) -> None:
        """Append an entry at `due_s` (monotonic clock), after all that wait then; only the reader may call this."""
        heapq.heappush(self._later, (due_s, next(self._numbers), run))

    def post_latest(self, key: Hashable, task: Task) -> None:
        """Append an entry as `post` does; remove a waiting entry with the same key and decline it as REPLACED."""
        with self._lock:
            refusal = self._refusal(full=key not in self._entries and len(self._entries) >= CAPACITY)
            replaced = None if refusal is not None else self._entries.pop(key, None)
            if replaced is not None:
                self._entries[key] = task
            elif refusal is None:
                self._put(key, task)
        if refusal is not None:
            task.decline(refusal)
        if replaced is not None:
            replaced.decline(refusals.replaced_before_start())

    def _queue(self, task: Task, *, most: float, urgent: bool = False) -> None:
        with self._lock:
            refusal = self._refusal(full=len(self._entries) >= most)
            if refusal is None and urgent:
                self._urgent.append(task)
                self._arrived.put(None)
            elif refusal is None:
                self._count += 1
                self._put(self._count, task)
        if refusal is not None:
            task.decline(refusal)

    def _put(self, key: Hashable, task: Task) -> None:
        self._entries[key] = task
        self._arrived.put(None)

    def take(self) -> Task | None:
        """Wait for the next entry and return it; return None once the queue is closed and empty."""
        while True:
            wait_s = self._later[0][0] - time.monotonic() if self._later else None
            if wait_s is not None and wait_s <= 0:
                self.post_event(heapq.heappop(self._later)[2])
                continue
            with contextlib.suppress(queue.Empty):
                self._arrived.get(timeout=wait_s)
                break
        with self._lock:
            if self._urgent:
                return self._urgent.popleft()
            return self._entries.pop(next(iter(self._entries))) if self._entries else None

    def close(self) -> None:
        """Accept no more entries; the reader finishes the waiting ones."""
        with self._lock:
            self._closed = True
            self._arrived.put(None)

    def _refusal(self, *, full: bool) -> Refused | None:
        if self._closed:
            return refusals.node_closing()
        return refusals.queue_full(CAPACITY) if full else None
