"""STOP and refusals while a simulation follows: whenever they come, the last frame to the board is no motion."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any, cast

import pytest
from access_callers import ANA
from golden import same
from msgspec.structs import replace
from statuses import AT_HOME, READY

from beatrix_zenoh.board.board import Board
from beatrix_zenoh.board.state import NO_TELEMETRY, TelemetrySample
from beatrix_zenoh.bus import Received, Sessions
from beatrix_zenoh.contract import codec
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import FollowState, Head, Positions
from beatrix_zenoh.contract._generated.robot import ROBOT
from beatrix_zenoh.contract._generated.serial import BoardState, FrameType, Move, MoveStraight
from beatrix_zenoh.node import StatusFields
from beatrix_zenoh.node.access import Access
from beatrix_zenoh.node.controller import MotionController
from beatrix_zenoh.node.events import Diagnostics, NodeEvents
from beatrix_zenoh.node.planner import Planner, vector
from beatrix_zenoh.node.requests import Requests
from sim_node.following import follower
from sim_node.following.handler import FollowHandler

MOVE, STOP = "move", "stop"


class FakeBoard:
    """A board that records frames; its telemetry shows arms at rest, as in the first milliseconds of a motion."""

    connected = True
    ready_telemetry = Board.ready_telemetry

    def __init__(self) -> None:
        self.frames: list[str] = []
        self.reached: Callable[[], None] = lambda: None
        """called before each use of the board"""
        self._telemetry = replace(NO_TELEMETRY, state=BoardState.ENABLED | BoardState.CALIBRATED)

    @property
    def sample(self) -> TelemetrySample:
        self.reached()
        return TelemetrySample(self._telemetry, time.monotonic_ns())

    @property
    def telemetry(self) -> object:
        return self.sample.telemetry

    @property
    def state(self) -> int:
        return self._telemetry.state

    def move(self, _frame: Move | MoveStraight) -> None:
        self.reached()
        self.frames.append(MOVE)
        self.reached()

    def request(self, kind: FrameType) -> None:
        assert kind is FrameType.STOP
        self.frames.append(STOP)

    def wake(self) -> None:
        self.reached()


class Following:
    """A simulation that follows, without threads, network and firmware."""

    def __init__(self) -> None:
        self.board, self.access = FakeBoard(), Access()
        board, events, planner = cast("Any", self.board), NodeEvents(), Planner(ROBOT)
        self.controller = MotionController(board, planner, self.access, Diagnostics(events))
        here = SimpleNamespace(positions=lambda: positions(0.0, 0))
        # The queue of the controller's thread runs at once, but no periodic check: that is as the next sample.
        queue = SimpleNamespace(
            post_event=lambda run: run(), post_latest=lambda _, run: run(), post_later=lambda *_: None
        )
        requests = Requests("bea", "sim", cast("Any", queue), events)
        self._handlers: dict[str, Callable[[Received], None]] = {}
        self._seq = 0
        self.handler = FollowHandler(requests, self.controller, cast("Any", here), at_start=True)
        self.handler.start(cast("Sessions", self))
        self.publish(keys.status("bea", "hw"), codec.encode(READY))

    def serve(self, *_: object) -> None:
        """Declare nothing: no client sends queries."""

    def subscribe(self, key: str, handle: Callable[[Received], None]) -> Callable[[], None]:
        self._handlers[key] = handle
        return lambda: None

    def session(self, _name: str) -> Any:
        query = SimpleNamespace(close=lambda: None, hand_over=lambda _: None)
        return SimpleNamespace(query=lambda *_, **__: query)

    def publish(self, key: str, payload: bytes) -> None:
        self._handlers[key](Received(key, payload, "", None, 0, 0))

    def place(self, angle_deg: float) -> None:
        """Let the hardware publish that its set points are there."""
        self._seq += 1
        self.publish(keys.positions("bea", "hw"), codec.encode(positions(angle_deg, self._seq)))

    def press_stop(self) -> None:
        """Do what the threads of Zenoh and of STOP do."""
        self.access.stop_pressed(ANA, time.monotonic())
        self.board.request(FrameType.STOP)

    def status(self) -> StatusFields:
        fields = StatusFields()
        self.handler.contribute(fields)
        return fields


def positions(angle_deg: float, seq: int) -> Positions:
    arms = vector((math.radians(angle_deg),) * 3)
    head, now_ns = Head(arms.x, 0.0, 0.0), time.monotonic_ns()
    return replace(AT_HOME, seq=seq, t_mono_ns=now_ns, position=arms, commanded=arms, head=head)


@pytest.fixture
def following(monkeypatch: pytest.MonkeyPatch) -> Following:
    monkeypatch.setattr(follower, "PATH_S", 0.0)
    made = Following()
    made.place(80.0)
    assert made.board.frames == [MOVE], "it is on its way"
    return made


def test_a_refused_path_brakes(following: Following) -> None:
    following.place(250.0)
    assert following.board.frames == [MOVE, STOP]
    assert following.status().values["following"] is FollowState.WAITING
    same("following stop.a refused path brakes", following.status().warnings[0])


@pytest.mark.parametrize("settled_first", [True, False])
def test_a_stop_at_any_point_of_a_step_ends_with_a_stop(*, settled_first: bool) -> None:
    points = 0
    for point in range(1, 100):
        following = Following()
        left = point

        def reached(following: Following = following) -> None:
            nonlocal left
            left -= 1
            if left == 0:
                following.press_stop()

        following.board.reached = reached
        following.place(80.0)
        if left > 0:
            break
        points = point
        if settled_first:
            following.controller.stop_sent()
        following.place(80.0)
        following.place(60.0)
        if not settled_first:
            following.controller.stop_sent()
        assert following.board.frames[-1] == STOP, f"STOP at point {point}: {following.board.frames}"
        assert following.status().values["following"] is FollowState.OFF
    assert points > 5
