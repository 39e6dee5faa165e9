"""A motion of both robots: the simulation at once, the hardware later; if one fails, the other is stopped."""

from __future__ import annotations

import contextlib
import logging
import threading
import time
from collections.abc import Callable
from concurrent.futures import Future
from functools import partial
from typing import NamedTuple, Self

from msgspec.structs import replace

from beatrix_zenoh import threads
from beatrix_zenoh.bus import ProcessBound
from beatrix_zenoh.client.degrees import ArmAngles
from beatrix_zenoh.client.motion import Motion
from beatrix_zenoh.client.robot import Robot
from beatrix_zenoh.client.robot_base import offset_of
from beatrix_zenoh.client.slips import Suggesting
from beatrix_zenoh.client.stopping import StopEvents, sentence, stop_robots
from beatrix_zenoh.client.twin_state import POLL_S, Lead, PlanPosition
from beatrix_zenoh.contract._generated.messages import MotionQuery, MotionReply, PoseQuery, Reason
from beatrix_zenoh.contract.errors import BeatrixError, Interrupted, NoAnswer, naming

LOG = logging.getLogger("beatrix_zenoh.client")
MOVED_DEG = 0.5
"""Distance of an arm from its start at which a motion counts as begun; until then both robots accelerate alike."""
CANCEL_S = 10.0
"""Longest wait (s) for robots that do not answer STOP."""
REPLACED = "A newer motion of this program replaced this one before it was sent to the hardware."


class MotionBegin:
    """Finds the time at which one robot begins to move."""

    def __init__(self, robot: Robot, start: ArmAngles) -> None:
        """Subscribe to the robot's positions; `start` are its arm angles (deg) at rest."""
        self._robot, self._start = robot, start
        self._positions = robot.stream()
        self._begin_s: float | None = None

    def read(self) -> None:
        """Process the positions that have arrived."""
        for reading in self._positions.take():
            if self._begin_s is None and furthest(self._start, reading.commanded) >= MOVED_DEG:
                self._begin_s = reading.t

    def begin_s(self) -> float | None:
        """Return the time at which the robot began to move, by this computer's monotonic clock; None: it did not."""
        if self._begin_s is None:
            return None
        with contextlib.suppress(NoAnswer):
            return self._begin_s - offset_of(self._robot).certain
        return None

    def close(self) -> None:
        """End the subscription."""
        self._positions.close()


def furthest(one: ArmAngles, other: ArmAngles) -> float:
    """Return the largest difference (deg) between two angles of the same arm."""
    return max(abs(a - b) for a, b in zip(one, other, strict=True))


class TwinReplies(NamedTuple):
    """The final replies of both robots."""

    sim: MotionReply
    hw: MotionReply


