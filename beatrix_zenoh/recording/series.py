"""Positions of robots over time, in degrees: recorded live or read from a file, with the regularity of their time stamps."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from beatrix_zenoh.client.degrees import REST_DEG, reading
from beatrix_zenoh.client.robot import Robot
from beatrix_zenoh.client.robot_base import Offset, offset_of
from beatrix_zenoh.client.session import Place
from beatrix_zenoh.contract._generated.messages import Event, Positions, Status
from beatrix_zenoh.contract.errors import naming
from beatrix_zenoh.contract.names import ARMS
from beatrix_zenoh.recording.requests import MotionRequest, homes_set, requests
from beatrix_zenoh.recording.samples import Samples, TimedEvent, lost

Floats = npt.NDArray[np.float64]
Flags = npt.NDArray[np.bool_]

HEAD = ("yaw", "pitch", "roll")
AXES = (*ARMS, *HEAD)
GRID_S = 0.01
"""Step of common grids (s): positions arrive every 20 ms, and half of that loses no detail."""
SHARED_S = 1.0
"""Shortest overlap (s) of two recordings that can be compared."""
REST_S = 0.1
"""A robot is at rest if no arm turns by more than REST_DEG within this time (s) before and after."""
NOISY = 5.0
"""A robot whose angles are noisy is at rest if no arm turns by more than this many times the noise."""
BEFORE_HOME_S, AFTER_HOME_S = 0.5, 0.1
"""CALIBRATE is sent to a robot at rest, and reported up to this long (s) after it has acted."""
HOME_DEG = 0.5
"""A smaller change of home is none: a microstep is 0.09 deg."""
NORMAL = 1.48
"""Standard deviation of normal errors, divided by the median of their amounts."""
SMOOTH_S = 0.04
"""Angles are averaged over this time (s) before and after, so that noise of 0.1 deg is no movement."""
HOLE_S = 1.0
"""If two samples are further apart than this (s), the position between them is unknown."""
GAP_S = 0.1
"""Angles between two samples further apart than this (s) are interpolated, and are not compared."""
GAP = 1.6
"""A period longer than this many usual periods is a gap."""


@dataclass(frozen=True)
class Recording:
    """Positions over time: t (n,) in s and ascending, angles (n, 6) in deg in the order of AXES."""

    t: Floats
    angles: Floats
    """measured (simulation) or counted (hardware)"""
    commanded: Floats | None = None
    """(n, 3) in deg, the firmware's set points of the arms; None: not recorded"""
    lost: int | None = None
    """number of published samples that are missing; None: not known"""
    requests: tuple[MotionRequest, ...] = ()
    """the requests of motions, with times as in `t`"""
    homes_s: tuple[float, ...] = ()
    """times (s) at which the present position was declared home"""
    place: Place = ("", "")
    """name and side of the robot"""
    clock_s: float = 0.0
    """largest possible error of the times (s)"""
    slipped: int | None = None
    """full motor steps that slipped meanwhile, all arms together; None: not measured"""

    @property
    def arms(self) -> Recording:
        """The set points of the arms if they were recorded, else their positions, without the head."""
        angles = self.angles[:, : len(ARMS)] if self.commanded is None else self.commanded
        return replace(self, angles=angles, commanded=None)


@dataclass(frozen=True)
class Regularity:
    """The regularity of a recording's samples, by the time stamps of their source."""

    samples: int
    lost: int | None
    """published and not recorded, from sequence numbers; None: not known"""
    period_ms: float
    """the usual period (median)"""
    jitter_ms: float
    """standard deviation of the periods"""
    gaps: int
    """number of periods longer than 1.6 times `period_ms`"""
    longest_ms: float


def recording(
    positions: Sequence[Positions], clock_s: float = 0.0, events: Sequence[Event] = ()
) -> Recording:
    """Convert published positions to a recording in degrees.

    Args:
        positions: those of one robot, in order. Of several with the same time stamp the first is kept.
        clock_s: the source's monotonic clock minus the clock of the result (s).
        events: those of the robot, in order.
    """
    if not positions:
        return Recording(np.empty(0), np.empty((0, len(AXES))), np.empty((0, len(ARMS))))
    times, kept = np.unique([each.t_mono_ns for each in positions], return_index=True)
    readings = [reading(positions[i]) for i in kept]
    angles = np.array([(*r.arms, *r.head) for r in readings], dtype=np.float64)
    timed = [(event.t_mono_ns / 1e9 - clock_s, event) for event in events]
    commanded = np.array([r.commanded for r in readings], dtype=np.float64)
    return _recording(times / 1e9 - clock_s, angles, commanded, lost([each.seq for each in positions]), timed)


