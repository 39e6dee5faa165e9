"""Whether a robot may move, and what it lacks."""

from __future__ import annotations

from beatrix_zenoh import readiness
from beatrix_zenoh._generated.serial import State, Telemetry
from beatrix_zenoh.board.board import Board, unheard


def ready_telemetry(board: Board) -> Telemetry:
    """The newest telemetry of a robot that may move.

    Raises:
        Refused or NoAnswer: what is missing and what to do.
    """
    telemetry, link = board.telemetry, board.link
    if telemetry is None or not link.connected:
        raise unheard(link)
    state = telemetry.state
    readiness.check(
        emergency=bool(state & State.EMERGENCY),
        enabled=bool(state & State.ENABLED),
        calibrated=bool(state & State.CALIBRATED),
    )
    return telemetry
