"""The board of a node: its callbacks and status fields, and the observers of changes of the board."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from beatrix_zenoh.board.board import Board
from beatrix_zenoh.board.state import NO_TELEMETRY
from beatrix_zenoh.bus import Sessions
from beatrix_zenoh.contract._generated.messages import Fault
from beatrix_zenoh.contract._generated.serial import BoardState, Telemetry
from beatrix_zenoh.node.access import Access
from beatrix_zenoh.node.interfaces import Component, HardwareInterface, StatusFields
from beatrix_zenoh.node.requests import ControllerQueue
from beatrix_zenoh.schedule import Schedule
from beatrix_zenoh.threads import Owner

BOARD_READY_S = 1.7
"""Time (s) within which a board that was reset by opening its port sends telemetry."""


class Observer(NamedTuple):
    """Callbacks for changes of the board's state, and their priority; `observe` runs on the controller's thread."""

    observe: Callable[[], None]
    overdue: Callable[[], bool]
    """whether to call `observe` although nothing has changed; called on the board's thread"""
    urgent: bool = True
    """whether to call `observe` at each change of the board's state, before all waiting requests; otherwise it is
    called after them, and only if `overdue` returns True or the board was connected or lost"""


class BoardWatch(Component):
    """Owns the board. The callbacks of the board run on its thread and only queue calls for the controller's thread."""

    def __init__(
        self,
        hardware: HardwareInterface,
        access: Access,
        queue: ControllerQueue,
        owner: Owner,
        schedule: Schedule,
    ) -> None:
        """Store the arguments; `schedule` gives a virtual board its turns, a real board gets a thread of its own."""
        self._owner, self._schedule = owner, schedule
        self._hardware, self._access, self._queue = hardware, access, queue
        self._observers: list[Observer] = []
        self._last_state: tuple[int, ...] = ()
        self.board = Board(hardware.open_port, self._telemetry, self._link)

    def observe(self, observer: Observer) -> None:
        """Add an observer; call this before `start`."""
        self._observers.append(observer)

    def start(self, sessions: Sessions) -> None:  # noqa: ARG002
        port = self._hardware.timed_port()
        if port is None:
            self.board.start()
        else:
            self.board.start_turns(self._schedule, self._owner, port)
        self.board.wait_for(lambda _: True, BOARD_READY_S)

    def contribute(self, status: StatusFields) -> None:
        telemetry, board = self.board.telemetry or NO_TELEMETRY, self.board.status()
        state = telemetry.state if board.connected else 0
        status.values |= {
            "enabled": bool(state & BoardState.ENABLED),
            "calibrated": bool(state & BoardState.CALIBRATED),
            "moving": bool(state & BoardState.MOVING),
            "motion": telemetry.motion,
            "fault": self._fault(telemetry),
            "board": board,
        }
        if trouble := self.board.trouble:
            status.warnings.insert(0, trouble)

    def _fault(self, telemetry: Telemetry) -> Fault:
        if self.board.contract_differs:
            return Fault.CONTRACT_MISMATCH
        if not self.board.connected:
            return Fault.BOARD_LOST
        if telemetry.state & BoardState.EMERGENCY or self._access.latched:
            return Fault.EMERGENCY
        return self._hardware.fault()

    # -- on the board's thread ---------------------------------------------------------------------

    def _telemetry(self, telemetry: Telemetry) -> None:
        state = (telemetry.state, telemetry.outcome, telemetry.motion, telemetry.boot)
        changed, self._last_state = state != self._last_state, state
        for observer in self._observers:
            if observer.overdue() or (changed and observer.urgent):
                self._enqueue(observer)

    def _link(self) -> None:
        for observer in self._observers:
            self._enqueue(observer)

    def _enqueue(self, observer: Observer) -> None:
        (self._queue.post_urgent if observer.urgent else self._queue.post_event)(observer.observe)