class TwinMotion(ProcessBound, Suggesting):
    """A motion of both robots, similar to concurrent.futures.Future; several threads may use it.

    The simulation begins at once and the hardware `lead_s` later. During the lead, `cancel`, STOP at either robot,
    Ctrl-C in the waiting thread, or a newer motion of the same Twin leaves the hardware unmoved.
    """

    def __init__(self, sim: Robot, hw: Robot, query: MotionQuery | PoseQuery, lead_s: float = 0.0) -> None:
        self._sim, self._hw, self._query = sim, hw, replace(query, lead=lead_s)
        self.lead_s: float = lead_s
        """Seconds by which the hardware begins later than the simulation."""
        self.lag_s: float | None = None
        """Lag of the hardware behind the simulation (s), from published positions.

        None until both have ended, for a motion without a preview, and if one of them moved less than 0.5 deg.
        """
        self._future: Future[TwinReplies] = Future()
        self._lead = Lead(lead_s)
        self._begun: dict[Robot, Motion] = {}
        self._sending: Robot | None = None
        self._end: BeatrixError | None = None
        """The error with which the motion is to end."""
        self._thread = 0
        """Identity of the thread that carries the motion out; 0: not started."""
        self._begins: list[MotionBegin] = []
        """Begin of both motions; empty: not measured."""

    def __repr__(self) -> str:
        if self.done():
            return f"<motion of {self._sim} and {self._hw}: {self.exception() or 'both have arrived'}>"
        wait = "" if self.hardware_sent else f", the hardware in {self.countdown_s:.1f} s"
        return f"<motion of {self._sim} and {self._hw}{wait}>"

    @property
    def hardware_sent(self) -> bool:
        """Whether the motion was sent to the hardware."""
        return self._lead.sent

    @property
    def countdown_s(self) -> float:
        """Seconds until the motion is sent to the hardware; 0 if it was sent or will not be sent."""
        return self._lead.countdown_s

    def done(self) -> bool:
        """Return whether the motion of both robots has ended, at its goal or before it."""
        return self._future.done()

    def running(self) -> bool:
        """Return whether the motion has not ended yet."""
        return not self.done()

    def result(self, timeout: float | None = None) -> TwinReplies:
        """Wait until both robots have arrived and return their final replies.

        Args:
            timeout: longest wait (s); None: until both have reported the end or count as lost.

        Raises:
            TimeoutError: the motion still runs after `timeout`.
            Interrupted: the motion of one robot was stopped, or this one was cancelled or replaced.
            Refused: one robot refused.
            NoAnswer: one robot or the router was lost.
        """
        self._wait(timeout)
        return self._future.result(0)

    def exception(self, timeout: float | None = None) -> BaseException | None:
        """Wait as `result` does, but return the error that `result` would raise; None if both have arrived.

        Raises:
            TimeoutError: the motion still runs after `timeout`.
        """
        self._wait(timeout)
        return self._future.exception(0)

    def _wait(self, timeout: float | None) -> None:
        """Wait in short steps, because on Windows Ctrl-C does not end a wait without a timeout."""
        deadline_s = float("inf") if timeout is None else time.monotonic() + timeout
        while not self._future.done():
            left_s = deadline_s - time.monotonic()
            if left_s <= 0:
                raise TimeoutError(f"The motion of {self._sim} and {self._hw} still runs.")
            try:
                self._future.exception(min(left_s, 0.2))
            except TimeoutError:
                continue

    def cancel(self) -> bool:
        """Stop both robots; during the lead, stop the simulation and leave the hardware unmoved.

        Returns True when the arms rest (or after 10 s), or False if the motion had ended before. In a signal handler
        that interrupts the waiting thread it returns at once, and the motion ends after the handler.
        """
        if self.done():
            return False
        self.end(Interrupted(Reason.STOPPED, "Cancelled by this program."))
        if self._thread not in (0, threading.get_ident()):
            try:
                self._wait(CANCEL_S)
            except TimeoutError:
                LOG.warning("%r did not end within %g s of its cancellation.", self, CANCEL_S)
        return True

    def add_done_callback(self, call: Callable[[Self], object]) -> None:
        """Call `call(motion)` at the end of the motion, in the client's thread for callbacks.

        If the motion has ended, call it at once in this thread.
        """
        if self.done():
            call(self)
        else:
            dispatcher = self._sim.client.dispatcher
            self._future.add_done_callback(lambda _: dispatcher.call(partial(call, self)))

    def send_now(self) -> bool:
        """End the lead now: the motion is sent to the hardware after the usual checks.

        Returns at once: False if the simulation has not begun, or the motion was sent or cancelled before; else True.
        """
        return not self.done() and self._lead.send_now()

    # -- how `Twin` and `Plan` carry it out ------------------------------------------------------------

    def prepare(
        self, sim: PlanPosition, hw: PlanPosition, check_both: Callable[[], None], *, measured: bool
    ) -> None:
        """Have both robots checked until the motion is sent to the hardware, as `Lead.watch` does.

        Args:
            sim: position at which the simulation was at rest; a STOP since then ends the motion.
            hw: as `sim`, for the hardware.
            check_both: called just before the motion is sent to the hardware.
            measured: whether both robots are at rest there, so that the lag is measured.
        """
        robots = (self._sim, sim), (self._hw, hw)
        if measured:
            self._begins = [MotionBegin(robot, position.arms) for robot, position in robots]
        if self.lead_s:
            self._lead.watch(check_both, [StopEvents(robot, position.t) for robot, position in robots])

    def hold(self) -> bool:
        """Keep other threads from sending the motion to the hardware; return False if it was sent or held before."""
        return self._lead.claim()

    def end(self, why: BeatrixError) -> None:
        """Request that the motion ends with this error, as `hold` does; only the error of the first call is raised."""
        self.hold()
        self._end = self._end or why

    def start(self, *, wait: bool, begun: Callable[[], None] = lambda: None) -> None:
        """Send the motion to the simulation, call `begun`, and without a lead send it to the hardware, too.

        Then wait until both have arrived, or continue in a thread.

        Raises:
            BeatrixError: as `result`; without `wait` only the errors before it returns.
        """
        self._thread = threading.get_ident()
        try:
            self._raise_end()
            self._send(self._sim)
            begun()
            self._lead.begin()
            if not self.lead_s:
                self._send_to_hardware()
            if wait:
                self._finish(self._follow())
        except BaseException as error:
            failure = self._failed(error)
            if failure is error:
                raise
            raise failure from error
        if not wait:
            threads.start(self._continue, "twin-motion")

    def _continue(self) -> None:
        self._thread = threading.get_ident()
        try:
            self._finish(self._follow())
        except BaseException as error:  # noqa: BLE001  # it is raised by `result`
            # What its STOP raises is raised by `result`, too; for example when the client is closed.
            with contextlib.suppress(Exception):
                self._failed(error)

    def _finish(self, replies: TwinReplies) -> None:
        self._measure()
        self._close()
        self._future.set_result(replies)

    def _follow(self) -> TwinReplies:
        while not self._lead.sent:
            self._lead.wait()
            self._poll(0.0)
            if self._lead.due():
                self._send_to_hardware()
        while not self._poll(POLL_S):
            pass
        return TwinReplies(self._begun[self._sim].result(0), self._begun[self._hw].result(0))

    def _poll(self, limit_s: float) -> bool:
        """Wait up to `limit_s` (s); return whether all begun motions have arrived; raise the error that ends them."""
        self._raise_end()
        if self._sim.client.bus.closed:
            raise NoAnswer(
                Reason.SHUTDOWN, "This program closed its connection, so the robots stop its motions."
            )
        for begin in self._begins:
            begin.read()
        arrived = [ended(robot, motion, limit_s) for robot, motion in self._begun.items()]
        return all(arrived)

    def _raise_end(self) -> None:
        if self._end is not None:
            raise self._end

    def _send(self, robot: Robot) -> None:
        self._sending = robot
        with naming(str(robot)):
            self._begun[robot] = robot.begin(self._query)
        self._sending = None

    def _send_to_hardware(self) -> None:
        if self._lead.claim():
            self._raise_end()  # a signal handler may have cancelled the motion just after `claim`
            self._lead.sent = True
            self._send(self._hw)

    def _failed(self, error: BaseException) -> BaseException:
        """Stop running motions and return the error to raise; `result` raises it, too."""
        self._lead.claim()
        try:
            moving = [robot for robot, motion in self._begun.items() if runs(motion)]
            if isinstance(error, KeyboardInterrupt) and self._sending is not None:
                moving.append(
                    self._sending
                )  # it may have accepted the motion, although its reply was not read
            kept = self.lead_s and not self._lead.sent
            failure = stopped(error, moving, f"{self._hw}: not moved." if kept else "")
        except BaseException as again:
            failure = again
            raise
        finally:
            self._close()
            if self._future.done():
                pass
            elif isinstance(failure, KeyboardInterrupt):
                self._future.set_exception(Interrupted(Reason.STOPPED, f"Interrupted by Ctrl-C. {failure}"))
            else:
                self._future.set_exception(failure)
        return failure

    def _close(self) -> None:
        """End the subscriptions."""
        for begin in self._begins:
            begin.close()
        self._lead.close()

    def _measure(self) -> None:
        for begin in self._begins:
            begin.read()
        begun = [begin.begin_s() for begin in self._begins]
        match begun:
            case [float(sim_s), float(hw_s)]:
                self.lag_s = hw_s - sim_s


