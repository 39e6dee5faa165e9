"""Send STOP to the board before all queued requests, and reply when the arms rest.

1. Zenoh's thread, or that of the puts (`press`): `Access` lets no motion begin from now on; the stop thread wakes.
2. The stop thread: send the board one request for all waiting presses, EMERGENCY_STOP before STOP. A STOP that follows
   another one, without a motion in between, needs no request of its own.
3. The controller's thread, before all waiting requests (`stop_sent`): stop a motion that has overtaken STOP.
4. The controller's thread, when the board reports that the arms rest (`Rest`): reply.

Two more files belong to the way of a STOP: `access` refuses motions, and `controller` ends those that run.
"""

from __future__ import annotations

import threading
import time
from functools import partial
from typing import Final

from msgspec.structs import replace

from beatrix_zenoh import threads
from beatrix_zenoh.board.board import Board
from beatrix_zenoh.bus import Incoming, Received, Sessions
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import Command, CommandReply, EventKind, Reason
from beatrix_zenoh.contract._generated.serial import BoardState, FrameType
from beatrix_zenoh.contract.errors import BeatrixError, NoAnswer, Refused
from beatrix_zenoh.contract.names import TEACHER
from beatrix_zenoh.motion.gear import Arms
from beatrix_zenoh.node.board_watch import BoardWatch, Observer
from beatrix_zenoh.node.callers import Caller
from beatrix_zenoh.node.controller import MotionController
from beatrix_zenoh.node.events import NodeEvents
from beatrix_zenoh.node.interfaces import Component, StatusFields
from beatrix_zenoh.node.planner import degrees
from beatrix_zenoh.node.requests import RequestHandle, Requests, command_refusal, command_reply, seat_of

FRAMES: Final = {
    Command.EMERGENCY_STOP: FrameType.EMERGENCY_STOP,
    Command.STOP: FrameType.STOP,
}
"""Frame of each command, in the order in which waiting commands are sent."""
REST_S: Final = 2.0
"""Time (s) after which moving arms are a fault. Arms at full speed stop much sooner, and clients wait longer."""
RECORDED: Final = 64
"""Number of presses, and of keys, that are remembered."""
SAME_PUT_S: Final = 0.002
"""Puts of STOP with one key within this time (s), without a motion in between, count as one. Each costs Python 10 times
as much as a skipped one, and other puts wait behind a flood."""
REPEAT_S: Final = 0.02
"""In a flood of STOPs the board gets a STOP at least this often (s), and at once if a motion has begun since the last."""
LATCHED_S: Final = 0.3
"""Time (s) within which the telemetry shows the emergency latch."""
STOPPED, AT_REST = "Stopped", "Nothing moves"
STILL_MOVING: Final = NoAnswer(
    Reason.FAULT, "The board has acknowledged STOP and reports that the arms still move."
)


