"""A running motion, similar to concurrent.futures.Future."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from functools import partial
from typing import Generic, TypeVar, cast

from beatrix_zenoh.bus import ProcessBound
from beatrix_zenoh.client.degrees import Speed, motion_query, pose_query, true_or_false
from beatrix_zenoh.client.request import Request
from beatrix_zenoh.client.session import Dispatcher
from beatrix_zenoh.client.slips import Suggesting
from beatrix_zenoh.contract._generated.messages import (
    CommandReply,
    MotionQuery,
    MotionReply,
    PoseQuery,
    Reason,
)
from beatrix_zenoh.contract.errors import BeatrixError, Interrupted, NoAnswer

MotionT = TypeVar("MotionT")
PreviewT = TypeVar("PreviewT")
MARGIN_S = 3.0
"""Time (s) from the announced end of a motion until its final reply counts as lost."""
NO_END = (
    "{} did not report that the motion has ended, although it is online: it or this computer is very busy."
)


class Motion(ProcessBound, Suggesting):
    """A motion that a robot has accepted.

    Several threads may use it. Zenoh's threads only enqueue the final reply; the thread that waits for it reads it.
    Callbacks of `add_done_callback` run in one thread per client, "beatrix-callbacks", which the first callback starts.
    """

    def __init__(
        self,
        robot: str,
        replies: Request,
        accepted: MotionReply,
        stop: Callable[[], CommandReply],
        dispatcher: Dispatcher,
    ) -> None:
        self._robot, self._replies, self._stop, self._dispatcher = robot, replies, stop, dispatcher
        self.duration: float = accepted.duration
        """Announced duration (s)."""
        self.accepted: MotionReply = accepted
        """The robot's first reply: number of the motion and the goal of the arms."""
        self._lost_s = time.monotonic() + self.duration + MARGIN_S
        self._reading = threading.Lock()
        """Held by the thread that reads replies."""
        self._state = threading.Lock()
        self._end: MotionReply | BeatrixError | None = None
        self._callbacks: list[Callable[[Motion], object]] = []
        self._read_again = False

    def __repr__(self) -> str:
        end = self._end
        text = f"{self.duration:.1f} s" if end is None else end.message
        return f"<motion of {self._robot}: {text}>"

    def done(self) -> bool:
        """Return whether the motion has ended, at its goal or before it."""
        self._read(0.0)
        return self._end is not None

    def running(self) -> bool:
        """Return whether the motion has not ended yet."""
        return not self.done()

    def result(self, timeout: float | None = None) -> MotionReply:
        """Wait until the head has reached its goal, and return the robot's final reply.

        Args:
            timeout: longest wait (s); None: until 3 s after the announced end.

        Raises:
            TimeoutError: the motion still runs after `timeout`.
            Interrupted: the motion was stopped or replaced, or the robot ended it for another reason.
            NoAnswer: the robot or the router was lost, or the robot did not report the end.
        """
        end = self._wait(timeout)
        if (error := _error(end)) is not None:
            raise error
        return cast("MotionReply", end)

    def exception(self, timeout: float | None = None) -> BeatrixError | None:
        """Wait as `result` does, but return the error that `result` would raise; None if the head arrived.

        Raises:
            TimeoutError: the motion still runs after `timeout`.
        """
        return _error(self._wait(timeout))

    def _wait(self, timeout: float | None) -> MotionReply | BeatrixError:
        self._read(self._left() if timeout is None else timeout)
        if self._end is None:
            raise TimeoutError(f"The motion of {self._robot} still runs after {timeout or 0.0:g} s.")
        return self._end

    def wait(self) -> MotionReply:
        """Wait as `result` does; Ctrl-C stops the robot, and the KeyboardInterrupt names its position."""
        try:
            return self.result()
        except KeyboardInterrupt as interrupt:
            raise KeyboardInterrupt(f"{self._robot}: {self._stop().message}") from interrupt

    def cancel(self) -> bool:
        """Stop the robot and return True when its arms rest; return False without STOP if the motion had ended.

        Raises the errors of `Robot.stop`.
        """
        if self.done():
            return False
        self._stop()
        return True

    def add_done_callback(self, call: Callable[[Motion], object]) -> None:
        """Call `call(motion)` when the motion has ended; at once in this thread if it has ended already.

        Otherwise the client's thread for callbacks runs it; its exceptions are logged.
        """
        with self._state:
            ended = self._end is not None
            if not ended:
                self._callbacks.append(call)
        if ended:
            call(self)
        else:
            self._replies.notify(lambda: self._dispatcher.call(self._read_now))
            self._dispatcher.call(self._read_now, self._lost_s)

    def _read_now(self) -> None:
        """Read replies for the callbacks; if another thread is reading, that thread arranges for this afterwards."""
        self._read_again = True
        self._read(0.0)

    def _left(self) -> float:
        return max(0.0, self._lost_s - time.monotonic())

    def _read(self, timeout_s: float) -> None:
        """Read the final reply within `timeout_s`, or wait for the thread that is already reading."""
        if self._end is not None:
            return
        deadline = time.monotonic() + timeout_s
        if not self._reading.acquire(timeout=timeout_s):
            return
        try:
            self._read_again = False
            if self._end is None:
                self._end_with(self._next(max(0.0, deadline - time.monotonic())))
        finally:
            self._reading.release()
        if self._read_again:
            self._dispatcher.call(self._read_now)

    def _next(self, timeout_s: float) -> MotionReply | BeatrixError | None:
        try:
            return self._replies.reply(MotionReply, min(timeout_s, self._left()))
        except NoAnswer as error:
            return error
        except TimeoutError:
            return None if self._left() else self._overdue()

    def _overdue(self) -> NoAnswer:
        """Return the error of a motion whose end was not reported in time."""
        error = self._replies.explain(self.duration + MARGIN_S)
        return (
            NoAnswer(error.reason, NO_END.format(self._robot)) if error.reason is Reason.TIMED_OUT else error
        )

    def _end_with(self, end: MotionReply | BeatrixError | None) -> None:
        if end is None:
            return
        with self._state:
            self._end = end
            callbacks, self._callbacks = self._callbacks, []
        self._replies.close()
        for call in callbacks:
            self._dispatcher.call(partial(call, self))


