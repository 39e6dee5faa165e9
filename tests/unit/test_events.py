"""The event log: numbers, newest events, counts in a flood."""

from __future__ import annotations

import datetime as dt

import msgspec
import pytest
from golden import same
from msgspec.structs import replace
from statuses import BOARD, READY

from beatrix_zenoh.account import Account
from beatrix_zenoh.cli.listing import cells, stop_words
from beatrix_zenoh.client.monitor import Presence, RobotState, SeatStops
from beatrix_zenoh.contract._generated.messages import EventKind, Fault, Phase, Reason, SeatCount
from beatrix_zenoh.node.callers import Caller
from beatrix_zenoh.node.events import (
    BURST,
    KEPT,
    RESTARTED,
    SHOWN_S,
    STOP_SEATS,
    WINDOW_S,
    Diagnostics,
    NodeEvents,
    new_event,
)
from beatrix_zenoh.node.state import StatusEvents
from beatrix_zenoh.settings import Settings

ANA = Caller("ana", "s1")


@pytest.fixture
def log() -> NodeEvents:
    return NodeEvents(lambda: 0.0)


def add(log: NodeEvents, message: str, seat: Caller = ANA) -> None:
    event = new_event(kind=EventKind.MOTION, action="pose", seat=seat.seat, session=seat.session)
    log.add(replace(event, phase=Phase.ACCEPTED, message=message))


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


def test_a_restart_is_one_event_and_a_warning_until_the_board_is_calibrated(log: NodeEvents) -> None:
    now_s = 0.0
    made = Diagnostics(log, lambda: now_s)
    made.follow_boot(1, calibrated=True)
    assert made.warnings() == []
    made.follow_boot(2, calibrated=False)
    made.follow_boot(2, calibrated=False)
    made.warn("something else")
    assert [(event.kind, event.message) for event in log.take()] == [
        (EventKind.BOARD, RESTARTED),
        (EventKind.WARNING, "something else"),
    ]
    assert made.warnings() == [RESTARTED, "something else"]
    now_s = SHOWN_S + 1
    assert made.warnings() == [RESTARTED]
    made.follow_boot(2, calibrated=True)
    assert made.warnings() == []
    made.follow_boot(2, calibrated=False)
    assert made.warnings() == []


def test_every_event_of_a_long_flood_is_counted_once() -> None:
    now_s, counted = 0.0, 0
    log = NodeEvents(lambda: now_s)
    for _ in range(5000):
        add(log, "x")
        now_s += 0.002
        counted += sum(event.count for event in log.take())
    now_s += WINDOW_S
    counted += sum(event.count for event in log.take())
    assert counted == 5000


# -- the number of STOPs of each seat since the node started ---------------------------------------


def test_stops_are_counted_from_the_start_however_many_events_follow(log: NodeEvents) -> None:
    """A seat removed its STOPs from the counts of `top` with 200 refused requests."""
    for number in range(3 * BURST):
        log.add(new_event(kind=EventKind.STOP, action="STOP", seat="cem", session=f"{number % 2}"))
    log.add(new_event(kind=EventKind.STOP, action="STOP", seat="cem", reason=Reason.BOARD_LOST))
    log.add(new_event(kind=EventKind.STOP, action="STOP", seat="ana", reason=Reason.MUTED))
    for number in range(2 * KEPT):
        log.add(new_event(kind=EventKind.MOTION, seat="cem", session=f"{number}", reason=Reason.NOT_HOLDER))
    assert not any(event.kind is EventKind.STOP for event in log.latest().events)
    assert log.stops() == [SeatCount(seat="cem", count=3 * BURST + 1)], "not the one that the robot refused"


def test_no_more_seats_than_the_limit_are_counted(log: NodeEvents) -> None:
    for number in range(STOP_SEATS + 5):
        log.add(new_event(kind=EventKind.STOP, seat=f"seat{number}"))
    log.add(new_event(kind=EventKind.STOP, seat="seat0"))
    assert len(log.stops()) == STOP_SEATS
    assert log.stops()[0] == SeatCount(seat="seat0", count=2)


def test_the_teacher_sees_the_name_of_the_pupil_who_pressed_stop() -> None:
    account = Account(
        "8b", "teacher", "teacher", "tls/a:1", dt.date.max, "", "", "", names={"zoe": "Zoë Müller"}
    )
    teacher = Settings("bea", account.connect, "teacher", account=account)
    stops = SeatStops("zoe", 2, {("bea1", "hw"): 2})
    same("stop counts.the teacher sees the name of the pupil who pressed stop", stop_words(teacher, stops))
    driven = msgspec.structs.replace(READY, holder="zoe")
    robot = RobotState("bea1", "hw", Presence.ONLINE, driven, None, None, None, 50.0, ())
    assert cells(teacher, robot)[-1] == "Zoë Müller (zoe)"
    assert stop_words(Settings("bea", "", "ana"), stops).startswith("zoe 2 times")
