"""The request queue: order, only the newest motion of each seat, capacity."""

from __future__ import annotations

import time

from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.errors import BeatrixError
from beatrix_zenoh.node.requests import CAPACITY, ControllerQueue, Decline, Run


class Log:
    """Creates tasks, and records which of them ran or were declined."""

    def __init__(self) -> None:
        self.ran: list[str] = []
        self.declined: list[tuple[str, Reason]] = []

    def task(self, name: str) -> tuple[Run, Decline]:
        def decline(error: BeatrixError) -> None:
            self.declined.append((name, error.reason))

        return lambda: self.ran.append(name), decline


def run(queue: ControllerQueue, count: int) -> None:
    """Run the next entries."""
    for _ in range(count):
        entry = queue.take()
        assert entry is not None
        entry()


def drain(queue: ControllerQueue) -> None:
    queue.close()
    while (entry := queue.take()) is not None:
        entry()


def test_a_newer_motion_of_a_seat_replaces_the_older_and_runs_last() -> None:
    log, queue = Log(), ControllerQueue()
    queue.post_latest("ana", *log.task("old"))
    queue.post(*log.task("command"))
    queue.post_latest("ben", *log.task("other"))
    queue.post_latest("ana", *log.task("new"))
    drain(queue)
    assert log.ran == ["command", "other", "new"]
    assert log.declined == [("old", Reason.REPLACED)]


def test_a_full_queue_declines_commands_as_busy_but_not_events() -> None:
    log, queue = Log(), ControllerQueue()
    for number in range(CAPACITY + 1):
        queue.post(*log.task(str(number)))
    queue.post_event(lambda: log.ran.append("event"))
    drain(queue)
    assert len(log.ran) == CAPACITY + 1
    assert log.ran[-1] == "event"
    assert log.declined == [(str(CAPACITY), Reason.BUSY)]


def test_a_full_queue_declines_motions_except_those_that_replace_another() -> None:
    log, queue = Log(), ControllerQueue()
    for number in range(CAPACITY - 1):
        queue.post(*log.task(str(number)))
    for name in ("old", "new"):
        queue.post_latest("ana", *log.task(name))
    queue.post_latest("ben", *log.task("late"))
    drain(queue)
    assert log.ran[-1] == "new"
    assert len(log.ran) == CAPACITY
    assert log.declined == [("old", Reason.REPLACED), ("late", Reason.BUSY)]


def test_a_closed_queue_declines_new_entries_and_runs_the_waiting_ones() -> None:
    log, queue = Log(), ControllerQueue()
    queue.post_latest("ana", *log.task("before"))
    queue.close()
    queue.post(*log.task("command"))
    queue.post_latest("ana", *log.task("motion"))
    queue.post_event(log.task("event")[0])
    drain(queue)
    assert log.ran == ["before"]
    assert log.declined == [(name, Reason.SHUTDOWN) for name in ("command", "motion")]


def test_urgent_entries_go_first_in_their_own_order() -> None:
    log, queue = Log(), ControllerQueue()
    for number in range(CAPACITY):
        queue.post(*log.task(f"command {number}"))
    for name in ("stop", "its reply"):
        queue.post_urgent(*log.task(name))
    run(queue, 3)
    assert log.ran == ["stop", "its reply", "command 0"]
    queue.close()
    queue.post_urgent(*log.task("late"))
    assert log.declined == [("late", Reason.SHUTDOWN)]


def test_a_later_entry_runs_at_its_time_after_all_that_wait_then() -> None:
    log, queue, due_s = Log(), ControllerQueue(), time.monotonic() + 0.05
    queue.post_later(due_s + 0.01, lambda: log.ran.append("last"))
    queue.post_later(due_s, lambda: log.ran.append(f"late: {time.monotonic() >= due_s}"))
    queue.post(*log.task("now"))
    run(queue, 3)
    assert log.ran == ["now", "late: True", "last"]
    queue.post_later(time.monotonic(), lambda: log.ran.append("due"))
    queue.post(*log.task("waits already"))
    run(queue, 2)
    assert log.ran[3:] == ["waits already", "due"]
    queue.post_later(time.monotonic() + 60, lambda: log.ran.append("never"))
    drain(queue)
    assert log.ran[-1] == "due", "a closed queue waits for none"
