"""The port of programs of 2023. The access rules also apply to their lines, which the firmware carries out."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Callable
from typing import Final

from beatrix_zenoh.bus import Sessions
from beatrix_zenoh.contract._generated.messages import Detail, EventKind, Phase, Reason, Source
from beatrix_zenoh.contract._generated.serial import BoardState
from beatrix_zenoh.contract.errors import NoAnswer, Refused
from beatrix_zenoh.contract.names import OLD_PROGRAMS
from beatrix_zenoh.legacy import Effect, LineCause, Terminal, TextPort
from beatrix_zenoh.node.access import TEXT_SESSION, Operation
from beatrix_zenoh.node.board_watch import BoardWatch, Observer
from beatrix_zenoh.node.callers import Caller
from beatrix_zenoh.node.controller import MotionController
from beatrix_zenoh.node.events import NodeEvents
from beatrix_zenoh.node.interfaces import Component, HardwareInterface
from beatrix_zenoh.node.planner import vector
from beatrix_zenoh.node.requests import Requests

CALLER: Final = Caller(OLD_PROGRAMS, TEXT_SESSION)
ACTIONS: Final = {
    Effect.MOVE: Operation.MOVE,
    Effect.ENABLE: Operation.ENABLE,
    Effect.DISABLE: Operation.DISABLE,
    Effect.CALIBRATE: Operation.CALIBRATE,
}
KINDS: Final = {Effect.MOVE: EventKind.MOTION, Effect.STOP: EventKind.STOP}
"""Kinds of the events of these effects; events of other effects have the kind COMMAND."""


class TextDriving:
    """Implements `legacy.NodeInterface`.

    `has_router` returns whether a router is connected; without a router no STOP arrives.
    """

    def __init__(
        self,
        events: NodeEvents,
        controller: MotionController,
        hardware: HardwareInterface,
        has_router: Callable[[], bool],
    ) -> None:
        self._events, self._controller, self._hardware = events, controller, hardware
        self._access, self._board, self._has_router = controller.access, controller.board, has_router
        self._moved = False
        """Whether the arms have moved since a motion was last authorised."""

    def observe(self) -> None:
        """Handle a change of the board: its arms may have begun to move."""
        self._moved |= self._controller.text_moves and bool(self._board.state & BoardState.MOVING)

    def program_began(self) -> None:
        """End the pause of a stopped program: another program has opened the port."""
        self._access.old_program_began()

    def authorize(self, effect: Effect) -> None:
        """Check that the program may act now; with MOVE it becomes the holder.

        Raises:
            Refused: as `Access.authorize`; BUSY while a motion of another seat is running.
            NoAnswer: BOARD_LOST; NO_ROUTER for a motion, because no client could stop it.
        """
        access, controller = self._access, self._controller
        access.authorize(ACTIONS[effect], CALLER, time.monotonic(), resting=not controller.moving)
        self._board.check_connected()
        if effect is not Effect.MOVE:
            return
        if not self._has_router():
            raise NoAnswer(Reason.NO_ROUTER, "The router is lost, so no client could stop a motion.")
        if controller.running is not None:
            raise Refused(Reason.BUSY, detail=Detail(holder=controller.running.caller.seat))
        access.take(CALLER)
        controller.last_goal = None
        controller.text_moves, self._moved = True, False

    def move_declined(self) -> None:
        """Restart the pause after STOP: the text port refused a motion and did not call `authorize`."""
        with contextlib.suppress(Refused):
            self._access.authorize(Operation.MOVE, CALLER, time.monotonic())

    def move_refused(self) -> bool:
        """Handle a motion that the firmware refused or ended; return whether no arm has moved.

        If none has moved, restore the previous holder.
        """
        if self._controller.text_moves and not self._moved:
            self._controller.text_moves = False
            self._access.undo_take()
        return not self._moved

    def moves_ended(self) -> None:
        """Record that no motion of the program is running or waiting, so that its lease expires."""
        if self._controller.text_moves:
            self._controller.text_moves = False
            self._access.rested(time.monotonic())

    def set_home(self) -> None:
        """Prepare the robot for a @CALNOW that sets home, and count the calibration."""
        self._hardware.straighten()
        self._controller.last_goal = None
        self._controller.calibrations += 1

    def stop_pressed(self) -> None:
        """Block new motions, because the program has sent @STOPALL; any thread may call it."""
        self._access.stop_pressed(Caller(OLD_PROGRAMS, TEXT_SESSION), time.monotonic())

    def stop_sent(self) -> None:
        """Carry out step 3 of STOP (see `stop`) after @STOPALL was sent to the firmware."""
        self._controller.stop_sent()

    def warn(self, text: str) -> None:
        """Show a sentence in the status for some seconds."""
        self._controller.diagnostics.warn(text)

    def record(
        self,
        effect: Effect,
        word: str,
        outcome: LineCause,
        *,
        phase: Phase | None = None,
        detail: Detail | None = None,
        duration_s: float = 0.0,
    ) -> None:
        """Record the outcome of a line that begins with `word` as an event of the seat of old programs."""
        self._events.add(
            KINDS.get(effect, EventKind.COMMAND),
            action=word,
            caller=CALLER,
            phase=phase,
            reason=outcome.reason,
            message=outcome.message,
            duration_s=duration_s,
            detail=detail,
            source=None if phase is Phase.DONE else Source.OLD_PROGRAM,
            position=vector(self._controller.arms()) if phase is Phase.DONE else None,
        )


class LegacyPort(Component):
    """Passes lines between a terminal and the board."""

    def __init__(
        self,
        requests: Requests,
        controller: MotionController,
        board_watch: BoardWatch,
        hardware: HardwareInterface,
        terminal: Terminal,
        has_router: Callable[[], bool],
    ) -> None:
        """`has_router`: as for `TextDriving`."""
        driving = TextDriving(requests.events, controller, hardware, has_router)
        self._port = TextPort(terminal, board_watch.board, driving, requests.queue.post_event)
        lines = self._port.lines
        controller.on_stop.append(lines.refuse_waiting_motions)
        board_watch.observe(Observer(driving.observe, lambda: False))
        board_watch.observe(Observer(lines.observe, lines.overdue, urgent=False))
        board_watch.on_text(self._port.board_sent)

    def start(self, sessions: Sessions) -> None:  # noqa: ARG002
        self._port.start()

    def close(self) -> None:
        """Close the terminal; the controller stops the arms."""
        self._port.close()
