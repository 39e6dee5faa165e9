"""The motion controller, which begins, follows and ends motions; the reasons and sentences of their ends.

The way of a motion through the node is in three files: `motions` queues and decodes the request and replies to it;
this file asks access and planner, sends the frame and finds the end; `planner` checks the limits and makes the frame.
"""

from __future__ import annotations

import secrets
import time
from collections.abc import Callable
from enum import Enum

import msgspec

from beatrix_zenoh.board.board import Board
from beatrix_zenoh.contract._generated.messages import MotionQuery, PoseQuery, Reason
from beatrix_zenoh.contract._generated.serial import (
    BoardOutcome,
    BoardState,
    FrameType,
    Move,
    MoveStraight,
    Telemetry,
)
from beatrix_zenoh.contract.errors import BeatrixError, NoAnswer
from beatrix_zenoh.motion.gear import Arms
from beatrix_zenoh.node.access import Access, Operation
from beatrix_zenoh.node.callers import Caller
from beatrix_zenoh.node.events import Diagnostics
from beatrix_zenoh.node.planner import Goal, Planner, degrees

NUMBERS = 65535
"""The highest number of a motion."""
LATE_S = 2.0
"""Time (s) after the planned end at which a motion without an outcome counts as not carried out."""
CLOSE_S = 0.8
"""Longest time (s) for which a closing node waits for the arms to rest."""


class StopCause(Enum):
    """Causes for which a node stops a motion: the reason in the last reply, and the words after `Ended`."""

    STOP = Reason.STOPPED, BoardOutcome.STOPPED.text
    TAKEN = Reason.STOPPED, "by the teacher, who has taken the robot"
    FROZEN = Reason.STOPPED, "by the teacher, who has frozen the robot"
    MUTED = Reason.STOPPED, "by the teacher, who has muted this seat"
    SKIPPED = Reason.STOPPED, "by the teacher, who has ended this turn"
    TURN_OVER = Reason.STOPPED, "by its node, because the time of this turn is over"
    TOO_FAST = Reason.STOPPED, "by the teacher, whose new speed limit is lower"
    SHUTDOWN = Reason.SHUTDOWN, "by its node, which is closing"
    CLIENT_LOST = Reason.CLIENT_LOST, "by its node, because the client that requested it is gone"


POWERLESS = (BoardOutcome.DISABLED, BoardOutcome.EMERGENCY)
RESET = (
    "The board was reset: its motors are off, and home is not known. Set the head upright, enable, calibrate."
)
SILENT = (
    "The board does not answer any more. If it has power, it stops the arms by itself, half a second after the last "
    "frame of its node; if they still move, switch the motor power off."
)
SUPERSEDED = "The board carries out a newer motion, which it has not acknowledged."
NOT_CARRIED_OUT = "The board acknowledged the motion but does not carry it out."

Ended = Callable[[int, Reason, str, float], None]
"""Callback at the end of a motion: its number, reason, sentence, and time taken (s)."""


class Running(msgspec.Struct, frozen=True):
    """A motion of a query that the firmware is carrying out."""

    number: int
    caller: Caller
    goal: Goal
    boot: int
    """boot number of the board when the motion began"""
    began_s: float
    overdue_s: float
    """time at which a motion without an outcome counts as not carried out"""
    ended: Ended


