"""Command queries: ENABLE, CALIBRATE, HOME, RESET. STOP and EMERGENCY_STOP go to the stop handler."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace
from typing import Final

from beatrix_zenoh.bus import Incoming, Sessions, query_forms
from beatrix_zenoh.contract import names, refusals
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import (
    Command,
    CommandQuery,
    EventKind,
    MotionQuery,
    Reason,
    Source,
    Vector3,
)
from beatrix_zenoh.contract.errors import BeatrixError, Refused
from beatrix_zenoh.node import lifecycle, replies
from beatrix_zenoh.node.access import Action
from beatrix_zenoh.node.component import Component, StatusFields
from beatrix_zenoh.node.context import Context
from beatrix_zenoh.node.request_handle import RequestHandle, check_own_key, request_handle
from beatrix_zenoh.node.request_queue import Task
from beatrix_zenoh.node.stop import FRAMES, StopHandler

HOME: Final = MotionQuery(position=Vector3(0.0, 0.0, 0.0))


class CommandHandler(Component):
    """Answers command queries; the controller's thread carries out all but STOP and EMERGENCY_STOP."""

    def __init__(self, context: Context, stop: StopHandler, keep: Callable[[], None]) -> None:
        """`keep` keeps the decisions of the teacher, of which a RESET may end one."""
        self._context, self._stop, self._keep = context, stop, keep
        self._board = context.board_watch.board
        self._key = keys.command(context.name, context.side, "*")
        self.calibrations = 0
        """Number of times that a client or an old program has set home."""

    def start(self, sessions: Sessions) -> None:
        sessions.serve(self._key, self._query)

    def contribute(self, status: StatusFields) -> None:
        status.values["calibrations"] = self.calibrations

    # -- on Zenoh's thread ----------------------------------------------------------------------------

    def _query(self, incoming: Incoming) -> None:
        received_s = time.monotonic()
        handle = request_handle(incoming, self._key, "", self._context.events, EventKind.COMMAND)
        try:
            query = query_forms.read(incoming.raw, CommandQuery)
            if query.command in FRAMES:  # before any check: STOP is open to every seat and allows wildcards
                self._press(incoming, Command(query.command), query.source)
                return
            names.check_seat(handle.caller.seat)
            check_own_key(incoming.key, self._key)
            command = command_of(query.command)
        except Refused as error:
            self._decline(handle, error)
            return
        handle = replace(handle, action=name_of(command, query), source=query.source)

        def decline(error: BeatrixError) -> None:
            self._decline(handle, error)

        self._context.queue.post(Task(lambda: self._run(command, query, handle, received_s), decline))

    def _press(self, incoming: Incoming, command: Command, source: Source) -> None:
        handle = request_handle(incoming, self._key, command.name, self._context.events, EventKind.STOP)
        self._stop.press(command, replace(handle, source=source))

    def _decline(self, handle: RequestHandle, error: BeatrixError) -> None:
        handle.end(replies.command_refusal(error, self._context.controller.arms()))

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
        handle.end(replies.command_reply(Reason.OK, text, self._context.controller.arms()))

    def _carry_out(
        self, command: Command, query: CommandQuery, handle: RequestHandle, received_s: float
    ) -> str:
        """Carry out ENABLE, CALIBRATE or RESET and return the new state as a sentence; raises BeatrixError."""
        access, now_s = self._context.access, time.monotonic()
        if command is Command.ENABLE:
            access.authorize(Action.ENABLE if query.value else Action.DISABLE, handle.caller, now_s)
            return lifecycle.switch_motors(self._board, on=query.value)
        if command is Command.CALIBRATE:
            access.authorize(Action.CALIBRATE, handle.caller, now_s)
            self._context.controller.last_goal = None
            text = lifecycle.calibrate(self._board, self._context.hardware, self._context.controller.arms())
            self.calibrations += 1
            return text
        access.authorize(Action.RESET, handle.caller, now_s)
        return self._reset(received_s)

    def _reset(self, received_s: float) -> str:
        access = self._context.access
        latched, teacher = access.latched, access.teacher.latch
        access.reset(received_s)
        try:
            text = lifecycle.reset(self._board)
        except BeatrixError:
            if latched:
                access.latch(time.monotonic(), teacher=teacher)
            raise
        self._keep()
        return text

    def _home(self, handle: RequestHandle) -> None:
        def ended(_number: int, reason: Reason, text: str, _took_s: float) -> None:
            handle.end(replies.command_reply(reason, text, self._context.controller.arms()))

        self._context.controller.begin(HOME, handle.caller, ended)


def command_of(number: int) -> Command:
    """Return the command with this number; raises Refused (UNKNOWN_COMMAND)."""
    try:
        return Command(number)
    except ValueError:
        raise refusals.unknown_command(number) from None


def name_of(command: Command, query: CommandQuery) -> str:
    """Return the name of a command in events: `DISABLE` for ENABLE with value false."""
    return "DISABLE" if command is Command.ENABLE and not query.value else command.name
