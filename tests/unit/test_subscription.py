"""Subscriptions and monitor records, with publications from the test."""

from __future__ import annotations

import gc
import sys
import threading
from collections.abc import Callable
from functools import partial
from types import FrameType
from typing import TypeVar, cast

import msgspec
import pytest
from statuses import READY

from beatrix_zenoh.bus import Received, Reply
from beatrix_zenoh.client.monitor import EventLog, Presence, RobotRecord
from beatrix_zenoh.client.session import Client
from beatrix_zenoh.client.subscription import Subscription, message
from beatrix_zenoh.contract import codec
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import Event, EventKind, Events, Status
from beatrix_zenoh.contract.errors import NoAnswer, Refused

KEY = keys.status("bea", "hw")
M = TypeVar("M", bound=msgspec.Struct)


def sent(payload: bytes, key: str = KEY) -> Received:
    return Received(key, payload, "", None, 1, 2)


class FakeBus:
    """A bus on which the test publishes."""

    def __init__(self) -> None:
        self.subscribers: list[Callable[[Received], None]] = []

    def subscribe(self, key: str, handle: Callable[[Received], None]) -> Callable[[], None]:
        assert key == KEY
        self.subscribers.append(handle)
        return lambda: self.subscribers.remove(handle)

    def publish(self, payload: bytes, key: str = KEY) -> None:
        for handle in self.subscribers:
            handle(sent(payload, key))


class FakeClient:
    """The parts of a client that subscriptions need."""

    def __init__(self) -> None:
        self.bus, self.reads = FakeBus(), 0

    def at_close(self, part: object) -> None:
        pass

    def read(self, answer: Reply, kind: type[M]) -> M | None:
        self.reads += 1
        try:
            return codec.decode(answer.payload, kind)
        except Refused:
            return None


@pytest.fixture
def client() -> FakeClient:
    return FakeClient()


def holder(status: Status) -> str:
    return status.holder


def status(holder: str) -> bytes:
    return codec.encode(msgspec.structs.replace(READY, holder=holder))


def subscribed(client: FakeClient, length: int = 10, timeout_s: float | None = 0.0) -> Subscription[str]:
    read = message(Status, holder)
    return Subscription(cast("Client", client), KEY, read, timeout_s=timeout_s, length=length)


def test_values_come_in_order_with_robot_and_time(client: FakeClient) -> None:
    subscription = subscribed(client)
    for name in "abc":
        client.bus.publish(status(name))
    first = subscription.next_arrival()
    assert (first.value, first.robot, first.side) == ("a", "bea", "hw")
    assert 0 < first.t_mono_ns < first.t_wall_ns
    assert subscription.next() == "b"
    assert subscription.take() == ["c"]
    assert subscription.take(0.01) == []


def test_an_iteration_without_publications_ends_with_an_error(client: FakeClient) -> None:
    client.bus.publish(status("before"))
    subscription = subscribed(client, timeout_s=0.01)
    client.bus.publish(status("a"))
    values = iter(subscription)
    assert next(values) == "a"
    with pytest.raises(NoAnswer, match="does not respond, or is no longer online"):
        next(values)


def test_close_ends_an_iteration_in_another_thread(client: FakeClient) -> None:
    read: list[str] = []
    with subscribed(client, timeout_s=None) as subscription:
        reader = threading.Thread(target=lambda: read.extend(subscription))
        reader.start()
        client.bus.publish(status("a"))
    reader.join(5.0)
    assert (read, reader.is_alive(), client.bus.subscribers) == (["a"], False, [])
    with pytest.raises(NoAnswer, match="closed by this program"):
        subscription.next()
    subscription._receive(sent(status("late")))
    assert subscription.take() == []


def event(seq: int, t_mono_ns: int = 0) -> Event:
    return Event(seq=seq, t_mono_ns=t_mono_ns, t_wall_ns=0, kind=EventKind.STOP)


def test_earlier_and_new_events_are_merged(client: FakeClient) -> None:
    log = EventLog(cast("Client", client), 3)
    log.put(sent(codec.encode(event(3))))
    past = codec.encode(Events(events=[event(1), event(2), event(3)]))
    log.put_past(Reply(KEY, past))
    log.put(sent(b"garbage"))
    log.put(sent(codec.encode(event(4))))
    assert [found.seq for found in log.read()] == [2, 3, 4]
    log.put(sent(codec.encode(event(1, t_mono_ns=5))))  # the node was restarted
    assert [found.seq for found in log.read()] == [3, 4, 1]


def test_the_presence_of_a_robot_follows_its_token_and_positions(
    client: FakeClient, monkeypatch: pytest.MonkeyPatch
) -> None:
    record = RobotRecord(cast("Client", client), "bea", "hw", 0)
    assert record.state().presence is Presence.ABSENT
    record.alive = True
    assert record.state().presence is Presence.SILENT
    record.positions.put(sent(b""))
    assert record.state().presence is Presence.ONLINE
    monkeypatch.setattr("beatrix_zenoh.client.monitor.LOST_S", -1.0)
    state = record.state()
    assert (state.presence, state.reading, state.events) == (Presence.LOST, None, ())


# -- ctrl-C may interrupt a reader anywhere; Zenoh's thread must still enqueue publications --------


CALLS = 200


def interrupted(read: Callable[[], object], nth: int) -> bool:
    """Call `read`, raise KeyboardInterrupt at its nth call or return, and return whether this happened."""
    count = 0

    def interrupt(_frame: FrameType, event: str, _arg: object) -> None:
        nonlocal count
        # Only these events are counted: CPython handles signals when a Python function begins and when a call has
        # returned, not before a C function.
        count += event in ("call", "c_return")
        if count == nth:
            sys.setprofile(None)
            raise KeyboardInterrupt

    gc.disable()  # it could delete something during the call, where Python ignores the interrupt
    sys.setprofile(interrupt)
    try:
        read()
    except KeyboardInterrupt:
        return True
    finally:
        sys.setprofile(None)
        gc.enable()
    return False


def test_an_interrupted_reader_does_not_block_the_next_publication(client: FakeClient) -> None:
    kept = []  # nothing is deleted during a call that is interrupted
    for nth in range(1, CALLS):
        kept.append(subscribed(client))
        with kept[-1] as stream:
            client.bus.publish(status("1"))
            read = partial(stream.take, 0.001)
            was_interrupted = interrupted(read, nth)
            publisher = threading.Thread(target=client.bus.publish, args=(status("2"),), daemon=True)
            publisher.start()
            publisher.join(timeout=10.0)
            assert not publisher.is_alive(), f"interrupted at call {nth}"
            assert stream.take(1.0)[-1] == "2"
        if not was_interrupted:
            assert nth > 10, "nothing was interrupted"
            return
    pytest.fail(f"more than {CALLS} calls")
