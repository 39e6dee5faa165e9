"""The thread that runs the tasks of several robots; nodes/test_many_faults.py shows what it does about one that fails."""

from __future__ import annotations

import queue

from beatrix_zenoh.schedule import Schedule, ScheduledTask
from beatrix_zenoh.threads import Owner


def test_a_removed_task_is_not_called_again() -> None:
    schedule, calls = Schedule("publisher"), queue.SimpleQueue[str]()

    def add(name: str) -> ScheduledTask:
        def run() -> float:
            calls.put(name)
            return float("inf")

        return schedule.add(Owner(name), run)

    ada, bob = add("ada"), add("bob")
    assert schedule.remove(ada)
    ada.wake()
    bob.wake()
    assert calls.get(timeout=10.0) == "bob"
    schedule.close()
