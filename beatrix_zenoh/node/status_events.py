"""Events that follow from the status: another holder, a lost or connected board."""

from __future__ import annotations

from beatrix_zenoh.contract._generated.messages import EventKind, Fault, Reason, Status
from beatrix_zenoh.node.events import EventLog
from beatrix_zenoh.node.lease import Caller


class StatusEvents:
    """Compares each status with the previous one, and records changes as events."""

    def __init__(self, events: EventLog) -> None:
        self._events = events
        self._holder = ""
        self._trouble = ""

    def record(self, status: Status) -> None:
        """Record another holder, and a lost or connected board, as events."""
        if status.holder != self._holder:
            text = f"{status.holder} drives." if status.holder else f"{self._holder} has freed the robot."
            self._events.add(EventKind.LEASE, caller=Caller(status.holder, ""), message=text)
        trouble = board_trouble(status)
        if trouble != self._trouble:
            reason = Reason.BOARD_LOST if trouble else Reason.OK
            text = trouble or f"The board at {status.board.port} is connected."
            self._events.add(EventKind.BOARD, reason=reason, message=text)
        self._holder, self._trouble = status.holder, trouble


def board_trouble(status: Status) -> str:
    """Return why the board is not connected, as a sentence; empty if it is connected."""
    lost = not status.board.connected or status.fault in (Fault.BOARD_LOST, Fault.CONTRACT_MISMATCH)
    return status.warnings[0] if lost and status.warnings else ""
