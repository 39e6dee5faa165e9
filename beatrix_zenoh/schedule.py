"""A thread that runs short tasks of several robots when they are due, and goes on without a task that hangs."""

from __future__ import annotations

import ctypes
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
TICK_S: Final = 0.01
"""Period (s) of the check whether a task hangs."""
LEFT_TICKS, MOST_TICKS = 2, 25
"""Checks in a row that find a task still running before another thread goes on with the other tasks. A turn takes less
than a millisecond. On a busy computer a healthy one may be slow: its thread then gives the task back, and the number of
checks is doubled up to MOST_TICKS, because more threads would make the computer slower still."""
CALM_TICKS: Final = 100
"""Checks after which the number of checks becomes smaller by one again."""
HANGS_S: Final = 0.5
"""Time (s) after which a task hangs. Counted in checks, so that a process that was suspended hangs nothing."""
END_S: Final = 1.0
"""Longest wait (s) for the end of a running task."""

Failed = Callable[[threads.Owner, BaseException], None]
"""Called with the owner of a task that has raised an exception or hangs (`Hung`); on any thread, must not wait."""


class Hung(BaseException):
    """Raised in a thread whose task hangs, to end a loop of Python code; nothing can end a call of C."""


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
        """Whether it must not run: it has failed or ended, or it or another task of its robot still runs on a thread that
        was left behind, perhaps with a lock."""

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


class _Run:
    """One call of a task."""

    __slots__ = ("reported", "task", "thread", "ticks")

    def __init__(self, task: ScheduledTask) -> None:
        self.task, self.thread = task, threading.get_ident()
        self.ticks, self.reported = 0, False


class Schedule:
    """Runs the tasks of several robots on one thread.

    If `check` is called every TICK_S, a task that does not return delays the others by a few ticks only: another thread
    goes on with them, and the first one ends once its task returns.
    """

    def __init__(self, name: str, failed: Failed | None = None) -> None:
        """Name the thread, which the first task starts; without `failed` an exception of a task ends it."""
        self._name, self._failed = name, failed
        self._tasks: tuple[ScheduledTask, ...] = ()
        self._woken: deque[ScheduledTask] = deque()
        self._signals: queue.SimpleQueue[None] = queue.SimpleQueue()
        self._lock = threading.Lock()
        self._running: _Run | None = None
        self._left: list[_Run] = []
        """Calls that have not returned when another thread went on."""
        self._patience, self._calm = LEFT_TICKS, 0
        self._idle = threading.Condition(self._lock)
        self._closed = False
        self._thread: threading.Thread | None = None

    def add(self, owner: threads.Owner, run: Callable[[], float]) -> ScheduledTask:
        """Call `run` after the first `wake`, and then at each time that it returns."""
        task = ScheduledTask(owner, run, self._wake)
        with self._lock:
            self._tasks = (*self._tasks, task)
            if self._thread is None:
                with threads.owned_by(None):
                    self._thread = threads.start(self._work, self._name)
        return task

    def serves(self, owner: threads.Owner) -> bool:
        """Return whether it has a task of this robot."""
        return bool(self._of(owner))

    def _of(self, owner: threads.Owner) -> list[ScheduledTask]:
        return [task for task in self._tasks if task.owner is owner]

    def remove(self, task: ScheduledTask) -> bool:
        """End a task; return False if it still runs after END_S, or is left behind. Not for use in a task."""
        with self._idle:
            self._tasks = tuple(other for other in self._tasks if other is not task)
            task.held = True
            return self._idle.wait_for(lambda: not self._runs(task), 0.0 if self._is_left(task) else END_S)

    def _runs(self, task: ScheduledTask) -> bool:
        running = self._running
        return (running is not None and running.task is task) or self._is_left(task)

    def _is_left(self, task: ScheduledTask) -> bool:
        return any(run.task is task for run in self._left)

    def _wake(self, task: ScheduledTask) -> None:
        self._woken.append(task)
        self._signals.put(None)

    # -- on the thread ------------------------------------------------------------------------------

    def _work(self) -> None:
        with suppress(Hung):
            while self._pass():
                pass

    def _pass(self) -> bool:
        """Run what is due, then wait; return False if this thread must end."""
        until_s = time.monotonic() + SLACK_S
        for task in (*self._tasks, None):
            while self._woken:  # a request must not wait for the turns of all other robots
                if not self._call(self._woken.popleft()):
                    return False
            if task is not None and task.due_s <= until_s and not self._call(task):
                return False
        next_s = min((task.due_s for task in self._tasks if not task.held), default=float("inf"))
        wait_s = next_s - time.monotonic()
        with suppress(queue.Empty):
            self._signals.get(timeout=None if wait_s == float("inf") else max(0.0, wait_s))
            while not self._signals.empty():
                self._signals.get_nowait()
        return not self._closed

    def _call(self, task: ScheduledTask) -> bool:
        """Call a task; return False if another thread has gone on meanwhile."""
        if task.held:
            task.due_s = float("inf")
            return True
        task.awake = False
        self._running = run = _Run(task)
        try:
            task.run()
        except Exception as error:
            task.held = True
            if self._failed is None:
                raise
            self._failed(task.owner, error)
        finally:
            stays = self._returned(run)
        return stays

    def _returned(self, run: _Run) -> bool:
        with self._idle:
            stays = self._running is run
            if stays:
                self._running = None
            else:
                self._left.remove(run)
                if not run.reported and run.task in self._tasks:
                    for task in self._of(run.task.owner):
                        task.held, task.awake = False, True
                        self._wake(task)
                    self._patience, self._calm = min(2 * self._patience, MOST_TICKS), 0
            if run.task.held:
                self._idle.notify_all()
        return stays

    # -- on the thread of a watch -------------------------------------------------------------------

    def check(self) -> None:
        """Go on without a task that does not return, and report one that hangs; call this every TICK_S."""
        with self._lock:
            self._calm += 1
            if self._calm % CALM_TICKS == 0:
                self._patience = max(LEFT_TICKS, self._patience - 1)
            run = self._running
            if run is not None:
                run.ticks += 1
                waits = any(not left.reported for left in self._left)
                if run.ticks > self._patience and self._failed is not None and not waits:
                    self._running = None
                    for task in self._of(run.task.owner):
                        task.held = True
                    self._left.append(run)
                    self._thread = threads.start(self._work, self._name)
            hung = []
            for left in self._left:
                left.ticks += 1
                if left.ticks * TICK_S > HANGS_S and not left.reported:
                    left.reported = True
                    hung.append(left)
        for left in hung:
            if self._failed is not None:
                self._failed(
                    left.task.owner, Hung(f"a turn of the {self._name} has not ended within {HANGS_S:g} s")
                )
            ctypes.pythonapi.PyThreadState_SetAsyncExc(ctypes.c_ulong(left.thread), ctypes.py_object(Hung))

    def close(self) -> None:
        """End the thread after the present task."""
        self._closed = True
        self._signals.put(None)
        if self._thread is not None:
            self._thread.join(timeout=2.0)


class HangWatch:
    """A thread that checks a schedule for tasks that hang."""

    def __init__(self, schedule: Schedule) -> None:
        self._schedule = schedule
        self._closed = threading.Event()
        self._thread = threads.start(self._run, "watch")

    def _run(self) -> None:
        while not self._closed.wait(TICK_S):
            self._schedule.check()

    def close(self) -> None:
        """End the thread."""
        self._closed.set()
        self._thread.join(timeout=2.0)