def of_samples(samples: Samples, begin_ns: int, events: Sequence[TimedEvent] = ()) -> Recording:
    """Convert positions that were read from a file; the result has times in s since `begin_ns` (ns since 1970)."""
    times, kept = np.unique(samples.time_ns, return_index=True)
    angles = np.hstack([samples.arms, samples.head])[kept]
    timed = [((each.time_ns - begin_ns) / 1e9, each.event) for each in events]
    return _recording((times - begin_ns) / 1e9, angles, samples.commanded[kept], samples.lost, timed)


def _recording(
    t: Floats, angles: Floats, commanded: Floats, missing: int | None, events: Sequence[tuple[float, Event]]
) -> Recording:
    """Return the recording of the samples whose angles are numbers; the others are gaps."""
    known = np.isfinite(np.hstack([angles, commanded])).all(axis=1)
    unwrapped = np.unwrap(angles[known], period=360, axis=0)
    return Recording(t[known], unwrapped, commanded[known], missing, requests(events), homes_set(events))


def regularity(recorded: Recording) -> Regularity:
    """Return the regularity of a recording of at least two samples."""
    periods = np.diff(recorded.t)
    usual = float(np.median(periods))
    return Regularity(
        samples=len(recorded.t),
        lost=recorded.lost,
        period_ms=usual * 1e3,
        jitter_ms=float(np.std(periods)) * 1e3,
        gaps=int(np.count_nonzero(periods > GAP * usual)),
        longest_ms=float(np.max(periods)) * 1e3,
    )


def unbroken(first: Recording, second: Recording) -> tuple[Recording, Recording]:
    """Return the longest common part without a hole, or a new home, in either recording; if there is none, both whole."""
    if min(len(first.t), len(second.t)) < 2:
        return first, second
    bad: list[tuple[float, float]] = []
    for recorded in (first, second):
        before = np.flatnonzero(np.diff(recorded.t) > HOLE_S)
        bad += zip(recorded.t[before].tolist(), recorded.t[before + 1].tolist(), strict=True)
        bad += [(home_s - BEFORE_HOME_S, home_s + AFTER_HOME_S) for home_s in new_homes(recorded)]
    free_s, end_s = float(max(first.t[0], second.t[0])), float(min(first.t[-1], second.t[-1]))
    parts = []
    for begin_s, until_s in [*sorted(bad), (end_s, end_s)]:
        parts.append((min(begin_s, end_s) - free_s, free_s))
        free_s = max(free_s, until_s)
    length_s, begin_s = max(parts)
    if length_s <= 0:
        return first, second
    return part_of(first, begin_s, begin_s + length_s), part_of(second, begin_s, begin_s + length_s)


def new_homes(recorded: Recording) -> list[float]:
    """Return the times (s) at which home was set and the arms were elsewhere, so that their angles changed at rest."""
    times = np.array(recorded.homes_s)
    moved = resample(recorded, times + AFTER_HOME_S) - resample(recorded, times - BEFORE_HOME_S)
    return [
        float(t) for t, jump in zip(times, moved, strict=True) if np.abs(jump[: len(ARMS)]).max() > HOME_DEG
    ]


def part_of(recorded: Recording, begin_s: float, end_s: float) -> Recording:
    """Return the part of a recording between two times (s), up to the nearest samples outside."""
    kept = slice(
        max(0, int(np.searchsorted(recorded.t, begin_s, side="right")) - 1),
        int(np.searchsorted(recorded.t, end_s)) + 1,
    )
    commanded = None if recorded.commanded is None else recorded.commanded[kept]
    return replace(recorded, t=recorded.t[kept], angles=recorded.angles[kept], commanded=commanded)


def common_grid(first: Recording, second: Recording) -> Floats:
    """Return times every 10 ms at which both were recorded.

    Raises:
        ValueError: they overlap by less than a second, or one has fewer than two positions.
    """
    if min(len(first.t), len(second.t)) < 2:
        raise ValueError("a recording with fewer than two positions cannot be compared")
    begin, end = max(first.t[0], second.t[0]), min(first.t[-1], second.t[-1])
    if end - begin < SHARED_S:
        raise ValueError(
            f"the recordings share {max(0.0, end - begin):.2f} s; at least {SHARED_S:g} s is needed"
        )
    return np.asarray(np.arange(begin, end, GRID_S), dtype=np.float64)


