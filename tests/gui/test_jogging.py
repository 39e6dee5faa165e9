"""Presses of held buttons: which press an outcome ends."""

from __future__ import annotations

import queue
import time
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any, cast

from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.errors import BeatrixError, Interrupted
from gui.console.link.jobs import Jobs
from gui.console.link.jogging import Jogging, Press
from gui.console.state.actions import Outcome

WAIT_S = 10.0


class Began:
    """A motion that ends when the test says so."""

    accepted = SimpleNamespace(message="")

    def __init__(self) -> None:
        self._error: BeatrixError | None = None
        self._done: Callable[[Began], None] = lambda _: None

    def add_done_callback(self, done: Callable[[Began], None]) -> None:
        self._done = done

    def exception(self, _wait_s: float) -> BeatrixError | None:
        return self._error

    def end(self, error: BeatrixError) -> None:
        self._error = error
        self._done(self)


def test_the_late_end_of_a_motion_does_not_end_a_press_that_has_begun_since() -> None:
    motions, outcomes = queue.SimpleQueue[Began](), queue.SimpleQueue[Outcome]()

    def begin(_query: object) -> Began:
        motions.put(made := Began())
        return made

    robot = cast("Any", SimpleNamespace(side="hw", begin=begin))
    jobs = Jobs("tested")
    jogging = Jogging(jobs, outcomes.put)
    first, second = (Press(number, "yaw", 1, 20.0, (robot,), row=number) for number in (1, 2))
    try:
        jogging.hold(first)
        stopped = motions.get(timeout=WAIT_S)
        assert outcomes.get(timeout=WAIT_S).accepted
        jogging.end(stopped=True)
        jogging.hold(second)
        stopped.end(Interrupted(Reason.STOPPED))
        assert (jogging.held(2), jogging.over) == (second, 1)
        last = motions.get(timeout=WAIT_S)
        while outcomes.get(timeout=WAIT_S).row != 2:
            pass
        last.end(Interrupted(Reason.STOPPED))
        assert (jogging.held(2), jogging.over) == (None, 2)
    finally:
        jobs.close()
        jobs.join(time.monotonic() + WAIT_S)
