"""Motors on and off, and home: asked of the board, and answered once its telemetry shows it."""

from __future__ import annotations

import math
from collections.abc import Callable

from beatrix_zenoh._generated.messages import Reason
from beatrix_zenoh._generated.serial import FrameType, State, Telemetry
from beatrix_zenoh.board.board import Board
from beatrix_zenoh.drive import Arms
from beatrix_zenoh.errors import NoAnswer, Refused
from beatrix_zenoh.node.body import Body
from beatrix_zenoh.node.course import degrees

REFLECTED_S = 0.3
SAME_HOME = math.radians(15.0)
"""Home may be mended by so much at once; cables and limits count from it."""


def switch(board: Board, *, on: bool) -> str:
    """Motors on or off; what is then true.

    Raises:
        Refused, NoAnswer: as `Board.request`.
    """
    board.enable(on=on)
    reflected(board, lambda telemetry: bool(telemetry.state & State.ENABLED) == on)
    if not on:
        return "Motors off; home is forgotten."
    if board.state & State.CALIBRATED:
        return "Motors on; home is known."
    return "Motors on. If the head is upright, calibrate; else disable and set it upright first."


def calibrate(board: Board, body: Body, stood: Arms) -> str:
    """Declare the present place, `stood` (rad) from home so far, home; what is then true.

    Raises:
        Refused, NoAnswer: as `Board.request`, NOT_AT_REST, NOT_ENABLED, HOME_KNOWN.
    """
    board.check_heard()
    state = board.state
    if state & State.MOVING:
        raise Refused(Reason.NOT_AT_REST, "The arms are moving: wait or stop, then calibrate.")
    if not state & State.ENABLED:
        raise Refused(Reason.NOT_ENABLED, "The motors are off: enable first, then calibrate.")
    if state & State.CALIBRATED and max(map(abs, stood)) > SAME_HOME:
        raise Refused(
            Reason.HOME_KNOWN,
            f"Home is known: no need to calibrate. The arms stand at {degrees(stood)} from it; `beatrix home` goes there. "
            "To set it anew: disable, set the head upright and straight ahead, enable, calibrate.",
        )
    body.straighten()
    board.request(FrameType.CALIBRATE)
    # Known before, home is another place now: only the new position shows it.
    reflected(
        board, lambda telemetry: bool(telemetry.state & State.CALIBRATED) and not any(telemetry.position)
    )
    if state & State.CALIBRATED and any(stood):
        return (
            f"This is home now. Home was known already, and the arms stood at {degrees(stood)} from it: was that "
            "meant? Limits count from home. To set it anew: disable, set the head upright, enable, calibrate."
        )
    return "This is home now."


def unlatched(board: Board) -> bool:
    """The board is seen, and does not show that EMERGENCY_STOP holds."""
    return board.connected and not board.wait_for(
        lambda telemetry: bool(telemetry.state & State.EMERGENCY), REFLECTED_S
    )


def reflected(board: Board, holds: Callable[[Telemetry], bool]) -> None:
    """Until new telemetry shows what the firmware has just acknowledged, so that the next request sees it too.

    What was known before may be another board's by now: it was reset just then, and knows no home.

    Raises:
        NoAnswer: BOARD_LOST, it does not show it.
        Refused: STOPPED, by EMERGENCY_STOP.
    """
    before = board.telemetry
    if not board.wait_for(
        lambda new: new is not before and (holds(new) or bool(new.state & State.EMERGENCY)), REFLECTED_S
    ):
        raise NoAnswer(Reason.BOARD_LOST, "The board acknowledged but its telemetry does not show it.")
    newest = board.telemetry
    if newest is not None and not holds(newest) and newest.state & State.EMERGENCY:
        raise Refused(Reason.STOPPED, "EMERGENCY_STOP was pressed meanwhile: look, then enable.")
