"""The state of a robot for pages, as data for JSON; angles in degrees."""

from __future__ import annotations

import math

from beatrix_zenoh.client import RobotState
from beatrix_zenoh.contract._generated.messages import FAULT_TEXT, Fault, Status


def state_of(state: RobotState) -> dict[str, object]:
    """Return the state of one robot; fields that are not known are None."""
    reading, status = state.reading, state.status
    return {
        "robot": state.robot,
        "side": state.side,
        "presence": state.presence,
        "age_s": state.positions_age_s,
        "head": None if reading is None else tidy(reading.head),
        "arms": None if reading is None else tidy(reading.arms),
        "status": None if status is None else status_of(status),
    }


def status_of(status: Status) -> dict[str, object]:
    """Return the state of motors, lease and cameras of a robot, with its problems."""
    return {
        "enabled": status.enabled,
        "calibrated": status.calibrated,
        "moving": status.moving,
        "emergency": status.fault is Fault.EMERGENCY,
        "frozen": status.frozen,
        "holder": status.holder,
        "taken": bool(status.lease),
        "waiting": status.waiting,
        "speed_limit": math.degrees(status.speed_limit),
        "problems": problems(status),
        "eyes": [camera.eye for camera in status.cameras],
    }


def problems(status: Status) -> list[str]:
    """Return fault and warnings as sentences, without the emergency stop, for which pages have their own sentence."""
    if status.fault in (Fault.NONE, Fault.EMERGENCY):
        return status.warnings
    return [FAULT_TEXT.get(status.fault, f"{status.fault}."), *status.warnings]


def tidy(angles: tuple[float, ...]) -> list[float]:
    """Round angles to one decimal, without a minus sign before 0.0."""
    return [round(angle, 1) + 0.0 for angle in angles]
