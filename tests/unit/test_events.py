"""The event log: numbers, newest events, counts in a flood."""

from __future__ import annotations

from collections.abc import Callable

import msgspec
import pytest
from statuses import BOARD, READY

from beatrix_zenoh.contract._generated.messages import EventKind, Fault, Phase
from beatrix_zenoh.node.callers import Caller
from beatrix_zenoh.node.events import RESTARTED, SHOWN_S, WINDOW_S, Diagnostics, NodeEvents
from beatrix_zenoh.node.state import StatusEvents

ANA = Caller("ana", "s1")


class Clock:
    """Monotonic time of a test (s)."""

    def __init__(self) -> None:
        self.now_s = 0.0

    def __call__(self) -> float:
        return self.now_s


@pytest.fixture
def clock() -> Clock:
    return Clock()


@pytest.fixture
def log(clock: Clock) -> NodeEvents:
    return NodeEvents(clock)


def add(log: NodeEvents, message: str, seat: Caller = ANA) -> None:
    log.add(EventKind.MOTION, action="pose", caller=seat, phase=Phase.ACCEPTED, message=message)


def test_events_are_numbered_and_published_once(log: NodeEvents) -> None:
    add(log, "one")
    add(log, "two")
    assert [(event.seq, event.message) for event in log.take()] == [(1, "one"), (2, "two")]
    assert log.take() == []


def test_a_flood_of_one_seat_does_not_hide_events_of_another(log: NodeEvents) -> None:
    for _ in range(100):
        add(log, "flood")
    add(log, "alone", Caller("ben", "s2"))
    assert log.take()[-1].message == "alone"


def test_a_new_holder_and_a_lost_board_are_events(log: NodeEvents) -> None:
    changes = StatusEvents(log)
    lost = msgspec.structs.replace(
        READY,
        board=msgspec.structs.replace(BOARD, connected=False),
        fault=Fault.BOARD_LOST,
        warnings=["Gone."],
    )
    for status in (READY, msgspec.structs.replace(READY, holder="ana"), READY, lost, lost, READY, READY):
        changes.record(status)
    assert [(event.kind, event.message) for event in log.take()] == [
        (EventKind.LEASE, "ana drives."),
        (EventKind.LEASE, "ana has freed the robot."),
        (EventKind.BOARD, "Gone."),
        (EventKind.BOARD, "The board at  is connected."),
    ]


def diagnostics(now_s: Callable[[], float] = lambda: 0.0) -> tuple[Diagnostics, NodeEvents]:
    events = NodeEvents()
    return Diagnostics(events, now_s), events


def test_every_warning_is_an_event() -> None:
    made, events = diagnostics()
    made.warn("one")
    (event,) = events.take()
    assert (event.kind, event.message) == (EventKind.WARNING, "one")


def test_a_restart_is_one_event_and_a_warning_until_the_board_is_calibrated() -> None:
    now_s = 0.0
    made, events = diagnostics(lambda: now_s)
    made.follow_boot(1, calibrated=True)
    assert made.warnings() == []
    made.follow_boot(2, calibrated=False)
    made.follow_boot(2, calibrated=False)
    assert [(event.kind, event.message) for event in events.take()] == [(EventKind.BOARD, RESTARTED)]
    made.warn("something else")
    assert made.warnings() == [RESTARTED, "something else"]
    now_s = SHOWN_S + 1
    assert made.warnings() == [RESTARTED]
    made.follow_boot(2, calibrated=True)
    assert made.warnings() == []
    made.follow_boot(2, calibrated=False)
    assert made.warnings() == []


def test_every_event_of_a_long_flood_is_counted_once(log: NodeEvents, clock: Clock) -> None:
    counted = 0
    for _ in range(5000):
        add(log, "x")
        clock.now_s += 0.002
        counted += sum(event.count for event in log.take())
    clock.now_s += WINDOW_S
    counted += sum(event.count for event in log.take())
    assert counted == 5000
