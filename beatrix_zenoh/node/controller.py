"""The motion controller, which begins, follows and ends motions."""

from __future__ import annotations

import secrets
import time
from collections.abc import Callable
from dataclasses import dataclass

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
from beatrix_zenoh.node import replies
from beatrix_zenoh.node.access import Access, Action
from beatrix_zenoh.node.callers import Caller
from beatrix_zenoh.node.events import Diagnostics
from beatrix_zenoh.node.planner import Goal, Planner
from beatrix_zenoh.node.readiness import ready_telemetry

NUMBERS = 65535
"""The highest number of a motion."""
LATE_S = 2.0
"""Time (s) after the planned end at which a motion without an outcome counts as not carried out."""
CLOSE_S = 0.8
"""Longest time (s) for which a closing node waits for the arms to rest."""

Ended = Callable[[int, Reason, str, float], None]
"""Callback at the end of a motion: its number, reason, sentence, and time taken (s)."""


@dataclass(frozen=True)
class Running:
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
    """Controls the motions of one robot; all methods except `arms` and `overdue` run on the controller's thread."""

    def __init__(self, board: Board, planner: Planner, access: Access, diagnostics: Diagnostics) -> None:
        self._board, self._planner = board, planner
        self._access, self._diagnostics = access, diagnostics
        self._running: Running | None = None
        self._number = secrets.randbelow(NUMBERS)  # random, to differ from that of an earlier node
        self._stop_cause = replies.StopCause.STOP
        self._lost = True
        self.last_goal: Goal | None = None
        """Goal of the last motion of a query, from which relative motions count (see `Planner.base`); None after an old
        program has moved the arms, or home was set."""
        self.text_moves = False
        """Whether a motion of the text port is running or about to begin."""
        self.follows = False
        """Whether the arms of this simulation move because it follows the hardware; `FollowHandler` sets it."""

    def arms(self) -> Arms:
        """Return the firmware's set points (rad); zeros before the first telemetry."""
        telemetry = self._board.telemetry
        return (0.0, 0.0, 0.0) if telemetry is None else self._planner.gear.to_rad(telemetry.position)

    def base(self) -> Arms:
        """Return the arm angles (rad) that relative motions count from; zeros before the first telemetry."""
        telemetry = self._board.telemetry
        return (0.0, 0.0, 0.0) if telemetry is None else self._planner.base(telemetry, self.last_goal)

    @property
    def running(self) -> Running | None:
        """The running motion of a query; None if there is none."""
        return self._running

    @property
    def driven(self) -> bool:
        """Whether this node moves the arms: a motion of a query or the text port, or because it follows the hardware."""
        return self._running is not None or self.text_moves or self.follows

    @property
    def moving(self) -> bool:
        """Whether the board reports that the arms move."""
        return self._board.connected and bool(self._board.state & BoardState.MOVING)

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
        resting = not self.moving and self._running is None
        self._access.authorize(Action.MOVE, caller, now_s, resting=resting, lease=query.lease)
        goal = self._planner.goal(query, ready_telemetry(self._board), self.last_goal)
        self._access.take(caller)
        try:
            number, boot = self.send(goal.frame)
        except BeatrixError:
            self._access.undo_take()
            raise
        replaced, self.last_goal = self._running, goal
        self._running = Running(number, caller, goal, boot, now_s, now_s + goal.duration + LATE_S, ended)
        self._stop_cause = replies.StopCause.STOP
        accepted(number, goal)
        self._board.wake()
        if replaced is not None:
            text = f"A newer motion ({number}, of {caller.seat}) replaced this one."
            replaced.ended(replaced.number, Reason.REPLACED, text, now_s - replaced.began_s)

    def send(self, frame: Callable[[int], Move | MoveStraight]) -> tuple[int, int]:
        """Send a motion to the board; `frame` returns it by its number. Return this number and the board's boot number.

        Raises:
            BeatrixError: the firmware refused the motion, and the last one continues; or the board did not answer, and
                this node has sent STOP.
        """
        telemetry = self._board.telemetry
        # Use a new number even after a failure: a board that received the failed motion ignores a repeated number.
        self._number = next_number(self._number, 0 if telemetry is None else telemetry.motion)
        try:
            self._board.move(frame(self._number))
        except NoAnswer:
            # The client gets a refusal, but the board may have received the motion: stop it.
            self.last_goal = None
            self.stop(replies.StopCause.STOP)
            raise
        return self._number, 0 if telemetry is None else telemetry.boot

    def stop(self, cause: replies.StopCause) -> None:
        """Send STOP for this cause; if that fails, only warn: a board without heartbeats stops the arms by itself."""
        self._stop_cause = cause
        try:
            self._board.request(FrameType.STOP)
        except BeatrixError as error:
            self._diagnostics.warn(error.message, error.reason)

    def client_lost(self) -> None:
        """Stop the running motion and end its lease, because its client or the router was lost."""
        if self.driven:
            self.stop(replies.StopCause.CLIENT_LOST)
            self._access.release(time.monotonic())

    def overdue(self) -> bool:
        """Return whether the running motion should have ended by now; any thread may call it."""
        running = self._running
        return running is not None and time.monotonic() > running.overdue_s

    def observe(self) -> None:
        """Handle a change of the board: a restart, the latch, an unknown motion, the end of the running motion."""
        telemetry, lost = self._board.telemetry, not self._board.connected
        if telemetry is None:
            return
        self._diagnostics.follow_boot(
            telemetry.boot, calibrated=bool(telemetry.state & BoardState.CALIBRATED)
        )
        if telemetry.state & BoardState.EMERGENCY and not lost:
            self._access.latch(time.monotonic())
        running = self._running
        known = running is not None and telemetry.motion == running.number
        if self._lost and not lost and self.moving and not known:
            self.stop(self._stop_cause)  # the node has reported to the client that this motion has ended
        self._lost = lost
        if running is not None:
            self._observe_running(running, telemetry, lost=lost)

    def _observe_running(self, running: Running, telemetry: Telemetry, *, lost: bool) -> None:
        if lost or telemetry.boot != running.boot:
            text = replies.board_lost(reset=self._board.link.reset or not lost)
            self._end(running, Reason.BOARD_LOST, text)
        elif telemetry.state & BoardState.MOVING:
            return
        elif telemetry.motion == self._number != running.number:
            self._end(running, Reason.BOARD_LOST, replies.SUPERSEDED)
        elif telemetry.motion == running.number and telemetry.outcome != BoardOutcome.NONE:
            end = replies.motion_end(
                telemetry.outcome, self._stop_cause, self.arms(), self._access.last_stop.seat
            )
            self._end(running, *end)
        elif self.overdue():
            self._end(running, Reason.BOARD_LOST, replies.NOT_CARRIED_OUT)

    def _end(self, running: Running, reason: Reason, text: str) -> None:
        now_s = time.monotonic()
        self._running = None
        self._access.rested(now_s)
        running.ended(running.number, reason, text, now_s - running.began_s)

    def close(self) -> None:
        """Stop the arms, wait until they rest, and end the running motion."""
        if self.driven:
            self.stop(replies.StopCause.SHUTDOWN)
            self._board.wait_for(lambda telemetry: not telemetry.state & BoardState.MOVING, CLOSE_S)
            self.observe()
        if self._running is not None:
            self._end(self._running, Reason.SHUTDOWN, "The node is closing.")


def next_number(last: int, on_board: int) -> int:
    """Return a motion number other than the last one and the board's, which an earlier node may have chosen."""
    number = last % NUMBERS + 1
    return number % NUMBERS + 1 if number == on_board else number
