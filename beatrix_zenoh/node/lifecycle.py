"""Switch the motors, calibrate and reset: request the change from the board and wait until its telemetry shows it."""

from __future__ import annotations

import math
from collections.abc import Callable

from beatrix_zenoh.board.board import Board
from beatrix_zenoh.contract import refusals
from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract._generated.serial import FrameType, State, Telemetry
from beatrix_zenoh.contract.errors import NoAnswer
from beatrix_zenoh.motion.gear import Arms
from beatrix_zenoh.node.hardware import HardwareInterface
from beatrix_zenoh.node.planner import degrees

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
    wait_until_shown(board, lambda telemetry: bool(telemetry.state & State.ENABLED) == on)
    if not on:
        return "The motors are off, and home is no longer known."
    if board.state & State.CALIBRATED:
        return "The motors are on, and home is known."
    return "The motors are on. If the head is upright, calibrate; otherwise disable and set it upright first."


def calibrate(board: Board, hardware: HardwareInterface, arms: Arms) -> str:
    """Declare the present position home and return the new state as a sentence; `arms`: angles from the old home (rad).

    Raises:
        Refused, NoAnswer: as `Board.request` and `wait_until_shown`; NOT_AT_REST, NOT_ENABLED, HOME_KNOWN.
    """
    board.check_connected()
    state = board.state
    if state & State.MOVING:
        raise refusals.not_at_rest()
    if not state & State.ENABLED:
        raise refusals.not_enabled()
    if state & State.CALIBRATED and max(map(abs, arms)) > HOME_SHIFT_MAX:
        raise refusals.home_known(arms, HOME_SHIFT_MAX)
    hardware.straighten()
    board.request(FrameType.CALIBRATE)
    # If home was known before, CALIBRATED is already set, and only the position 0 shows the change.
    wait_until_shown(
        board, lambda telemetry: bool(telemetry.state & State.CALIBRATED) and not any(telemetry.position)
    )
    if state & State.CALIBRATED and any(arms):
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
    if not board.state & State.EMERGENCY:
        return "EMERGENCY_STOP is not latched."
    board.request(FrameType.RESET)
    # Not `wait_until_shown`, which fails under the latch: telemetry from before RESET may still arrive and show it.
    if not board.wait_for(lambda telemetry: not telemetry.state & State.EMERGENCY, TELEMETRY_S):
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
        lambda new: new is not before and (holds(new) or bool(new.state & State.EMERGENCY)), TELEMETRY_S
    ):
        raise NoAnswer(
            Reason.BOARD_LOST,
            "The board acknowledged the request, but its telemetry does not show the change. Try again.",
        )
    newest = board.telemetry
    if newest is not None and not holds(newest) and newest.state & State.EMERGENCY:
        raise refusals.emergency_latched()