def resample(recorded: Recording, t: Floats) -> Floats:
    """Interpolate the angles (deg) linearly at times `t` (s)."""
    return np.column_stack([np.interp(t, recorded.t, column) for column in recorded.angles.T])


def sampled(recorded: Recording, t: Floats, around_s: float = 0.0) -> Flags:
    """Return which of the times `t` (s) are in no gap of a recording, nor within `around_s` (s) of one."""
    gaps = np.flatnonzero(np.diff(recorded.t) > GAP_S + 1e-6)
    begun = np.searchsorted(recorded.t[gaps] - around_s, t, side="left")
    ended = np.searchsorted(recorded.t[gaps + 1] + around_s, t, side="right")
    return np.asarray(begun == ended, dtype=np.bool_)


def resting(angles: Floats) -> Flags:
    """Return whether the arms rest, for each grid point; angles (n, 3) or wider in deg, the arms first."""
    window, half = int(REST_S / GRID_S), int(SMOOTH_S / GRID_S)
    wide = np.pad(angles[:, : len(ARMS)], ((half, half), (0, 0)), mode="edge")
    smooth = np.lib.stride_tricks.sliding_window_view(wide, 2 * half + 1, axis=0).mean(axis=-1)
    noise = np.median(np.abs(angles[:, : len(ARMS)] - smooth), axis=0) * NORMAL
    padded = np.pad(smooth, ((window, window), (0, 0)), mode="edge")
    views = np.lib.stride_tricks.sliding_window_view(padded, 2 * window + 1, axis=0)
    return np.asarray(np.all(np.ptp(views, axis=-1) < np.maximum(REST_DEG, NOISY * noise), axis=-1))


def runs(flags: Flags) -> list[tuple[int, int]]:
    """Return begin and end (exclusive) of each run of true flags."""
    edges = np.flatnonzero(np.diff(np.concatenate(([0], flags.astype(np.int8), [0]))))
    return [(int(begin), int(end)) for begin, end in edges.reshape(-1, 2)]


def turned(difference: Floats) -> Floats:
    """Reduce differences of angles (deg) to at most half a turn: 359 becomes -1."""
    return np.asarray((difference + 180.0) % 360.0 - 180.0, dtype=np.float64)


def heads_apart(first: Floats, second: Floats) -> Floats:
    """Return the angle (n,) in deg of the rotation between two heads; yaw, pitch, roll (n, 3) in deg."""
    # |R - S| = 2 sqrt(2) sin(angle / 2) in the Frobenius norm: exact for small angles, unlike the trace.
    chord = np.linalg.norm(rotations(first) - rotations(second), axis=(1, 2)) / (2 * np.sqrt(2))
    return np.asarray(np.degrees(2 * np.arcsin(np.minimum(1.0, chord))), dtype=np.float64)


def rotations(head: Floats) -> Floats:
    """Return the matrices (n, 3, 3) of yaw, pitch, roll (n, 3) in deg: Rz(yaw) Ry(pitch) Rx(roll)."""
    (cy, cp, cr), (sy, sp, sr) = np.cos(np.radians(head)).T, np.sin(np.radians(head)).T
    rows = [
        [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
        [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
        [-sp, cp * sr, cp * cr],
    ]
    return np.asarray(np.moveaxis(np.array(rows), -1, 0), dtype=np.float64)


TAKE_S = 0.25
"""Period of reading the subscriptions and of reporting the time."""


def record_robots(
    robots: Sequence[Robot], seconds: float, passed: Callable[[float], None] = lambda _passed_s: None
) -> list[Recording]:
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
) -> Recording:
    """Return the recording of one robot, with times by this computer's clock."""
    with naming(str(robot)):
        slipped = slipped_between(before, robot.status())
    clock_s = offset.certain
    return replace(
        recording(positions, clock_s, events),
        place=robot.place,
        clock_s=offset.bound if clock_s else 0.0,
        slipped=slipped,
    )


def slipped_between(before: Status, after: Status) -> int | None:
    """Return the full motor steps that slipped between two statuses; None: not measured."""
    if before.plant is None or after.plant is None:
        return None
    if before.calibrations != after.calibrations:
        return after.plant.slipped_steps  # a calibration sets the count to 0
    return after.plant.slipped_steps - before.plant.slipped_steps
