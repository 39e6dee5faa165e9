"""How programs of 2023 drive the robot: the access rules apply to their lines, and events record the outcomes."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Final

from beatrix_zenoh.contract._generated.messages import Detail, EventKind, Phase, Reason, Source
from beatrix_zenoh.contract.errors import BeatrixError, NoAnswer, Refused
from beatrix_zenoh.contract.names import OLD_PROGRAMS
from beatrix_zenoh.node.access import TEXT_SESSION, Operation
from beatrix_zenoh.node.callers import Caller
from beatrix_zenoh.node.controller import MotionController
from beatrix_zenoh.node.events import NodeEvents, new_event
from beatrix_zenoh.node.interfaces import HardwareInterface
from beatrix_zenoh.node.planner import vector

CALLER: Final = Caller(OLD_PROGRAMS, TEXT_SESSION)


KINDS: Final = {Operation.MOVE: EventKind.MOTION, Operation.STOP: EventKind.STOP}
"""Kinds of the events of these operations; events of others have the kind COMMAND."""


class Driving:
    """The programs of 2023 as a seat; used on the controller's thread, except `stop_pressed`.

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

    def program_began(self) -> None:
        """End motions and pause of a stopped program: another program has opened the port."""
        self._access.old_program_began()
        self.moves_ended()

    def authorize(self, operation: Operation) -> None:
        """Check that the program may act now; with MOVE it becomes the holder, with CALIBRATE the robot gets ready.

        Raises:
            Refused: as `Access.authorize`; BUSY while a motion of another seat is running.
            NoAnswer: BOARD_LOST; NO_ROUTER for a motion, because no client could stop it.
        """
        access, controller = self._access, self._controller
        access.authorize(operation, CALLER, time.monotonic(), resting=not controller.moving)
        self._board.check_connected()
        if operation is Operation.CALIBRATE:
            self._hardware.straighten()
            controller.last_goal = None
            controller.calibrations += 1
        if operation is not Operation.MOVE:
            return
        if not self._has_router():
            raise NoAnswer(Reason.NO_ROUTER, "The router is lost, so no client could stop a motion.")
        if controller.running is not None:
            raise Refused(Reason.BUSY, detail=Detail(holder=controller.running.caller.seat))
        access.take(CALLER)
        controller.last_goal = None
        controller.text_moves = True

    def moves_ended(self) -> None:
        """Record that no motion of the program is running or waiting, so that its lease expires."""
        if self._controller.text_moves:
            self._controller.text_moves = False
            self._access.rested(time.monotonic())

    def stop_pressed(self) -> None:
        """Block new motions, because the program has sent @STOPALL; any thread may call it."""
        self._access.stop_pressed(CALLER, time.monotonic())

    def stop_sent(self) -> None:
        """Carry out step 3 of STOP (see `stop`) after @STOPALL was sent to the firmware."""
        self._controller.stop_sent()

    def warn(self, text: str) -> None:
        """Show a sentence in the status for some seconds."""
        self._controller.diagnostics.warn(f"old program: {text}")

    def record(
        self,
        line: bytes,
        operation: Operation | None,
        error: BeatrixError | None = None,
        *,
        since_s: float | None = None,
        silent: bool = False,
    ) -> None:
        """Record the outcome of a line as an event, and warn of an error.

        Args:
            line: the text of the line.
            operation: what it does; None: nothing, and it is not recorded.
            error: why it was not carried out.
            since_s: time at which it was sent and now has ended; None: it begins now, or was refused before.
            silent: do not warn.
        """
        why, text = error.message if error else "", line.decode("ascii", "replace")
        if why and not silent:
            self.warn(why)
        if operation is None:
            return
        moved = operation is Operation.MOVE and since_s is not None
        phase = Phase.DONE if moved else Phase.ACCEPTED if operation is Operation.MOVE else None
        event = new_event(
            kind=KINDS.get(operation, EventKind.COMMAND),
            action=text.partition(" ")[0],
            seat=CALLER.seat,
            session=CALLER.session,
            phase=phase,
            reason=error.reason if error else Reason.OK,
            message=f"{text}: {why}" if why else text,
            duration=time.monotonic() - since_s if moved and since_s is not None else 0.0,
            detail=error.detail if error else None,
            source=None if moved else Source.OLD_PROGRAM,
            position=vector(self._controller.arms()) if moved else None,
        )
        self._events.add(event)