class MotionController:
    """Controls the motions of one robot; all methods except `arms` and `overdue` run on the controller's thread.

    `board`, `planner`, `access` and `diagnostics` are those of the robot.
    """

    def __init__(self, board: Board, planner: Planner, access: Access, diagnostics: Diagnostics) -> None:
        self.board, self.planner = board, planner
        self.access, self.diagnostics = access, diagnostics
        self.running: Running | None = None
        """The running motion of a query."""
        self.on_stop: list[Callable[[], None]] = []
        """Functions to call after each STOP, which discard motions outside the request queue."""
        self._number = secrets.randbelow(NUMBERS)  # random, to differ from that of an earlier node
        self._stop_cause = StopCause.STOP
        self._lost = True
        self.last_goal: Goal | None = None
        """Goal of the last motion of a query, from which relative motions count (see `Planner.base`); None after an old
        program has moved the arms, or home was set."""
        self.calibrations = 0
        """Number of times that a client or an old program has set home."""
        self.text_moves = False
        """Whether a motion of the text port is running or about to begin."""
        self.follows = False
        """Whether the arms of this simulation move because it follows the hardware; `FollowHandler` sets it."""

    def arms(self) -> Arms:
        """Return the firmware's set points (rad); zeros before the first telemetry."""
        telemetry = self.board.telemetry
        return (0.0, 0.0, 0.0) if telemetry is None else self.planner.gear.to_rad(telemetry.position)

    def base(self) -> Arms:
        """Return the arm angles (rad) that relative motions count from; zeros before the first telemetry."""
        telemetry = self.board.telemetry
        return (0.0, 0.0, 0.0) if telemetry is None else self.planner.base(telemetry, self.last_goal)

    @property
    def driven(self) -> bool:
        """Whether this node moves the arms: a motion of a query or the text port, or because it follows the hardware."""
        return self.running is not None or self.text_moves or self.follows

    @property
    def moving(self) -> bool:
        """Whether the board reports that the arms move."""
        return self.board.connected and bool(self.board.state & BoardState.MOVING)

    def begin(
        self,
        query: MotionQuery | PoseQuery,
        caller: Caller,
        ended: Ended,
        accepted: Callable[[int, Goal], None] = lambda *_: None,
    ) -> None:
        """Check a motion and send it to the board; then call `accepted`, and at the end of the motion `ended`.

        `accepted` is called before the `ended` of a motion that this one replaces.

        Raises:
            BeatrixError: the motion was refused, and a running motion continues; or the board did not answer, and the
                node has sent STOP.
        """
        now_s = time.monotonic()
        resting = not self.moving and self.running is None
        self.access.authorize(Operation.MOVE, caller, now_s, resting=resting, lease=query.lease)
        with self.access.lock:
            self.planner.limit_turn(self.access.lease.terms.speed(caller.seat))
        try:
            goal = self.planner.goal(query, self.board.ready_telemetry(), self.last_goal)
        finally:
            self.planner.limit_turn(0.0)  # `info` shows the limits of the robot, not those of a seat
        self.access.take(caller)
        try:
            number, boot = self.send(goal.frame)
        except BeatrixError:
            self.access.undo_take()
            raise
        replaced, self.last_goal = self.running, goal
        self.running = Running(number, caller, goal, boot, now_s, now_s + goal.duration + LATE_S, ended)
        self._stop_cause = StopCause.STOP
        accepted(number, goal)
        if replaced is not None:
            text = f"A newer motion ({number}, of {caller.seat}) replaced this one."
            replaced.ended(replaced.number, Reason.REPLACED, text, now_s - replaced.began_s)

    def send(self, frame: Callable[[int], Move | MoveStraight]) -> tuple[int, int]:
        """Send a motion to the board; `frame` returns it by its number. Return this number and the board's boot number.

        Raises:
            BeatrixError: the firmware refused the motion, and the last one continues; or the board did not answer, and
                this node has sent STOP.
        """
        telemetry = self.board.telemetry
        # Use a new number even after a failure: a board that received the failed motion ignores a repeated number.
        self._number = next_number(self._number, 0 if telemetry is None else telemetry.motion)
        try:
            self.board.move(frame(self._number))
        except NoAnswer:
            # The client gets a refusal, but the board may have received the motion: stop it.
            self.last_goal = None
            self.stop(StopCause.STOP)
            raise
        return self._number, 0 if telemetry is None else telemetry.boot

    def stop(self, cause: StopCause) -> None:
        """Send STOP for this cause; if that fails, only warn: a board without heartbeats stops the arms by itself."""
        self._stop_cause = cause
        try:
            self.board.request(FrameType.STOP)
        except BeatrixError as error:
            self.diagnostics.warn(error.message, error.reason)

    def stop_sent(self, *, acknowledged: bool = True) -> None:
        """End what STOP has not ended yet: later motions of other queues, and a motion that has overtaken STOP.

        `acknowledged`: False if the board has refused or not answered STOP.
        """
        for callback in self.on_stop:
            callback()
        self.access.stop_sent(time.monotonic())
        if acknowledged and self.driven:
            self.stop(StopCause.STOP)

    def client_lost(self) -> None:
        """Stop the running motion and end its lease, because its client or the router was lost."""
        if self.driven:
            self.stop(StopCause.CLIENT_LOST)
            self.access.release(time.monotonic())

    def overdue(self) -> bool:
        """Return whether the running motion should have ended by now; any thread may call it."""
        running = self.running
        return running is not None and time.monotonic() > running.overdue_s

    def observe(self) -> None:
        """Handle a change of the board: a restart, the latch, an unknown motion, the end of the running motion."""
        telemetry, lost = self.board.telemetry, not self.board.connected
        if telemetry is None:
            return
        self.diagnostics.follow_boot(telemetry.boot, calibrated=bool(telemetry.state & BoardState.CALIBRATED))
        if telemetry.state & BoardState.EMERGENCY and not lost:
            self.access.latch(time.monotonic())
        running = self.running
        known = running is not None and telemetry.motion == running.number
        if self._lost and not lost and self.moving and not known:
            self.stop(self._stop_cause)  # the node has reported to the client that this motion has ended
        self._lost = lost
        if running is not None:
            self._observe_running(running, telemetry, lost=lost)

    def _observe_running(self, running: Running, telemetry: Telemetry, *, lost: bool) -> None:
        if lost or telemetry.boot != running.boot:
            reset = self.board.reset or not lost
            self._end(running, Reason.BOARD_LOST, RESET if reset else SILENT)
        elif telemetry.state & BoardState.MOVING:
            return
        elif telemetry.motion == self._number != running.number:
            self._end(running, Reason.BOARD_LOST, SUPERSEDED)
        elif telemetry.motion == running.number and telemetry.outcome != BoardOutcome.NONE:
            end = motion_end(telemetry.outcome, self._stop_cause, self.arms(), self.access.last_stop.seat)
            self._end(running, *end)
        elif self.overdue():
            self._end(running, Reason.BOARD_LOST, NOT_CARRIED_OUT)

    def _end(self, running: Running, reason: Reason, text: str) -> None:
        now_s = time.monotonic()
        self.running = None
        self.access.rested(now_s)
        running.ended(running.number, reason, text, now_s - running.began_s)

    def close(self) -> None:
        """Stop the arms, wait until they rest, and end the running motion."""
        if self.driven:
            self.stop(StopCause.SHUTDOWN)
            self.board.wait_for(lambda telemetry: not telemetry.state & BoardState.MOVING, CLOSE_S)
            self.observe()
        if self.running is not None:
            self._end(self.running, Reason.SHUTDOWN, "The node is closing.")


