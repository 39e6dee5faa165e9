"""Requests wait in order; of one seat's motions only the newest; never more than fit."""

from __future__ import annotations

import threading

from beatrix_zenoh._generated.messages import Reason
from beatrix_zenoh.errors import BeatrixError
from beatrix_zenoh.node.mailbox import CAPACITY, Mailbox, Task


class Log:
    """Tasks that write down what became of them."""

    def __init__(self) -> None:
        self.ran: list[str] = []
        self.declined: list[tuple[str, Reason]] = []

    def task(self, name: str) -> Task:
        def decline(error: BeatrixError) -> None:
            self.declined.append((name, error.reason))

        return Task(lambda: self.ran.append(name), decline)


def drain(mailbox: Mailbox) -> None:
    mailbox.close()
    while (task := mailbox.take()) is not None:
        task.run()


def test_entries_run_in_order() -> None:
    log, mailbox = Log(), Mailbox()
    for name in "abc":
        mailbox.post(log.task(name))
    drain(mailbox)
    assert log.ran == ["a", "b", "c"]


def test_a_newer_motion_takes_its_place_at_the_end() -> None:
    log, mailbox = Log(), Mailbox()
    mailbox.post_latest("ana", log.task("old"))
    mailbox.post(log.task("command"))
    mailbox.post_latest("ben", log.task("other"))
    mailbox.post_latest("ana", log.task("new"))
    drain(mailbox)
    assert log.ran == ["command", "other", "new"]
    assert log.declined == [("old", Reason.REPLACED)]


def test_too_many_commands_are_declined_as_busy_and_events_never() -> None:
    log, mailbox = Log(), Mailbox()
    for number in range(CAPACITY + 1):
        mailbox.post(log.task(str(number)))
    mailbox.post_event(lambda: log.ran.append("event"))
    drain(mailbox)
    assert len(log.ran) == CAPACITY + 1
    assert log.ran[-1] == "event"
    assert log.declined == [(str(CAPACITY), Reason.BUSY)]


def test_what_was_replaced_leaves_nothing_to_take() -> None:
    """The reader waits for the next; nothing at all would end it, and the node with it."""
    log, mailbox = Log(), Mailbox()
    mailbox.post_latest("ana", log.task("old"))
    mailbox.post_latest("ana", log.task("new"))
    assert mailbox.take() is not None
    reader = threading.Thread(target=mailbox.take, daemon=True)
    reader.start()
    reader.join(0.05)
    assert reader.is_alive()
    mailbox.post(log.task("command"))
    reader.join(2.0)
    assert not reader.is_alive()


def test_a_full_mailbox_declines_motions_but_those_that_replace_another() -> None:
    log, mailbox = Log(), Mailbox()
    for number in range(CAPACITY - 1):
        mailbox.post(log.task(str(number)))
    for name in ("old", "new"):
        mailbox.post_latest("ana", log.task(name))
    mailbox.post_latest("ben", log.task("late"))
    drain(mailbox)
    assert log.ran[-1] == "new"
    assert len(log.ran) == CAPACITY
    assert log.declined == [("old", Reason.REPLACED), ("late", Reason.BUSY)]


def test_once_closed_everything_is_declined_and_what_waited_still_runs() -> None:
    log, mailbox = Log(), Mailbox()
    mailbox.post_latest("ana", log.task("before"))
    mailbox.close()
    mailbox.post(log.task("command"))
    mailbox.post_latest("ana", log.task("motion"))
    late = log.task("event")
    mailbox.post_event(late.run, late.decline)
    while (task := mailbox.take()) is not None:
        task.run()
    assert log.ran == ["before"]
    assert log.declined == [(name, Reason.SHUTDOWN) for name in ("command", "motion", "event")]


def test_what_is_urgent_goes_before_all_that_waits_in_its_own_order() -> None:
    log, mailbox = Log(), Mailbox()
    for number in range(CAPACITY):
        mailbox.post(log.task(f"command {number}"))
    for name in ("stop", "its asker"):
        task = log.task(name)
        mailbox.post_urgent(task.run, task.decline)
    first = [mailbox.take() for _ in range(3)]
    for taken in first:
        assert taken is not None
        taken.run()
    assert log.ran == ["stop", "its asker", "command 0"]
    mailbox.close()
    late = log.task("late")
    mailbox.post_urgent(late.run, late.decline)
    assert log.declined == [("late", Reason.SHUTDOWN)]