def _error(end: MotionReply | BeatrixError) -> BeatrixError | None:
    """Return the error of a final reply; None if the head arrived."""
    if isinstance(end, BeatrixError):
        return end
    return None if end.result else Interrupted(end.reason, end.message, end.detail)


class Movable(Suggesting, Generic[MotionT, PreviewT]):
    """What takes motions: a robot, or both robots of one name."""

    def look(
        self,
        yaw: float = 0.0,
        pitch: float = 0.0,
        roll: float = 0.0,
        *,
        relative: bool = False,
        speed: float | None = None,
        wait: bool = True,
    ) -> MotionT:
        """Turn the head (deg: yaw left, pitch nose-down, roll right-ear-down positive).

        `speed` (deg/s) is that of the fastest arm. Returns when the head is at the goal; with wait=False, when the
        robot has accepted the motion.

        With relative=True the angles are added to the goal of the last motion, exactly, so that small turns add up. If
        the head is not at this goal, because it still moves (wait=False) or was stopped, they are added to where it is
        at that moment: a program that follows a face may send what it still sees missing as often as it likes. To add
        up turns, wait for each; or count the angles yourself and send them without relative.

        Raises:
            WrongUsage: BAD_VALUE: an argument is not a finite number, or not a bool.
            Refused: the robot refused the motion; the error has the reason and, if there is one, an alternative.
            NoAnswer: the robot or the router is not online, or does not answer.
            Interrupted: the motion was stopped or replaced, or the robot ended it for another reason.
        """
        query = pose_query(yaw, pitch, roll, relative=relative, speed=speed)
        return self._carry_out(query, wait=true_or_false("wait", wait))

    def move(
        self,
        short: float,
        middle: float,
        long: float,
        *,
        relative: bool = False,
        speed: Speed | None = None,
        wait: bool = True,
    ) -> MotionT:
        """Turn the arms (deg, counter-clockwise from above positive).

        `speed` (deg/s) is one number for all arms, or (short, middle, long). Everything else is as in `look`.
        """
        query = motion_query(short, middle, long, relative=relative, speed=speed)
        return self._carry_out(query, wait=true_or_false("wait", wait))

    def preview(
        self,
        yaw: float = 0.0,
        pitch: float = 0.0,
        roll: float = 0.0,
        *,
        relative: bool = False,
        speed: float | None = None,
    ) -> PreviewT:
        """Try a motion of `look` on a copy of the simulation, faster than real time; the robot does not move.

        Of a `Twin`, the plan can then be committed.

        Raises:
            WrongUsage: BAD_VALUE: this is hardware alone, or an argument is invalid.
            Refused: `look` would be refused; the error has the reason and, if there is one, an alternative.
            NoAnswer: the simulation or the router is not online, or does not answer.
        """
        return self.preview_query(pose_query(yaw, pitch, roll, relative=relative, speed=speed))

    def _carry_out(self, query: MotionQuery | PoseQuery, *, wait: bool) -> MotionT:
        raise NotImplementedError

    def preview_query(self, query: MotionQuery | PoseQuery) -> PreviewT:
        """Preview a motion (rad, rad/s); raises the errors of `preview`."""
        raise NotImplementedError
