"""Command queries: ENABLE, CALIBRATE, HOME, RESET. STOP and EMERGENCY_STOP go to the stop handler.

Each command requests a change from the board and waits until the telemetry shows it.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from functools import partial
from typing import Final

from msgspec.structs import replace

from beatrix_zenoh.board.board import Board
from beatrix_zenoh.bus import Incoming, Sessions, query_forms
from beatrix_zenoh.contract import names, refusals
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import (
    Command,
    CommandQuery,
    Detail,
    EventKind,
    MotionQuery,
    Reason,
    Vector3,
)
from beatrix_zenoh.contract._generated.serial import BoardState, FrameType, Telemetry
from beatrix_zenoh.contract.errors import BeatrixError, NoAnswer, Refused
from beatrix_zenoh.motion.gear import Arms
from beatrix_zenoh.node.access import Operation
from beatrix_zenoh.node.controller import MotionController
from beatrix_zenoh.node.interfaces import Component, HardwareInterface, StatusFields
from beatrix_zenoh.node.planner import degrees
from beatrix_zenoh.node.requests import RequestHandle, Requests, check_own_key, command_refusal, command_reply

TELEMETRY_S = 1.0
"""Longest wait until telemetry shows an acknowledged change; usually 10 ms, longer on a busy computer."""
HOME_SHIFT_MAX = math.radians(15.0)
"""Largest angle (rad) by which CALIBRATE may shift a known home, and with it the limits that protect the cables."""


def switch_motors(board: Board, *, on: bool) -> str:
    """Switch the motors on or off and return the new state as a sentence.

    Raises:
        Refused, NoAnswer: as `Board.request` and `wait_until_shown`.
    """
    board.enable(on=on)
    wait_until_shown(board, lambda telemetry: bool(telemetry.state & BoardState.ENABLED) == on)
    if not on:
        return "The motors are off, and home is no longer known."
    if board.state & BoardState.CALIBRATED:
        return "The motors are on, and home is known."
    return "The motors are on. If the head is upright, calibrate; otherwise disable and set it upright first."


def calibrate(board: Board, hardware: HardwareInterface, arms: Arms) -> str:
    """Declare the present position home and return the new state as a sentence; `arms`: angles from the old home (rad).

    Raises:
        Refused, NoAnswer: as `Board.request` and `wait_until_shown`; NOT_AT_REST, NOT_ENABLED, HOME_KNOWN.
    """
    board.check_connected()
    state = board.state
    if state & BoardState.MOVING:
        raise Refused(Reason.NOT_AT_REST)
    if not state & BoardState.ENABLED:
        raise Refused(Reason.NOT_ENABLED)
    if state & BoardState.CALIBRATED and max(map(abs, arms)) > HOME_SHIFT_MAX:
        raise refusals.home_known(arms, HOME_SHIFT_MAX)
    hardware.straighten()
    board.request(FrameType.CALIBRATE)
    # If home was known before, CALIBRATED is already set, and only the position 0 shows the change.
    wait_until_shown(
        board, lambda telemetry: bool(telemetry.state & BoardState.CALIBRATED) and not any(telemetry.position)
    )
    if state & BoardState.CALIBRATED and any(arms):
        return (
            f"The present position is home now. Home was known already, and the arms were at {degrees(arms)} from it. "
            "Limits count from home: if this was a mistake, disable, set the head upright, enable, calibrate."
        )
    return "The present position is home now."


def reset(board: Board) -> str:
    """Clear the emergency latch of the board and return the new state as a sentence.

    Raises:
        Refused, NoAnswer: as `Board.request`; EMERGENCY, the telemetry still shows the latch after TELEMETRY_S.
    """
    board.check_connected()
    if not board.state & BoardState.EMERGENCY:
        return "EMERGENCY_STOP is not latched."
    board.request(FrameType.RESET)
    # Not `wait_until_shown`, which fails under the latch: telemetry from before RESET may still arrive and show it.
    if not board.wait_for(lambda telemetry: not telemetry.state & BoardState.EMERGENCY, TELEMETRY_S):
        raise refusals.emergency_latched()
    return "EMERGENCY_STOP is reset, and the motors are off. Set the head upright, enable, calibrate."


def wait_until_shown(board: Board, holds: Callable[[Telemetry], bool]) -> None:
    """Wait until later telemetry shows an acknowledged change (`holds`), so that the next request sees the new state.

    Raises:
        NoAnswer: BOARD_LOST, the telemetry does not show the change.
        Refused: EMERGENCY, EMERGENCY_STOP was pressed meanwhile.
    """
    before = board.telemetry
    if not board.wait_for(
        lambda new: new is not before and (holds(new) or bool(new.state & BoardState.EMERGENCY)), TELEMETRY_S
    ):
        raise NoAnswer(
            Reason.BOARD_LOST,
            "The board acknowledged the request, but its telemetry does not show the change. Try again.",
        )
    newest = board.telemetry
    if newest is not None and not holds(newest) and newest.state & BoardState.EMERGENCY:
        raise refusals.emergency_latched()


STOPS: Final = (Command.STOP, Command.EMERGENCY_STOP)
HOME: Final = MotionQuery(position=Vector3(0.0, 0.0, 0.0))


class CommandHandler(Component):
    """Answers command queries; the controller's thread carries out all but STOP and EMERGENCY_STOP."""

    def __init__(
        self,
        requests: Requests,
        controller: MotionController,
        hardware: HardwareInterface,
        press: Callable[[Command, RequestHandle, Incoming], None],
        keep: Callable[[], None],
    ) -> None:
        """`press` handles STOPS; `keep` keeps the decisions of the teacher, of which a RESET may end one."""
        self._requests, self._controller, self._hardware = requests, controller, hardware
        self._press, self._keep = press, keep
        self._access, self._board = controller.access, controller.board
        self._key = keys.command(requests.name, requests.side, "*")

    def start(self, sessions: Sessions) -> None:
        sessions.serve(self._key, self._query)

    def contribute(self, status: StatusFields) -> None:
        status.values["calibrations"] = self._controller.calibrations

    # -- on Zenoh's thread ----------------------------------------------------------------------------

    def _query(self, incoming: Incoming) -> None:
        received_s = time.monotonic()
        handle = self._requests.handle(incoming, self._key, "", EventKind.COMMAND)
        try:
            query = query_forms.read(incoming.raw, CommandQuery)
            if query.command in STOPS:  # before any check: STOP is open to every seat and allows wildcards
                command = Command(query.command)
                handle = self._requests.handle(incoming, self._key, command.name, EventKind.STOP)
                self._press(command, replace(handle, source=query.source), incoming)
                return
            names.check_seat(handle.caller.seat)
            check_own_key(incoming.key, self._key)
            command = command_of(query.command)
        except Refused as error:
            self._decline(handle, error)
            return
        handle = replace(handle, action=name_of(command, query), source=query.source)
        self._requests.queue.post(
            lambda: self._run(command, query, handle, received_s), partial(self._decline, handle)
        )

    def _decline(self, handle: RequestHandle, error: BeatrixError) -> None:
        handle.end(command_refusal(error, self._controller.arms()))

    # -- on the controller's thread -------------------------------------------------------------------

    def _run(self, command: Command, query: CommandQuery, handle: RequestHandle, received_s: float) -> None:
        try:
            if command is Command.HOME:
                self._home(handle)
                return
            text = self._carry_out(command, query, handle, received_s)
        except BeatrixError as error:
            self._decline(handle, error)
            return
        handle.end(command_reply(Reason.OK, text, self._controller.arms()))

    def _carry_out(
        self, command: Command, query: CommandQuery, handle: RequestHandle, received_s: float
    ) -> str:
        """Carry out ENABLE, CALIBRATE or RESET and return the new state as a sentence; raises BeatrixError."""
        access, now_s = self._access, time.monotonic()
        if command is Command.ENABLE:
            access.authorize(Operation.ENABLE if query.value else Operation.DISABLE, handle.caller, now_s)
            return switch_motors(self._board, on=query.value)
        if command is Command.CALIBRATE:
            access.authorize(Operation.CALIBRATE, handle.caller, now_s)
            self._controller.last_goal = None
            text = calibrate(self._board, self._hardware, self._controller.arms())
            self._controller.calibrations += 1
            return text
        access.authorize(Operation.RESET, handle.caller, now_s)
        return self._reset(received_s)

    def _reset(self, received_s: float) -> str:
        access = self._access
        latched, teacher = access.latched, access.teacher.latch
        access.reset(received_s)
        try:
            text = reset(self._board)
        except BeatrixError:
            if latched:
                access.latch(time.monotonic(), teacher=teacher)
            raise
        self._keep()
        return text

    def _home(self, handle: RequestHandle) -> None:
        def ended(_number: int, reason: Reason, text: str, _took_s: float) -> None:
            handle.end(command_reply(reason, text, self._controller.arms()))

        self._controller.begin(HOME, handle.caller, ended)


def command_of(number: int) -> Command:
    """Return the command with this number; raises Refused (UNKNOWN_COMMAND)."""
    try:
        return Command(number)
    except ValueError:
        raise Refused(
            Reason.UNKNOWN_COMMAND, detail=Detail(value=float(number), known=refusals.COMMANDS)
        ) from None


def name_of(command: Command, query: CommandQuery) -> str:
    """Return the name of a command in events: `DISABLE` for ENABLE with value false."""
    return "DISABLE" if command is Command.ENABLE and not query.value else command.name
