"""One choreography on both robots, recorded and timed: the middle of `beatrix demo`."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Callable
from dataclasses import dataclass, field

from beatrix_zenoh._generated.messages import MotionQuery, PlantStatus, PoseQuery, Positions
from beatrix_zenoh.choreography import Choreography, Pose, play
from beatrix_zenoh.errors import BeatrixError
from beatrix_zenoh.robot import Motion, PositionStream, Robot
from beatrix_zenoh.twin import Twin

SETTLE_S = 0.5
"""Recorded before and after the movement, at rest."""


class TimedRobot(Robot):
    """A robot that notes how long each motion took to be accepted."""

    accepted_s: list[float]

    @classmethod
    def of(cls, robot: Robot) -> TimedRobot:
        """The same robot through the same session."""
        timed = cls(robot.name, robot.twin, client=robot.client)
        timed.accepted_s = []
        return timed

    def begin(self, road: str, query: MotionQuery | PoseQuery) -> Motion:
        """As `Robot.begin`."""
        asked = time.perf_counter()
        motion = super().begin(road, query)
        self.accepted_s.append(time.perf_counter() - asked)
        return motion


@dataclass
class Record:
    """What one robot did."""

    positions: list[Positions] = field(default_factory=list)
    accepted_s: list[float] = field(default_factory=list)


@dataclass
class Performance:
    """What both did, and how the simulation fared."""

    sim: Record
    hw: Record
    plant: PlantStatus | None


def perform(twin: Twin, choreography: Choreography, tell: Callable[[str, Pose], None]) -> Performance:
    """Switch both on, calibrate, play, record; whatever goes wrong, both are stopped.

    Raises:
        Refused, Interrupted, NoAnswer: of the first thing that failed.
    """
    sim, hw = TimedRobot.of(twin.sim), TimedRobot.of(twin.hw)
    twin.sim, twin.hw = sim, hw
    twin.enable()
    twin.calibrate()
    streams = [(sim.stream(), Record()), (hw.stream(), Record())]

    def keep_and_tell(title: str, pose: Pose) -> None:
        keep(streams)
        tell(title, pose)

    try:
        time.sleep(SETTLE_S)
        play(twin, choreography, keep_and_tell)
        time.sleep(SETTLE_S)
    except BaseException:
        with contextlib.suppress(BeatrixError):
            twin.stop()
        raise
    keep(streams)
    (_, of_sim), (_, of_hw) = streams
    of_sim.accepted_s, of_hw.accepted_s = sim.accepted_s, hw.accepted_s
    return Performance(of_sim, of_hw, sim.status().plant)


def keep(streams: list[tuple[PositionStream, Record]]) -> None:
    """Take what has come, before a stream must drop it."""
    for stream, record in streams:
        record.positions += stream.take(0.0)
