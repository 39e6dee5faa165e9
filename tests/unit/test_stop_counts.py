"""The number of STOPs of each seat since the node started."""

from __future__ import annotations

import datetime as dt

from golden import same

from beatrix_zenoh.account import Account
from beatrix_zenoh.cli.listing import TableRow, cells, stop_words
from beatrix_zenoh.client.monitor import SeatStops
from beatrix_zenoh.contract._generated.messages import EventKind, Reason, SeatCount
from beatrix_zenoh.node.events import BURST, KEPT, STOP_SEATS, NodeEvents
from beatrix_zenoh.settings import Settings


def test_stops_are_counted_from_the_start_however_many_events_follow() -> None:
    """A seat removed its STOPs from the counts of `top` with 200 refused requests."""
    events = NodeEvents(lambda: 0.0)
    for number in range(3 * BURST):
        events.add(EventKind.STOP, action="STOP", caller=("cem", f"{number % 2}"))
    events.add(EventKind.STOP, action="STOP", caller=("cem", ""), reason=Reason.BOARD_LOST)
    events.add(EventKind.STOP, action="STOP", caller=("ana", ""), reason=Reason.MUTED)
    for number in range(2 * KEPT):
        events.add(EventKind.MOTION, caller=("cem", f"{number}"), reason=Reason.NOT_HOLDER)
    assert not any(event.kind is EventKind.STOP for event in events.latest().events)
    assert events.stops() == [SeatCount(seat="cem", count=3 * BURST + 1)], (
        "not the one that the robot refused"
    )


def test_no_more_seats_than_the_limit_are_counted() -> None:
    events = NodeEvents()
    for number in range(STOP_SEATS + 5):
        events.add(EventKind.STOP, caller=(f"seat{number}", ""))
    events.add(EventKind.STOP, caller=("seat0", ""))
    assert len(events.stops()) == STOP_SEATS
    assert events.stops()[0] == SeatCount(seat="seat0", count=2)


def test_the_teacher_sees_the_name_of_the_pupil_who_pressed_stop() -> None:
    account = Account(
        "8b", "teacher", "teacher", "tls/a:1", dt.date.max, "", "", "", names={"zoe": "Zoë Müller"}
    )
    teacher = Settings("bea", account.connect, "teacher", account=account)
    stops = SeatStops("zoe", 2, {("bea1", "hw"): 2})
    same("stop counts.the teacher sees the name of the pupil who pressed stop", stop_words(teacher, stops))
    row = TableRow(("bea1", "hw"), "moving", None, 50.0, None, "zoe", None, [])
    assert cells(teacher, row)[-1] == "Zoë Müller (zoe)"
    assert stop_words(Settings("bea", "", "ana"), stops).startswith("zoe 2 times")