class StopHandler(Component):
    """Carries out STOP and EMERGENCY_STOP for one robot."""

    def __init__(self, requests: Requests, controller: MotionController, board_watch: BoardWatch) -> None:
        self._requests, self._controller = requests, controller
        self._access, self._board = controller.access, controller.board
        self._pressed: dict[Command, list[RequestHandle]] = {}
        self._changed = threading.Condition()
        self._closed = False
        self._unsigned = ""
        """Seat of a STOP whose key has none; empty: unknown."""
        self._sent: tuple[float, int] = float("-inf"), 0
        """Time (s, monotonic) of the last STOP that the board has acknowledged, and `Access.begun` before it."""
        self._puts: dict[str, tuple[float, int]] = {}
        """Time (s, monotonic) of the last put by its key, and `Access.begun` then."""
        self._recorded: dict[tuple[str, bytes], str] = {}
        """Form of the first of each press by seat and number, the newest last: the key of the query; empty: a put."""
        self._thread: threading.Thread | None = None
        self._rest = Rest(self._board, controller)
        board_watch.observe(Observer(self._rest.observe, self._rest.overdue))

    def start(self, sessions: Sessions) -> None:
        name, side = self._requests.name, self._requests.side
        if sessions.control.endpoint.startswith(
            "tls/"
        ):  # the router of a class accepts it from the teacher only
            self._unsigned = TEACHER
        self._thread = threads.start(self._run, "stop")
        # The watchdog checks the first key of a session, and the account of a robot may not query STOP without a seat.
        for key in (keys.stop(name, side, "*"), keys.stop_unsigned(name, side)):
            sessions.serve(key, partial(self._query, key))
            sessions.control.subscribe_newest(
                key, partial(self._put, key), lambda key: self.repeats(key, time.monotonic())
            )

    def contribute(self, status: StatusFields) -> None:
        status.values["stops"] = self._requests.events.stops()

    # -- 1. pressed, on Zenoh's thread or that of the puts ------------------------------------------

    def _query(self, served: str, incoming: Incoming) -> None:
        if is_stop(incoming.key):
            handle = self._requests.handle(incoming, served, Command.STOP.name, EventKind.STOP)
            caller = Caller(handle.caller.seat or self._unsigned, handle.caller.session)
            self.press(Command.STOP, replace(handle, caller=caller), incoming)
        else:
            incoming.finish()

    def repeats(self, key: str, now_s: float) -> bool:
        """Return whether a put of STOP with this key only repeats the last one."""
        begun = self._access.begun
        last_s, then = self._puts.get(key, (float("-inf"), 0))
        if now_s - last_s < SAME_PUT_S and begun == then:
            return True
        if len(self._puts) >= RECORDED:
            self._puts.clear()
        self._puts[key] = now_s, begun
        return False

    def _put(self, served: str, received: Received) -> None:
        """Handle a put of STOP. Our clients send it before the query, because another queryable may take it.

        One that comes after the query of the same press, which has done its work, could end the caller's next motion.
        """
        # The seat is that of the key, which the router of a class checks; any client can forge a session id.
        caller = Caller(seat_of(received.key, served) or self._unsigned, received.sender)
        press = received.attachment or b""
        if is_stop(received.key) and not self._recorded.get((caller.seat, press)):
            events = self._events(caller.seat, "", press)
            self.press(Command.STOP, RequestHandle(caller, Command.STOP.name, events, kind=EventKind.STOP))

    def _events(self, seat: str, form: str, press: bytes) -> NodeEvents | None:
        """Return the event log for a press of STOP or EMERGENCY_STOP; None if another form of it was recorded before.

        `press`: its number; empty: it has none, and each of its forms is recorded.
        """
        if press:
            with self._changed:
                if self._recorded.setdefault((seat, press), form) != form:
                    return None
                if len(self._recorded) > RECORDED:
                    del self._recorded[next(iter(self._recorded))]
        return self._requests.events

    def press(self, command: Command, handle: RequestHandle, incoming: Incoming | None = None) -> None:
        """Handle a requested STOP or EMERGENCY_STOP.

        Once closed, decline it and send nothing, because the controller stops the arms. Decline that of a muted seat
        that moves nothing. All queries (`incoming`) of one press are carried out, and one is recorded; their keys differ.
        """
        if incoming is not None:
            events = self._events(handle.caller.seat, incoming.key, incoming.attachment)
            handle = replace(handle, events=events)
        emergency = command is Command.EMERGENCY_STOP
        try:
            self._access.stop_pressed(handle.caller, time.monotonic(), emergency=emergency)
        except Refused as error:
            handle.end(command_refusal(error, self._controller.arms()))
            return
        with self._changed:
            closed = self._closed
            if not closed and command in self._pressed:
                self._pressed[command].append(handle)
            elif not closed:
                self._pressed[command] = [handle]
                self._changed.notify()
        if closed:
            handle.end(command_refusal(Refused(Reason.SHUTDOWN), self._controller.arms()))

    # -- 2. sent, on the stop thread ----------------------------------------------------------------

    def _run(self) -> None:
        while True:
            with self._changed:
                self._changed.wait_for(lambda: self._pressed or self._closed)
                if not self._pressed:
                    return
                command = next(command for command in FRAMES if command in self._pressed)
                handles = self._pressed.pop(command)
            moving = self._rest.moving
            repeated = command is Command.STOP and self._is_repeated()
            error = None if repeated else self._send(command)
            self._hand_over(command, handles, error, moving=moving)

    def _is_repeated(self) -> bool:
        """Return whether the board has just acknowledged a STOP, and no motion has begun since it was sent."""
        sent_s, begun = self._sent
        return time.monotonic() - sent_s < REPEAT_S and self._access.begun == begun

    def _send(self, command: Command) -> BeatrixError | None:
        before = time.monotonic(), self._access.begun
        self._sent = float("-inf"), 0
        try:
            self._board.request(FRAMES[command])
        except BeatrixError as error:
            return error
        if command is Command.STOP:
            self._sent = before
        return None

    def _hand_over(
        self, command: Command, handles: list[RequestHandle], error: BeatrixError | None, *, moving: bool
    ) -> None:
        def decline(closing: BeatrixError) -> None:
            refusal = closing if error is None else not_stopped(error)
            end_all(handles, command_refusal(refusal, self._controller.arms()))

        self._requests.queue.post_urgent(
            lambda: self.stop_sent(command, handles, error, moving=moving), decline
        )

    # -- 3. ended, on the controller's thread -----------------------------------------------------

    def stop_sent(
        self, command: Command, handles: list[RequestHandle], error: BeatrixError | None, *, moving: bool
    ) -> None:
        """Carry out step 3 after the board has acknowledged STOP, or has refused or not answered it (`error`).

        `moving`: whether a motion ran when STOP was sent.
        """
        self._controller.stop_sent(acknowledged=error is None)
        if error is None and command is Command.EMERGENCY_STOP:
            error = self._check_latch()
        if error is None:
            self._rest.wait(handles, moved=moving)
        else:
            end_all(handles, command_refusal(not_stopped(error), self._controller.arms()))

    def _check_latch(self) -> BeatrixError | None:
        board = self._board
        if not board.connected or board.wait_for(
            lambda telemetry: bool(telemetry.state & BoardState.EMERGENCY), LATCHED_S
        ):
            return None
        return NoAnswer(
            Reason.BOARD_LOST,
            "The board has acknowledged EMERGENCY_STOP, but does not show the latch. Press EMERGENCY_STOP again.",
        )

    def close(self) -> None:
        """Send the waiting STOPs, end the thread, and reply to the waiting clients."""
        with self._changed:
            self._closed = True
            self._changed.notify()
        if self._thread is not None:
            self._thread.join(timeout=2.0)
        self._rest.close()


