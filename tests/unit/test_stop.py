"""The stop handler: one request to the board for all waiting presses, EMERGENCY_STOP first, a reply to each press."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator
from types import SimpleNamespace
from typing import cast

import msgspec
import pytest

from beatrix_zenoh.bus import Incoming, Received, Sessions
from beatrix_zenoh.bus.query_forms import RawQuery
from beatrix_zenoh.contract._generated.messages import Command, CommandReply, EventKind, Reason
from beatrix_zenoh.contract._generated.serial import FrameType
from beatrix_zenoh.contract.errors import NoAnswer
from beatrix_zenoh.node.access import Operation
from beatrix_zenoh.node.callers import Caller
from beatrix_zenoh.node.node import ControllerThread, Node
from beatrix_zenoh.node.requests import RequestHandle
from beatrix_zenoh.node.stop import REPEAT_S, SAME_PUT_S, StopHandler
from hw_node.body import VirtualHardware


class Unconnected:
    """Sessions of a node that no client can reach."""

    endpoint = "tcp/127.0.0.1:1"

    def __init__(self) -> None:
        self.control = self
        self.queries: dict[str, Callable[[Incoming], None]] = {}
        self.puts: dict[str, Callable[[Received], None]] = {}

    def serve(self, key: str, handle: Callable[[Incoming], None]) -> None:
        self.queries[key] = handle

    def subscribe_newest(self, key: str, handle: Callable[[Received], None], _: object) -> None:
        self.puts[key] = handle


class Stage:
    """A stop handler whose board only records its requests."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.network = Unconnected()
        sessions = cast("Sessions", self.network)
        self.hardware = VirtualHardware("bea")
        self.node = node = Node(sessions, "bea", self.hardware)
        self.sent: list[FrameType] = []
        self.failure: NoAnswer | None = None
        self.busy, self.go_on = threading.Event(), threading.Event()
        self.go_on.set()
        monkeypatch.setattr(node.board, "request", self._request)
        self.handler = StopHandler(node.requests, node.controller, node.board_watch)
        self.controller = ControllerThread(node.requests.queue, node.controller, lambda: None)
        self.handler.start(sessions)
        self.controller.start(sessions)
        self.replies: dict[str, CommandReply] = {}
        self.replied = threading.Semaphore(0)

    def _request(self, frame: FrameType) -> None:
        self.sent.append(frame)
        self.busy.set()
        self.go_on.wait(5)
        if self.failure is not None:
            raise self.failure

    def press(self, command: Command, seat: str) -> None:
        def reply(message: msgspec.Struct) -> None:
            assert isinstance(message, CommandReply)
            self.replies[seat] = message
            self.replied.release()

        caller = Caller(seat, seat)
        handle = RequestHandle(caller, command.name, self.node.events, reply, kind=EventKind.STOP)
        self.handler.press(command, handle)

    def close(self) -> None:
        self.controller.close()
        self.handler.close()
        self.hardware.close()


@pytest.fixture
def stage(monkeypatch: pytest.MonkeyPatch) -> Iterator[Stage]:
    made = Stage(monkeypatch)
    yield made
    made.close()


def test_an_emergency_stop_is_sent_before_an_earlier_stop(stage: Stage) -> None:
    stage.go_on.clear()
    stage.press(Command.STOP, "ana")
    assert stage.busy.wait(5)
    stage.press(Command.STOP, "ben")
    stage.press(Command.STOP, "cleo")
    stage.press(Command.EMERGENCY_STOP, "dan")
    stage.go_on.set()
    for _ in range(4):
        assert stage.replied.acquire(timeout=5)
    assert stage.sent == [FrameType.STOP, FrameType.EMERGENCY_STOP, FrameType.STOP]
    assert set(stage.replies) == {"ana", "ben", "cleo", "dan"}


def test_a_flood_of_stops_costs_few_requests_to_the_board_and_all_are_answered(stage: Stage) -> None:
    began_s = time.monotonic()
    for number in range(300):
        stage.press(Command.STOP, f"seat{number}")
    for _ in range(300):
        assert stage.replied.acquire(timeout=5)
    assert 1 <= len(stage.sent) <= 2 + (time.monotonic() - began_s) / REPEAT_S
    assert {reply.reason for reply in stage.replies.values()} == {Reason.OK}


