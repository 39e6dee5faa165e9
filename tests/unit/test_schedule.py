"""The thread that runs the tasks of several robots: when it calls them, and what it does about those that fail or hang."""

from __future__ import annotations

import queue
import threading
from collections.abc import Callable, Iterator
from types import SimpleNamespace
from typing import Any, cast

import pytest
from robots import until

from beatrix_zenoh import threads
from beatrix_zenoh.bus.sessions import CONTROL, SessionListener, SessionWatchdog
from beatrix_zenoh.schedule import HANGS_S, LEFT_TICKS, TICK_S, Hung, Schedule
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

    def check(self, times: int) -> None:
        """Do what a watch does."""
        for _ in range(times):
            self.schedule.check()


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


def test_a_slow_task_delays_no_other_and_comes_back(reports: Reports) -> None:
    returns = threading.Event()
    ada = reports.add("ada", lambda: NEVER if returns.wait(WAIT_S) else 0.0)
    bob = reports.add("bob", lambda: NEVER)
    ada()
    assert reports.called() == "ada"
    reports.check(LEFT_TICKS + 1)
    bob()
    assert reports.called() == "bob"
    returns.set()
    assert reports.called() == "ada", "its thread has given it back"
    assert reports.failed.empty()


def test_a_task_that_hangs_is_reported_and_its_loop_is_ended(reports: Reports) -> None:
    ended = threading.Event()

    def loop() -> float:
        pause = threading.Event()
        try:
            while True:
                pause.wait(0.001)
        finally:
            ended.set()

    ada, bob = reports.add("ada", loop), reports.add("bob", lambda: NEVER)
    ada()
    assert reports.called() == "ada"
    reports.check(LEFT_TICKS + 2 + int(HANGS_S / TICK_S))
    name, error = reports.failed.get(timeout=WAIT_S)
    assert name == "ada"
    assert isinstance(error, Hung)
    until(ended.is_set, "the loop has ended")
    bob()
    assert reports.called() == "bob"
    assert reports.calls.empty(), "a task that hung is not called again"


def test_a_removed_task_is_not_called_again(reports: Reports) -> None:
    task = reports.schedule.add(Owner("ada"), lambda: 0.0)
    task.wake()
    assert reports.schedule.remove(task)
    bob = reports.add("bob", lambda: NEVER)
    task.wake()
    bob()
    assert reports.called() == "bob"


def test_no_task_of_a_robot_runs_while_another_one_is_left_behind(reports: Reports) -> None:
    ada, returns = Owner("ada"), threading.Event()

    def turn() -> float:
        reports.calls.put("turn")
        returns.wait(WAIT_S)
        return NEVER

    def publication() -> float:
        reports.calls.put("publication")
        return NEVER

    reports.schedule.add(ada, turn).wake()
    assert reports.called() == "turn"
    reports.schedule.add(ada, publication)
    reports.check(LEFT_TICKS + 1)
    for task in reports.schedule._of(ada):
        task.wake()
    reports.add("bob", lambda: NEVER)()
    assert reports.called() == "bob", "the publication would wait for a lock of the turn"
    returns.set()
    assert {reports.called(), reports.called()} == {"turn", "publication"}


# -- the session watchdog of a process with several robots -----------------------------------------


def test_the_watchdog_belongs_to_all_robots(monkeypatch: pytest.MonkeyPatch) -> None:
    """Otherwise its failure would start the first robot anew, and no thread would check the sessions any more."""
    monkeypatch.setattr("beatrix_zenoh.bus.sessions.PERIOD_S", 0.01)
    owners: queue.SimpleQueue[Owner | None] = queue.SimpleQueue()

    def opened() -> dict[str, Any]:
        owners.put(threads.OWNER.get())
        return {CONTROL: SimpleNamespace(connected=True)}

    watchdog = SessionWatchdog(opened)
    listener = SessionListener(cast("Any", None), cast("Any", None))
    with threads.owned_by(Owner("ada")):
        end = watchdog.add(listener)
    try:
        assert owners.get(timeout=WAIT_S) is None
    finally:
        end()
