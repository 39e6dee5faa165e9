"""A motion as a future, with replies from the test."""

from __future__ import annotations

import logging
import queue
import threading
from collections.abc import Callable, Iterator
from typing import cast

import pytest
from robots import until

from beatrix_zenoh.client.motion import Motion
from beatrix_zenoh.client.request import Request
from beatrix_zenoh.client.session import Dispatcher
from beatrix_zenoh.contract._generated.messages import CommandReply, MotionReply, Phase, Reason, Vector3
from beatrix_zenoh.contract.errors import BeatrixError, Interrupted, NoAnswer

ORIGIN = Vector3(0.0, 0.0, 0.0)
PATIENCE_S = 5.0


def motion_reply(phase: Phase, reason: Reason = Reason.OK, duration: float = 60.0) -> MotionReply:
    return MotionReply(
        result=reason is Reason.OK,
        phase=phase,
        reason=reason,
        message=f"It is {reason}.",
        motion=1,
        duration=duration,
        position=ORIGIN,
    )


DONE = motion_reply(Phase.DONE)
STOPPED = motion_reply(Phase.DONE, Reason.STOPPED)


class Replies:
    """A fake `Request`."""

    def __init__(self) -> None:
        self._inbox: queue.SimpleQueue[MotionReply | NoAnswer] = queue.SimpleQueue()
        self._notify: Callable[[], None] | None = None
        self.waiting = threading.Event()
        self.closed = False
        self.cause = NoAnswer(Reason.TIMED_OUT)
        self.limit_s = 0.0

    def send(self, reply: MotionReply | NoAnswer) -> None:
        self._inbox.put(reply)
        if self._notify is not None:
            self._notify()

    def reply(self, kind: type[MotionReply], timeout_s: float) -> MotionReply:  # noqa: ARG002
        if timeout_s:
            self.waiting.set()
        try:
            found = self._inbox.get(timeout=timeout_s)
        except queue.Empty:
            raise TimeoutError from None
        if isinstance(found, NoAnswer):
            raise found
        return found

    def notify(self, notify: Callable[[], None]) -> None:
        self._notify = notify
        if not self._inbox.empty():
            notify()

    def explain(self, limit_s: float) -> NoAnswer:
        self.limit_s = limit_s
        return self.cause

    def close(self) -> None:
        self.closed = True


class Setting:
    """A motion, its replies, and the number of STOPs."""

    def __init__(self, duration: float = 60.0) -> None:
        self.replies, self.dispatcher, self.stops = Replies(), Dispatcher(), 0
        accepted = motion_reply(Phase.ACCEPTED, duration=duration)
        self.motion = Motion("bea (hw)", cast("Request", self.replies), accepted, self.stop, self.dispatcher)
        self.called: queue.SimpleQueue[str] = queue.SimpleQueue()

    def stop(self) -> CommandReply:
        self.stops += 1
        self.replies.send(STOPPED)
        return CommandReply(result=True, reason=Reason.OK, message="Stopped.", position=ORIGIN)

    def record(self, motion: Motion) -> None:
        assert motion is self.motion
        self.called.put(threading.current_thread().name)


@pytest.fixture
def setting() -> Iterator[Setting]:
    made = Setting()
    yield made
    made.dispatcher.close()


def test_a_motion_runs_until_its_final_reply(setting: Setting) -> None:
    motion = setting.motion
    assert (motion.running(), motion.done(), motion.duration) == (True, False, 60.0)
    with pytest.raises(TimeoutError, match="still runs"):
        motion.result(0.01)
    setting.replies.send(DONE)
    assert (motion.running(), motion.done()) == (False, True)
    assert (motion.result(), motion.exception(), motion.wait()) == (DONE, None, DONE)
    assert setting.replies.closed


GONE = NoAnswer(Reason.NO_ROUTER, "The router has gone.")


@pytest.mark.parametrize(
    ("end", "error", "text"), [(STOPPED, Interrupted, "It is STOPPED"), (GONE, NoAnswer, "has gone")]
)
def test_a_motion_without_success_raises_at_each_call(
    setting: Setting, end: MotionReply | NoAnswer, error: type[BeatrixError], text: str
) -> None:
    setting.replies.send(end)
    for wait in (setting.motion.result, setting.motion.wait):
        with pytest.raises(error, match=text) as caught:
            wait()
        assert caught.value.reason is end.reason
    assert isinstance(setting.motion.exception(), error)
    assert setting.motion.done()


def test_a_motion_that_is_overdue_counts_as_lost(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("beatrix_zenoh.client.motion.MARGIN_S", 0.05)
    setting = Setting(duration=0.0)
    with pytest.raises(NoAnswer, match="did not report") as caught:
        setting.motion.result()
    assert caught.value.reason is Reason.TIMED_OUT
    assert setting.replies.limit_s == 0.05
    assert setting.motion.done()


def test_cancel_presses_stop_once(setting: Setting) -> None:
    assert setting.motion.cancel()
    assert setting.stops == 1
    assert not setting.motion.cancel()
    assert setting.stops == 1
    assert isinstance(setting.motion.exception(), Interrupted)


def test_a_callback_runs_in_a_thread_of_its_own_or_after_the_end_in_the_calling_thread(
    setting: Setting,
) -> None:
    setting.motion.add_done_callback(setting.record)
    setting.motion.add_done_callback(setting.record)
    setting.replies.send(DONE)
    assert [setting.called.get(timeout=PATIENCE_S) for _ in "ab"] == ["beatrix-callbacks"] * 2
    setting.motion.add_done_callback(setting.record)
    assert setting.called.get(timeout=0) == threading.current_thread().name


def test_a_callback_that_fails_is_logged_and_the_next_runs(
    setting: Setting, caplog: pytest.LogCaptureFixture
) -> None:
    def fail(_: Motion) -> None:
        raise ValueError("mine")

    with caplog.at_level(logging.ERROR, "beatrix_zenoh.client"):
        setting.motion.add_done_callback(fail)
        setting.motion.add_done_callback(setting.record)
        setting.replies.send(DONE)
        setting.called.get(timeout=PATIENCE_S)
    assert [record.exc_info[0] for record in caplog.records if record.exc_info] == [ValueError]


def test_ctrl_c_stops_the_robot_and_reports_the_reply(
    setting: Setting, monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupted(kind: type[MotionReply], timeout_s: float) -> MotionReply:
        raise KeyboardInterrupt

    monkeypatch.setattr(setting.replies, "reply", interrupted)
    with pytest.raises(KeyboardInterrupt, match=r"bea \(hw\): Stopped."):
        setting.motion.wait()
    assert setting.stops == 1


def test_what_the_last_callback_asks_for_is_called_before_the_end() -> None:
    dispatcher, begun, goes, called = Dispatcher(), threading.Event(), threading.Event(), threading.Event()

    def last() -> None:
        begun.set()
        goes.wait(5.0)
        dispatcher.call(called.set)

    dispatcher.call(last)
    assert begun.wait(5.0)
    closing = threading.Thread(target=dispatcher.close)
    closing.start()
    until(lambda: dispatcher._closed, "it is being closed")
    goes.set()
    closing.join(5.0)
    assert called.is_set()