def test_puts_of_one_key_are_skipped_while_they_only_repeat_a_stop(stage: Stage) -> None:
    key, now_s = "beatrix/bea/hw/stop/cem", 100.0
    repeats, access, ana = stage.handler.repeats, stage.node.controller.access, Caller("ana", "session")
    assert not repeats(key, now_s)
    assert repeats(key, now_s)
    assert not repeats("beatrix/bea/hw/stop/ben", now_s), "the STOP of another seat"
    access.authorize(Operation.MOVE, ana, now_s)
    assert not repeats(key, now_s), "a motion may begin"
    access.take(ana)
    assert not repeats(key, now_s), "a motion has begun"
    assert not repeats(key, now_s + 2 * SAME_PUT_S), "another press"


def test_a_stop_after_a_new_motion_is_sent_however_soon(stage: Stage) -> None:
    access = stage.node.controller.access
    for number in (1, 2, 3):
        with access.lock:
            access.begun += 1
        stage.press(Command.STOP, "ana")
        assert stage.replied.acquire(timeout=5)
        assert stage.sent == [FrameType.STOP] * number


def test_a_put_after_the_query_of_its_press_does_not_stop_the_next_motion(
    stage: Stage, monkeypatch: pytest.MonkeyPatch
) -> None:
    pressed: list[Caller] = []
    access = stage.node.controller.access
    monkeypatch.setattr(access, "stop_pressed", lambda caller, *_, **__: pressed.append(caller))
    key = "beatrix/bea/hw/stop/ana"
    query = SimpleNamespace(
        key=key,
        session="ana",
        attachment=b"press 1",
        raw=RawQuery(b"", "", ""),
        reply=lambda *_: None,
        finish=lambda: None,
    )
    stage.network.queries["beatrix/bea/hw/stop/*"](cast("Incoming", query))
    assert len(pressed) == 1
    put = stage.network.puts["beatrix/bea/hw/stop/*"]
    for press, presses in ((b"press 1", 1), (b"press 2", 2), (b"", 3), (None, 4)):
        put(Received(key, b"", "ana", press, 0, 0))
        assert len(pressed) == presses, press


def test_each_query_of_an_emergency_stop_is_carried_out_and_one_press_is_recorded_once(stage: Stage) -> None:
    queries = 0
    for press, recorded in ((b"press 1", 1), (b"press 2", 2), (b"", 4)):
        for key in ("beatrix/*/*/cmd/ana/command", "beatrix/bea/hw/cmd/ana/command"):
            query = SimpleNamespace(key=key, attachment=press)
            handle = RequestHandle(
                Caller("ana", "ana"),
                "EMERGENCY_STOP",
                None,
                lambda _: stage.replied.release(),
                kind=EventKind.STOP,
            )
            stage.handler.press(Command.EMERGENCY_STOP, handle, cast("Incoming", query))
            assert stage.replied.acquire(timeout=5)
            queries += 1
            assert stage.sent == [FrameType.EMERGENCY_STOP] * queries
        assert [(one.seat, one.count) for one in stage.node.events.stops()] == [("ana", recorded)]


def test_a_stop_after_one_that_the_board_did_not_acknowledge_is_sent(stage: Stage) -> None:
    stage.failure = NoAnswer(Reason.BOARD_LOST, "no answer")
    stage.press(Command.STOP, "ana")
    assert stage.replied.acquire(timeout=5)
    assert stage.replies["ana"].reason is Reason.BOARD_LOST
    stage.failure = None
    stage.press(Command.STOP, "ana")
    assert stage.replied.acquire(timeout=5)
    assert (stage.sent, stage.replies["ana"].reason) == ([FrameType.STOP] * 2, Reason.OK)


def test_a_closed_handler_sends_nothing_and_answers_every_press(stage: Stage) -> None:
    stage.controller.close()
    stage.handler.close()
    stage.press(Command.STOP, "ana")
    assert stage.sent == []
    assert stage.replies["ana"].reason is Reason.SHUTDOWN
