"""The number of STOPs of each seat, from events that arrive in any order and perhaps twice."""

from __future__ import annotations

import datetime as dt
from typing import TypeVar, cast

import msgspec
from golden import same

from beatrix_zenoh.account import Account
from beatrix_zenoh.bus import Reply
from beatrix_zenoh.cli.listing import TableRow, cells, stop_words
from beatrix_zenoh.client import Client
from beatrix_zenoh.client.monitor import STOP_SEATS, EventLog, SeatStops
from beatrix_zenoh.contract import codec
from beatrix_zenoh.contract._generated.messages import Event, EventKind, Events, Reason
from beatrix_zenoh.settings import Settings

M = TypeVar("M", bound=msgspec.Struct)


class Decoding:
    """The part of a client that an event log uses."""

    def read(self, answer: Reply, kind: type[M]) -> M:
        return codec.decode(answer.payload, kind)


def log(length: int = 5) -> EventLog:
    return EventLog(cast("Client", Decoding()), "beatrix/bea/hw/state/events", length)


def stop(seq: int, seat: str, count: int = 1, reason: Reason = Reason.OK) -> Event:
    return Event(
        seq=seq, t_mono_ns=seq, t_wall_ns=seq, kind=EventKind.STOP, seat=seat, count=count, reason=reason
    )


def test_each_stop_counts_once_although_few_events_are_kept_and_some_arrive_twice() -> None:
    events = [stop(1, "ana"), stop(2, "cem", 7), stop(3, "")]
    counted = log(length=2)
    counted.put(codec.encode(events[2]))
    counted.read()
    counted.put_past(codec.encode(Events(events=events)))
    counted.put(codec.encode(stop(4, "cem")))
    for _ in range(2):
        assert [event.seq for event in counted.read()] == [3, 4]
        assert dict(counted.stops()) == {"cem": 8, "ana": 1, "": 1}


def test_other_events_and_more_seats_than_the_limit_are_not_counted() -> None:
    counted = log(length=1)
    counted.put(codec.encode(Event(seq=1, t_mono_ns=1, t_wall_ns=1, kind=EventKind.COMMAND, seat="ana")))
    for number in range(STOP_SEATS + 5):
        counted.put(codec.encode(stop(number, f"seat{number}")))
        counted.read()
    assert len(counted.stops()) == STOP_SEATS


def test_a_refused_stop_of_a_muted_seat_is_not_counted() -> None:
    counted = log()
    counted.put(codec.encode(stop(1, "cem", reason=Reason.MUTED)))
    counted.put(codec.encode(stop(2, "cem", reason=Reason.BOARD_LOST)))
    counted.read()
    assert counted.stops() == (("cem", 1),), "only the one that the robot did not refuse"


def test_the_teacher_sees_the_name_of_the_pupil_who_pressed_stop() -> None:
    account = Account(
        "8b", "teacher", "teacher", "tls/a:1", dt.date.max, "", "", "", names={"zoe": "Zoë Müller"}
    )
    teacher = Settings("bea", account.connect, "teacher", account=account)
    stops = SeatStops("zoe", 2, {("bea1", "hw"): 2})
    same("stop counts.the teacher sees the name of the pupil who pressed stop", stop_words(teacher, stops))
    row = TableRow(("bea1", "hw"), "moving", None, 50.0, None, "zoe", {}, [])
    assert cells(teacher, row)[-1] == "Zoë Müller (zoe)"
    assert stop_words(Settings("bea", "", "ana"), stops).startswith("zoe 2 times")
