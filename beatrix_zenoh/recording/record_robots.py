"""Record robots for some seconds, with all times by the clock of this computer."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from beatrix_zenoh.client.robot import Robot
from beatrix_zenoh.client.robot_base import Offset, offset_of
from beatrix_zenoh.contract._generated.messages import Event, Positions, Status
from beatrix_zenoh.contract.errors import naming
from beatrix_zenoh.recording.series import Recording, recording

TAKE_S = 0.25
"""Period of reading the subscriptions and of reporting the time."""


@dataclass(frozen=True)
class LiveRecording:
    """The recording of one robot."""

    robot: str
    side: str
    recording: Recording
    """a recording with times by this computer's monotonic clock (s)"""
    clock_s: float
    """largest possible error of the times of `recording` (s)"""
    slipped: int | None
    """full motor steps that slipped during the recording, all arms together; None: not measured"""


def record_robots(
    robots: Sequence[Robot], seconds: float, passed: Callable[[float], None] = lambda _passed_s: None
) -> list[LiveRecording]:
    """Record robots for some seconds; call `passed` with the elapsed seconds four times a second.

    Raises:
        NoAnswer: a robot is not online or publishes nothing.
    """
    before = [(offset_of(robot), robot.status()) for robot in robots]
    streams = [robot.positions_stream() for robot in robots]
    told = [robot.events() for robot in robots]
    events: list[list[Event]] = [[] for _ in robots]
    try:
        kept: list[list[Positions]] = [
            [stream.next(robot.timeout_s)] for robot, stream in zip(robots, streams, strict=True)
        ]
        begin_s = time.monotonic()
        while (left_s := begin_s + seconds - time.monotonic()) > 0:
            time.sleep(min(left_s, TAKE_S))
            for i, stream in enumerate(streams):
                kept[i] += stream.take()
                events[i] += told[i].take()
            passed(time.monotonic() - begin_s)
    finally:
        for stream, events_of in zip(streams, told, strict=True):
            stream.close()
            events_of.close()
    return [
        live_recording(robot, positions, requests, *known)
        for robot, positions, requests, known in zip(robots, kept, events, before, strict=True)
    ]


def live_recording(
    robot: Robot, positions: Sequence[Positions], events: Sequence[Event], offset: Offset, before: Status
) -> LiveRecording:
    """Return the recording of one robot, with times by this computer's clock.

    The offset of the clocks is measured again; the more exact of both measurements is used.
    """
    with naming(str(robot)):
        after, status = offset_of(robot), robot.status()
    better = min(offset, after, key=lambda each: each.bound)
    clock_s = better.certain
    drifted_s = abs(after.offset - offset.offset) if clock_s else 0.0
    return LiveRecording(
        robot.name,
        robot.side,
        recording(positions, clock_s, events),
        better.bound + drifted_s if clock_s else 0.0,
        slipped_between(before, status),
    )


def slipped_between(before: Status, after: Status) -> int | None:
    """Return the full motor steps that slipped between two statuses; None: not measured."""
    if before.plant is None or after.plant is None:
        return None
    if before.calibrations != after.calibrations:
        return after.plant.slipped_steps  # a calibration sets the count to 0
    return after.plant.slipped_steps - before.plant.slipped_steps
