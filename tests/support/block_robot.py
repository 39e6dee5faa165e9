"""A robot that a program of blocks drives through the SDK."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable

from beatrix_zenoh import Robot
from beatrix_zenoh.client.choreography import load, play

PART_S = 0.1


class SdkRobot:
    """What `walk` drives: one robot, while `check` raises nothing."""

    def __init__(self, robot: Robot, check: Callable[[], None]) -> None:
        self._robot, self.check = robot, check
        self._never = threading.Event()

    def begin(self, block: str) -> None:
        """Do nothing."""

    def look(self, yaw: float, pitch: float, roll: float, speed: float | None) -> None:
        self._robot.look(yaw, pitch, roll, speed=speed)

    def move_arm(self, arm: str, angle: float, speed: float | None) -> None:
        self._robot.move(*self._robot.positions().commanded._replace(**{arm: angle}), speed=speed)

    def home(self, speed: float | None) -> None:
        self._robot.move(0, 0, 0, speed=speed)

    def gesture(self, name: str) -> None:
        play(self._robot, load(name), check=self.check)

    def wait(self, seconds: float) -> None:
        end_s = time.monotonic() + seconds
        while (left_s := end_s - time.monotonic()) > 0:
            self.check()
            self._never.wait(min(left_s, PART_S))

    def position(self, part: str) -> float:
        found = self._robot.positions()
        return float(getattr(found.head if part in ("yaw", "pitch", "roll") else found.arms, part))
