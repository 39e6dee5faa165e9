"""The thread that runs the tasks of several robots: when it calls them, and what it does about those that fail."""

from __future__ import annotations

import queue
from collections.abc import Callable, Iterator

import pytest

from beatrix_zenoh import threads
from beatrix_zenoh.schedule import Schedule
from beatrix_zenoh.threads import Owner

NEVER = float("inf")
WAIT_S = 10.0


class Reports:
    """A schedule, and what it has reported."""

    def __init__(self) -> None:
        self.failed: queue.SimpleQueue[tuple[str, BaseException]] = queue.SimpleQueue()
        self.schedule = Schedule("publisher", lambda owner, error: self.failed.put((owner.name, error)))
        self.calls: queue.SimpleQueue[str] = queue.SimpleQueue()

    def add(self, name: str, run: Callable[[], float]) -> Callable[[], None]:
        """Add a task that records its calls; return its `wake`."""

        def recorded() -> float:
            owner = threads.OWNER.get()
            self.calls.put("" if owner is None else owner.name)
            return run()

        return self.schedule.add(Owner(name), recorded).wake

    def called(self) -> str:
        """Wait for the next call of a task; return its owner."""
        return self.calls.get(timeout=WAIT_S)


@pytest.fixture
def reports() -> Iterator[Reports]:
    made = Reports()
    yield made
    made.schedule.close()


def test_an_exception_ends_its_task_only(reports: Reports) -> None:
    def fail() -> float:
        raise RuntimeError("put in")

    ada, bob = reports.add("ada", fail), reports.add("bob", lambda: NEVER)
    ada()
    assert reports.called() == "ada"
    name, error = reports.failed.get(timeout=WAIT_S)
    assert (name, str(error)) == ("ada", "put in")
    ada()
    bob()
    assert reports.called() == "bob"


def test_a_removed_task_is_not_called_again(reports: Reports) -> None:
    task = reports.schedule.add(Owner("ada"), lambda: 0.0)
    task.wake()
    assert reports.schedule.remove(task)
    bob = reports.add("bob", lambda: NEVER)
    task.wake()
    bob()
    assert reports.called() == "bob"
