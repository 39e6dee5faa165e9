"""Whether a robot may move, and what it lacks."""

from __future__ import annotations

from beatrix_zenoh._generated.messages import Reason
from beatrix_zenoh._generated.serial import State, Telemetry
from beatrix_zenoh.board.board import Board, unheard
from beatrix_zenoh.errors import Refused


def ready_telemetry(board: Board) -> Telemetry:
    """The newest telemetry of a robot that may move.

    Raises:
        Refused or NoAnswer: what is missing and what to do.
    """
    telemetry, link = board.telemetry, board.link
    if telemetry is None or not link.connected:
        raise unheard(link)
    if telemetry.state & State.EMERGENCY:
        raise Refused(
            Reason.NOT_ENABLED, "The emergency stop is latched: set the head upright, enable, calibrate."
        )
    if not telemetry.state & State.ENABLED:
        raise Refused(Reason.NOT_ENABLED, "The motors are off: set the head upright, enable, calibrate.")
    if not telemetry.state & State.CALIBRATED:
        raise Refused(
            Reason.NOT_CALIBRATED,
            "Home is not known: if the head is upright, calibrate; else disable, set it upright, enable, calibrate.",
        )
    return telemetry
