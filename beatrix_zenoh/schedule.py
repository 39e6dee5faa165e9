"""A thread that runs short tasks of several robots when they are due."""

from __future__ import annotations

import queue
import threading
import time
from collections import deque
from collections.abc import Callable
from contextlib import suppress
from contextvars import copy_context
from typing import Final

from beatrix_zenoh import threads

SLACK_S: Final = 0.002
"""Tasks that are due within this time (s) run in the same pass, so that the thread wakes once for many robots."""
END_S: Final = 1.0
"""Longest wait (s) for the end of a running task."""

Failed = Callable[[threads.Owner, BaseException], None]
"""Called with the owner of a task that has raised an exception; must not wait."""


class ScheduledTask:
    """A function of one robot that a schedule calls: it returns the monotonic time (s) of the next call."""

    def __init__(
        self, owner: threads.Owner, run: Callable[[], float], woken: Callable[[ScheduledTask], None]
    ) -> None:
        self.owner, self._run, self._woken = owner, run, woken
        with threads.owned_by(owner):
            self._context = copy_context()
        self.due_s = float("inf")
        self.awake = False
        """Whether `wake` was called since the task began to run."""
        self.held = False
        """Whether it must not run, because it has failed or ended."""

    def run(self) -> None:
        """Call the function as work of its robot."""
        self.due_s = self._context.run(self._run)

    def soon(self) -> None:
        """Run the task the next time that any task runs; any thread may call this."""
        self.due_s = 0.0

    def wake(self) -> None:
        """Run the task now, before those that are due; any thread may call this."""
        if not self.awake:
            self.awake = True
            self._woken(self)


class Schedule:
    """Runs the tasks of several robots on one thread; a task that fails ends alone."""

    def __init__(self, name: str, failed: Failed | None = None) -> None:
        """Name the thread, which the first task starts; without `failed` an exception of a task ends it."""
        self._name, self._failed = name, failed
        self._tasks: tuple[ScheduledTask, ...] = ()
        self._woken: deque[ScheduledTask] = deque()
        self._signals: queue.SimpleQueue[None] = queue.SimpleQueue()
        self._idle = threading.Condition()
        self._running: ScheduledTask | None = None
        self._closed = False
        self._thread: threading.Thread | None = None

    def add(self, owner: threads.Owner, run: Callable[[], float]) -> ScheduledTask:
        """Call `run` after the first `wake`, and then at each time that it returns."""
        task = ScheduledTask(owner, run, self._wake)
        with self._idle:
            self._tasks = (*self._tasks, task)
            if self._thread is None:
                with threads.owned_by(None):
                    self._thread = threads.start(self._work, self._name)
        return task

    def serves(self, owner: threads.Owner) -> bool:
        """Return whether it has a task of this robot."""
        return any(task.owner is owner for task in self._tasks)

    def remove(self, task: ScheduledTask) -> bool:
        """End a task; return False if it still runs after END_S. Not for use in a task."""
        with self._idle:
            self._tasks = tuple(other for other in self._tasks if other is not task)
            task.held = True
            return self._idle.wait_for(lambda: self._running is not task, END_S)

    def _wake(self, task: ScheduledTask) -> None:
        self._woken.append(task)
        self._signals.put(None)

    # -- on the thread ------------------------------------------------------------------------------

    def _work(self) -> None:
        while not self._closed:
            self._pass()

    def _pass(self) -> None:
        """Run what is due, then wait."""
        until_s = time.monotonic() + SLACK_S
        for task in (*self._tasks, None):
            while self._woken:  # a request must not wait for the turns of all other robots
                self._call(self._woken.popleft())
            if task is not None and task.due_s <= until_s:
                self._call(task)
        next_s = min((task.due_s for task in self._tasks if not task.held), default=float("inf"))
        wait_s = next_s - time.monotonic()
        with suppress(queue.Empty):
            self._signals.get(timeout=None if wait_s == float("inf") else max(0.0, wait_s))
            while not self._signals.empty():
                self._signals.get_nowait()

    def _call(self, task: ScheduledTask) -> None:
        with self._idle:
            if task.held:
                task.due_s = float("inf")
                return
            self._running = task
        task.awake = False
        try:
            task.run()
        except Exception as error:
            task.held = True
            if self._failed is None:
                raise
            self._failed(task.owner, error)
        finally:
            with self._idle:
                self._running = None
                if task.held:
                    self._idle.notify_all()

    def close(self) -> None:
        """End the thread after the present task."""
        self._closed = True
        self._signals.put(None)
        if self._thread is not None:
            self._thread.join(timeout=2.0)