class Rest:
    """Step 4, on the controller's thread: the clients that wait for the arms to rest, and their replies."""

    def __init__(self, board: Board, controller: MotionController) -> None:
        self._board, self._controller = board, controller
        self._waiting: list[RequestHandle] = []
        self._until_s = float("inf")
        self._how = AT_REST
        """BoardOutcome of the last press."""

    @property
    def moving(self) -> bool:
        """Whether the arms move, or are about to; any thread may read it."""
        # The telemetry may not show yet that a motion has begun: check the controller too.
        return self._controller.moving or self._controller.running is not None

    def wait(self, handles: list[RequestHandle], *, moved: bool) -> None:
        """Reply to these clients when the arms rest. `moved`: whether STOP met a motion, which may have ended already."""
        if not self.moving:
            # A query without events belongs to a press whose put was just handled: it gets the outcome of the put.
            same_press = all(handle.events is None for handle in handles)
            self._end(handles, STOPPED if moved else self._how if same_press else AT_REST)
            return
        if not self._waiting:
            self._until_s = time.monotonic() + REST_S
        self._waiting += handles

    def overdue(self) -> bool:
        """Return whether the arms should rest by now; any thread may call it."""
        return bool(self._waiting) and time.monotonic() > self._until_s

    def observe(self) -> None:
        """Reply to the waiting clients if the arms rest, or should rest by now."""
        if self._waiting and (not self.moving or self.overdue()):
            handles, self._waiting = self._waiting, []
            self._end(handles, STOPPED)

    def _end(self, handles: list[RequestHandle], how: str) -> None:
        self._how = how
        arms = self._controller.arms()
        if how == STOPPED and not self._board.connected:
            lost = lost_while_stopping(reset=self._board.reset)
            end_all(handles, command_refusal(lost, arms))
        elif self.moving:
            end_all(handles, command_refusal(not_stopped(STILL_MOVING), arms))
        else:
            text = at_rest(self._board, how, arms)
            end_all(handles, command_reply(Reason.OK, text, arms))

    def close(self) -> None:
        """Reply to the waiting clients that the node is closing."""
        end_all(self._waiting, command_refusal(Refused(Reason.SHUTDOWN), self._controller.arms()))


def end_all(handles: list[RequestHandle], reply: CommandReply) -> None:
    """Send the same last reply to all requests."""
    for handle in handles:
        handle.end(reply)


def is_stop(key: str) -> bool:
    """Return whether a key requests STOP, with or without a seat, possibly of several robots.

    A query on `beatrix/**` does not.
    """
    *_, before, last = key.split("/")
    return last == "stop" or (before == "stop" and last != "**")


def not_stopped(error: BeatrixError) -> BeatrixError:
    """Return the error about a STOP that did not stop the arms, with advice."""
    return BeatrixError(
        error.reason,
        f"NOT stopped. {error.message} Without frames of its node a board stops the arms after half a second; if they "
        "still move, switch the motor power off.",
    )


def lost_while_stopping(*, reset: bool) -> BeatrixError:
    """Return the error about a STOP whose effect is unknown: the board was lost while the arms moved."""
    if reset:
        return NoAnswer(
            Reason.BOARD_LOST, "The board was reset meanwhile: its motors are off, and home is not known."
        )
    return not_stopped(NoAnswer(Reason.BOARD_LOST, "The board was lost while the arms moved."))


def at_rest(board: Board, how: str, arms: Arms) -> str:
    """Return the state after an acknowledged STOP as a sentence; `how`: its first words at rest; arms in rad."""
    if not board.connected:
        return f"The board has acknowledged STOP, but its state is unknown. {board.trouble}"
    if board.state & BoardState.EMERGENCY:
        return "The motors are off, EMERGENCY_STOP is latched until reset, and home is no longer known."
    return f"{how}; the arms rest at {degrees(arms)}."
