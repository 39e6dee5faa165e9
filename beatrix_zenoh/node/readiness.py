"""The check that a robot is ready to move."""

from __future__ import annotations

from beatrix_zenoh.board.board import Board
from beatrix_zenoh.board.state import not_connected
from beatrix_zenoh.contract import refusals
from beatrix_zenoh.contract._generated.serial import BoardState, Telemetry


def ready_telemetry(board: Board) -> Telemetry:
    """Return the newest telemetry of a robot that is ready to move.

    Raises:
        Refused or NoAnswer: the robot is not ready to move; the message says why and what to do.
    """
    telemetry, link = board.telemetry, board.link
    if telemetry is None or not link.connected:
        raise not_connected(link)
    state = telemetry.state
    refusals.check_ready(
        emergency=bool(state & BoardState.EMERGENCY),
        enabled=bool(state & BoardState.ENABLED),
        calibrated=bool(state & BoardState.CALIBRATED),
    )
    return telemetry
