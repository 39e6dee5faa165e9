"""Firmware and plant in virtual time, driven tick by tick by a check of a lesson (beatrix_zenoh/lessons/bench.py)."""

from __future__ import annotations

import math

from beatrix_zenoh.board.virtual import Firmware
from beatrix_zenoh.contract._generated.messages import PoseQuery
from beatrix_zenoh.contract._generated.robot import ROBOT
from beatrix_zenoh.contract._generated.serial import Enable, FrameType
from beatrix_zenoh.node.planner import Goal, Planner
from sim_node.plant import Plant
from sim_node.virtual_time import VirtualTime

BUSIEST_MOTION = 1000
"""Motions are numbered from 1 to this number, and again."""


class VirtualTimeRobot(VirtualTime):
    """A calibrated robot in virtual time; `speed` (deg/s) of its motions, None: the default."""

    def __init__(self, speed: float | None = None) -> None:
        super().__init__(Plant(), Firmware())
        self._planner = Planner(ROBOT)
        self._speed = None if speed is None else math.radians(speed)
        self._last: Goal | None = None
        self._motion = 0
        for kind, payload in ((FrameType.ENABLE, Enable(1).pack()), (FrameType.CALIBRATE, b"")):
            self.send(kind, payload)
            self.advance()

    def tick(self, target: tuple[float, float, float]) -> dict[str, list[float]]:
        """Start to turn to yaw, pitch and roll (deg), let a tick pass, and return the state; raises BeatrixError."""
        assert self.telemetry is not None
        yaw, pitch, roll = map(math.radians, target)
        query = PoseQuery(yaw=yaw, pitch=pitch, roll=roll, speed=self._speed)
        goal = self._planner.goal(query, self.telemetry, self._last)
        self._motion = self._motion % BUSIEST_MOTION + 1
        frame = goal.frame(self._motion)
        self.send(frame.kind, frame.pack())
        self._last = goal
        self.advance()
        return self.state()

    def state(self) -> dict[str, list[float]]:
        """Return angles (deg) and speeds (deg/s) of arms and head, and the set points of the arms (deg)."""
        plant = self.plant
        return {
            "arms": _degrees(plant.arms()),
            "head": _degrees(plant.head()),
            "speed": _degrees(plant.velocities()),
            "commanded": _degrees(self._planner.gear.to_rad(self.firmware.set_points())),
        }


def _degrees(angles: tuple[float, float, float]) -> list[float]:
    return [math.degrees(angle) for angle in angles]
