"""The number of STOPs of each seat, from events that arrive in any order and perhaps twice."""

from __future__ import annotations

from typing import TypeVar, cast

import msgspec

from beatrix_zenoh import codec
from beatrix_zenoh._generated.messages import Event, EventKind, Events
from beatrix_zenoh.bus import Reply
from beatrix_zenoh.client import Client
from beatrix_zenoh.client.robot_state import STOP_SEATS, EventLog

M = TypeVar("M", bound=msgspec.Struct)


class Decoding:
    """The part of a client that an event log uses."""

    def read(self, answer: Reply, kind: type[M]) -> M:
        return codec.decode(answer.payload, kind)


def log(length: int = 5) -> EventLog:
    return EventLog(cast("Client", Decoding()), "beatrix/bea/hw/state/events", length)


def stop(seq: int, seat: str, count: int = 1) -> Event:
    return Event(seq=seq, t_mono_ns=seq, t_wall_ns=seq, kind=EventKind.STOP, seat=seat, count=count)


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