def next_number(last: int, on_board: int) -> int:
    """Return a motion number other than the last one and the board's, which an earlier node may have chosen."""
    number = last % NUMBERS + 1
    return number % NUMBERS + 1 if number == on_board else number


def motion_end(code: int, cause: StopCause, arms: Arms, presser: str = "") -> tuple[Reason, str]:
    """Return reason and sentence for an outcome other than NONE.

    `cause`: why the node sent STOP; arms in rad; `presser`: seat that pressed STOP, empty if unknown.
    """
    by_seat = f" of {presser}" if presser else ""
    where = degrees(arms)
    if code not in list(BoardOutcome):
        return Reason.CONTRACT_MISMATCH, f"Ended with an unknown outcome ({code}); the arms rest at {where}."
    outcome = BoardOutcome(code)
    if outcome is BoardOutcome.DONE:
        return Reason.OK, f"Arrived; the arms rest at {where}."
    if outcome in POWERLESS:
        first = "reset, enable" if outcome is BoardOutcome.EMERGENCY else "enable"
        return outcome.reason, (
            f"Ended {outcome.text}{by_seat if outcome is BoardOutcome.EMERGENCY else ''}. The arms were at {where}; without power the head may have sunk: set it "
            f"upright, {first}, calibrate."
        )
    if outcome is BoardOutcome.STOPPED:
        reason, words = cause.value
        by_seat = by_seat if cause is StopCause.STOP else ""
        return reason, f"Ended {words}{by_seat}; the arms rest at {where}."
    return outcome.reason, f"Ended {outcome.text}; the arms rest at {where}."
