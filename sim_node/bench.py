"""Firmware and plant in virtual time, driven line by line by a check of a lesson (beatrix_zenoh/lessons/bench.py).

Each line of standard input is one tick: `{"head": [yaw, pitch, roll]}`, a target in degrees, or `{}`. The answer is the
state at the end of the tick, or the refusal of the target. The same inputs always give the same answers.
"""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Mapping

from beatrix_zenoh.board.virtual import Firmware
from beatrix_zenoh.contract._generated.messages import PoseQuery
from beatrix_zenoh.contract._generated.robot import ROBOT
from beatrix_zenoh.contract._generated.serial import Enable, FrameType
from beatrix_zenoh.contract.errors import BeatrixError
from beatrix_zenoh.node.planner import Goal, Planner
from sim_node.plant import Plant
from sim_node.virtual_time import VirtualTime

BUSIEST_MOTION = 1000
"""Motions are numbered from 1 to this number, and again."""

Answer = dict[str, object]


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

    def tick(self, target: list[float] | None) -> Answer:
        """Start to turn to a target (yaw, pitch, roll; deg), let a tick pass, and return the state, or the refusal."""
        if target is not None:
            try:
                self._begin([math.radians(angle) for angle in target])
            except BeatrixError as error:
                return {"refused": error.data}
        self.advance()
        plant = self.plant
        return {
            "arms": _degrees(plant.arms()),
            "head": _degrees(plant.head()),
            "speed": _degrees(plant.velocities()),
            "commanded": _degrees(self._planner.gear.to_rad(self.firmware.set_points())),
        }

    def _begin(self, target: list[float]) -> None:
        assert self.telemetry is not None
        query = PoseQuery(yaw=target[0], pitch=target[1], roll=target[2], speed=self._speed)
        goal = self._planner.goal(query, self.telemetry, self._last)
        self._motion = self._motion % BUSIEST_MOTION + 1
        frame = goal.frame(self._motion)
        self.send(frame.kind, frame.pack())
        self._last = goal


def _degrees(angles: tuple[float, float, float]) -> list[float]:
    return [math.degrees(angle) for angle in angles]


def main() -> int:
    """Answer the lines of standard input; an entry point of group `beatrix.processes`. The first line has the speed."""
    options: Mapping[str, float | None] = json.loads(sys.stdin.readline())
    bench = VirtualTimeRobot(options["speed"])
    _write({"ready": True})
    for line in sys.stdin:
        _write(bench.tick(json.loads(line).get("head")))
    return 0


def _write(answer: Answer) -> None:
    sys.stdout.write(json.dumps(answer) + "\n")
    sys.stdout.flush()


if __name__ == "__main__":
    sys.exit(main())
