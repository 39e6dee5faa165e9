"""Requests of a link to robots that are mocks: STOP while a robot accepts a motion."""

from __future__ import annotations

import queue
import time
from collections.abc import Iterator
from unittest.mock import MagicMock

import pytest
from robots import until

from beatrix_zenoh.client import Place
from beatrix_zenoh.contract._generated.messages import Reason
from gui.console.link import jogging, request
from gui.console.link.jobs import Jobs
from gui.console.link.moving import Moving
from gui.console.link.outcomes import replaced, stopped
from gui.console.state.actions import Action, Hold, Outcome, Send
from gui.console.state.arms import AHEAD_S, jog_query

WAIT_S = 10.0
MOTIONS: list[Action] = [
    Send(1, jog_query((("short", 1.0),), 20.0, AHEAD_S), ("hw",)),
    Hold(1, (("short", 1.0),), 20.0, ("hw",)),
]


@pytest.fixture
def jobs() -> Iterator[Jobs]:
    made = Jobs("tested")
    yield made
    made.close()
    made.join(time.monotonic() + WAIT_S)


@pytest.mark.parametrize("action", MOTIONS, ids=["sent", "held"])
def test_a_stop_that_a_motion_may_overtake_is_sent_again(
    jobs: Jobs, action: Send | Hold, monkeypatch: pytest.MonkeyPatch
) -> None:
    stops: list[Place] = []
    for module in (request, jogging):
        monkeypatch.setattr(module, "publish_stop", lambda _client, place: stops.append(place))
    outcomes = queue.SimpleQueue[Outcome]()
    moving, robot = Moving(jobs, outcomes.put), MagicMock(side="hw", place=("bea", "hw"))

    def begin(_query: object) -> MagicMock:
        moving.drop(stopped())
        return MagicMock(exception=MagicMock(return_value=stopped()))

    robot.begin = begin
    if isinstance(action, Hold):
        moving.hold(action, MagicMock(hw=robot))
    else:
        moving.request(action, MagicMock(hw=robot))
    until(lambda: stops == [("bea", "hw")], "STOP is sent again")


def test_a_newer_press_ends_an_older_one_without_a_stop(jobs: Jobs) -> None:
    outcomes = queue.SimpleQueue[Outcome]()
    moving, robot = Moving(jobs, outcomes.put), MagicMock(side="hw")
    robot.begin.return_value.exception.side_effect = TimeoutError  # it moves until the end of the test
    twin = MagicMock(hw=robot)
    moving.hold(Hold(1, (("yaw", 1.0),), 20.0, ("hw",)), twin)
    assert outcomes.get(timeout=WAIT_S).accepted
    moving.hold(Hold(2, (("yaw", 1.0),), 20.0, ("hw",)), twin)
    assert (outcomes.get(timeout=WAIT_S).reason, moving.busy) == (Reason.REPLACED, True)
    moving.hold(Hold(1, (("yaw", 1.0),), 20.0, ("hw",)), twin)  # a late heartbeat
    assert outcomes.get(timeout=WAIT_S).row == 2
    moving.drop(replaced())
    assert outcomes.get(timeout=WAIT_S).row == 2
    assert not moving.busy