def stopped(error: BaseException, moving: list[Robot], unmoved: str = "") -> BaseException:
    """Stop robots because of an error, in reverse order; return the error with their positions in its message.

    If one robot fails, the other must not finish the motion. A replaced motion is not stopped. A cause that STOP meets
    again, such as a lost router, is in the message only once.
    """
    if isinstance(error, Interrupted) and error.reason is Reason.REPLACED:
        return error
    rests: list[str] = []
    if not (moving and moving[0].client.bus.closed):
        told = [error.message] if isinstance(error, BeatrixError) else []
        for robot, answer in stop_robots(reversed(moving)):
            if isinstance(answer, BeatrixError) and any(answer.message in line for line in (*told, *rests)):
                continue
            rests.append(sentence(robot.place, answer.message))
    if unmoved:
        rests.append(unmoved)
    if isinstance(error, KeyboardInterrupt):
        return KeyboardInterrupt("\n".join(rests))
    if isinstance(error, BeatrixError) and rests:
        return type(error)(error.reason, "\n".join([error.message, *rests]), error.detail)
    return error


def ended(robot: Robot, motion: Motion, timeout_s: float) -> bool:
    """Wait up to `timeout_s` (s); return whether the motion has reached its goal.

    Raises:
        Interrupted: the motion was stopped or replaced; the message names the robot.
        NoAnswer: as `Motion.result`.
    """
    try:
        error = motion.exception(timeout_s)
    except TimeoutError:
        return False
    if isinstance(error, Interrupted):
        raise Interrupted(error.reason, f"{robot}: {error.message}", error.detail)
    if error is not None:
        raise error
    return True


def runs(motion: Motion) -> bool:
    """Return whether the robot may still move: it has not reported the end of its motion, or the robot is lost."""
    try:
        return isinstance(motion.exception(0.0), NoAnswer)
    except TimeoutError:
        return True
