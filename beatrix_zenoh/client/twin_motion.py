"""A motion of both robots: the simulation at once, the hardware later; if one fails, the other is stopped."""

from __future__ import annotations

import contextlib
import logging
import queue
import threading
import time
from collections.abc import Callable
from concurrent.futures import Future
from functools import partial
from typing import NamedTuple, Self

from msgspec.structs import replace

from beatrix_zenoh import threads
from beatrix_zenoh.bus import ProcessBound
from beatrix_zenoh.client.lag import MotionBegin, lag_s
from beatrix_zenoh.client.motion import Motion
from beatrix_zenoh.client.robot import Robot
from beatrix_zenoh.client.slips import Suggesting, value_method
from beatrix_zenoh.client.stop_events import StopEvents
from beatrix_zenoh.client.stopping import sentence, stop_robots
from beatrix_zenoh.client.twin_state import PlanPosition
from beatrix_zenoh.contract._generated.messages import MotionQuery, MotionReply, PoseQuery, Reason
from beatrix_zenoh.contract.errors import BeatrixError, Interrupted, NoAnswer, naming

LOG = logging.getLogger("beatrix_zenoh.client")
POLL_S = 0.02
LATE_S = 1.5
"""A motion that is overdue by more than this (s) is not sent to the hardware: its program was suspended."""
CANCEL_S = 10.0
"""Longest wait (s) for robots that do not answer STOP."""
REPLACED = "A newer motion of this program replaced this one before it was sent to the hardware."


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
        self.lead_s = lead_s
        self._begun: dict[Robot, Motion] = {}
        self._sending: Robot | None = None
        self._due_s: float | None = None
        self._permit = threading.Lock()
        """The thread that acquires it decides whether the motion is sent to the hardware. It is acquired without
        waiting and never released, so that a signal handler may acquire it at any point."""
        self._sent = False
        self._end: BeatrixError | None = None
        """The error with which the motion is to end."""
        self._wakeups: queue.SimpleQueue[None] = queue.SimpleQueue()
        self._future: Future[TwinReplies] = Future()
        self._thread = 0
        self._begins: tuple[MotionBegin, MotionBegin] | None = None
        self._check_both: Callable[[], None] = lambda: None
        self._check_present: Callable[[], None] = lambda: None
        self._stops: list[StopEvents] = []
        """STOP events of both robots, during the lead."""
        self.lag_s: float | None = None
        """Lag of the hardware behind the simulation (s), from published positions; None until both have ended, for a
        motion without a preview, and if one of them moved less than 0.5 deg."""

    def __repr__(self) -> str:
        if self.done():
            return f"<motion of {self._sim} and {self._hw}: {self.exception() or 'both have arrived'}>"
        wait = "" if self._sent else f", the hardware in {self.countdown_s:.1f} s"
        return f"<motion of {self._sim} and {self._hw}{wait}>"

    # -- as a future -----------------------------------------------------------------------------

    @property
    def hardware_sent(self) -> bool:
        """Whether the motion was sent to the hardware."""
        return self._sent

    @property
    def countdown_s(self) -> float:
        """Seconds until the motion is sent to the hardware; 0 if it was sent or will not be sent."""
        if self._due_s is None:
            return 0.0 if self._permit.locked() else self.lead_s
        return 0.0 if self._permit.locked() else max(0.0, self._due_s - time.monotonic())

    @value_method
    def done(self) -> bool:
        """Return whether the motion of both robots has ended, at its goal or before it."""
        return self._future.done()

    @value_method
    def running(self) -> bool:
        """Return whether the motion has not ended yet."""
        return not self.done()

    @value_method
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

    @value_method
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
        self.hold()
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
        if self._due_s is None or self._permit.locked() or self.done():
            return False
        self._due_s = min(self._due_s, time.monotonic())
        self._wakeups.put(None)
        return True

    # -- used by Twin, Plan and window -----------------------------------------------------------

    def measure(self, sim: PlanPosition, hw: PlanPosition) -> None:
        """Have the lag measured; the motion begins with both robots at rest at these positions."""
        self._begins = MotionBegin(self._sim, sim.arms), MotionBegin(self._hw, hw.arms)

    def watch(
        self, check: Callable[[], None], check_present: Callable[[], None], sim_t: float, hw_t: float
    ) -> None:
        """Have both robots checked until the motion is sent to the hardware; an exception of a check ends the motion.

        Args:
            check: called just before the motion is sent to the hardware.
            check_present: called continuously, because a robot that was not on line may have been replaced.
            sim_t: time at which the simulation was at rest (s, its own clock); a STOP since then ends the motion.
            hw_t: as `sim_t`, for the hardware.
        """
        self._check_both, self._check_present = check, check_present
        self._stops = [StopEvents(self._sim, sim_t), StopEvents(self._hw, hw_t)]

    def hold(self) -> bool:
        """Keep other threads from sending the motion to the hardware; return False if it was sent or held before."""
        return self._permit.acquire(blocking=False)

    def end(self, why: BeatrixError) -> None:
        """Request that the motion ends with this error; only the first call has an effect."""
        self._end = self._end or why
        self._wakeups.put(None)

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
            self._due_s = time.monotonic() + self.lead_s
            if not self.lead_s:
                self._send_to_hardware()
            if wait:
                self._settle(self._follow())
        except BaseException as error:
            failure = self._failed(error)
            if failure is error:
                raise
            raise failure from error
        if not wait:
            threads.start(self._run, "twin-motion")

    # -- the thread that carries it out ----------------------------------------------------------

    def _run(self) -> None:
        self._thread = threading.get_ident()
        try:
            self._settle(self._follow())
        except BaseException as error:  # noqa: BLE001  # it is raised by `result`
            self._failed(error)

    def _settle(self, replies: TwinReplies) -> None:
        self._measured()
        self._close()
        self._future.set_result(replies)

    def _follow(self) -> TwinReplies:
        if not self._sent:
            self._wait_for_lead()
        while not self._poll(POLL_S):
            pass
        return TwinReplies(self._begun[self._sim].result(0), self._begun[self._hw].result(0))

    def _wait_for_lead(self) -> None:
        while not self._sent:
            left_s = (self._due_s or 0.0) - time.monotonic()
            self._poll(max(0.001, min(left_s, POLL_S)))
            self._check_stopped()
            self._check_present()
            if left_s < -LATE_S:
                raise Interrupted(
                    Reason.STOPPED,
                    f"This program was suspended for {-left_s:.1f} s: the motion is too late for the hardware and was not sent.",
                )
            if left_s <= 0 and not self._permit.locked():
                self._check_both()
                self._send_to_hardware()

    def _check_stopped(self) -> None:
        """Raise Interrupted (STOPPED) if a client has stopped one of the robots, even at rest."""
        for stops in self._stops:
            stops.check(" before the motion was sent to the hardware")

    def _poll(self, limit_s: float) -> bool:
        """Wait up to `limit_s` (s); return whether all begun motions have arrived; raise the error that ends them."""
        self._raise_end()
        if self._sim.client.bus.closed:
            raise NoAnswer(
                Reason.SHUTDOWN, "This program closed its connection, so the robots stop its motions."
            )
        for begin in self._begins or ():
            begin.read()
        arrived = [
            ended(robot, motion, limit_s if self._sent else 0.0) for robot, motion in self._begun.items()
        ]
        if not self._sent:
            with contextlib.suppress(queue.Empty):
                self._wakeups.get(timeout=limit_s)
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
        if self.hold():
            self._raise_end()  # a signal handler may have cancelled the motion just after `hold`
            self._sent = True
            self._send(self._hw)

    def _failed(self, error: BaseException) -> BaseException:
        """Stop running motions and return the error to raise; `result` raises it, too."""
        self.hold()
        try:
            moving = [robot for robot, motion in self._begun.items() if runs(motion)]
            if isinstance(error, KeyboardInterrupt) and self._sending is not None:
                moving.append(
                    self._sending
                )  # it may have accepted the motion, although its reply was not read
            kept = self.lead_s and not self._sent
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
        for begin in self._begins or ():
            begin.close()
        for stops in self._stops:
            stops.close()

    def _measured(self) -> None:
        if self._begins is None:
            return
        for begin in self._begins:
            begin.read()
        self.lag_s = lag_s(*self._begins)
        if self.lag_s is not None:
            LOG.info(
                "%s: the hardware began %.3f s after the simulation; lead %.3f s.",
                self._hw.name,
                self.lag_s,
                self.lead_s,
            )


def stopped(error: BaseException, moving: list[Robot], unmoved: str = "") -> BaseException:
    """Stop robots because of an error, in reverse order; return the error with their positions in its message.

    If one robot fails, the other must not finish the motion. A replaced motion is not stopped.
    """
    if isinstance(error, Interrupted) and error.reason is Reason.REPLACED:
        return error
    rests: list[str] = []
    if not (moving and moving[0].client.bus.closed):
        rests = [sentence(robot.place, answer.message) for robot, answer in stop_robots(reversed(moving))]
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
