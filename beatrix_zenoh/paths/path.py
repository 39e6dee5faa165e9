"""A path: angles of the arms over time, smooth between the points of a motion file or a recording."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
import numpy.typing as npt

from beatrix_zenoh.client.choreography import Choreography, Pose, Step
from beatrix_zenoh.client.degrees import DAY_S, REST_DEG, ArmAngles, HeadAngles, checked_factor
from beatrix_zenoh.client.motion_file import SPEED, MotionFile, Place, WrongLine
from beatrix_zenoh.contract._generated.robot import RobotData
from beatrix_zenoh.contract._generated.serial import Telemetry
from beatrix_zenoh.contract.errors import naming, wrong_usage
from beatrix_zenoh.motion.gear import Arms
from beatrix_zenoh.motion.limits import MotionLimits
from beatrix_zenoh.node.planner import Planner

Floats = npt.NDArray[np.float64]
POINT_S = 0.05
"""Time between the points of a path that is made from a recording."""
LEAST = 1e-12
"""A smaller product of two speeds (deg2/s2) counts as zero."""
STILL_S = 0.5
"""Rest that is kept before the first motion and after the last."""
LONGEST_S: Final = 3600.0
"""Longest duration (s) of a path: planning and checking such a path takes minutes and about 100 MB."""


@dataclass(frozen=True)
class ArmPath:
    """Points (n) of a path, at least two: t in s from 0, ascending; arms (n, 3) in deg."""

    source: str
    """name of the path in messages"""
    t: Floats
    arms: Floats
    lines: tuple[int, ...] = ()
    """the line of each point in its file; empty: no file"""
    factor: float = 1.0
    """speed relative to the file or recording"""
    begin_s: float = 0.0
    """time of the first point in the file, or since the start of the recorded motion"""

    @property
    def duration_s(self) -> float:
        """Time of the last point."""
        return float(self.t[-1])

    def where(self, t: float) -> str:
        """Describe a time of the path (s) for a message: the time in the file, and the line of the next point there."""
        t = max(0.0, t)
        given_s = self.given_s(t)
        if not self.lines:
            return f"{self.source}, t = {given_s:.2f} s"
        line = self.lines[min(int(np.searchsorted(self.t, t - 1e-9)), len(self.lines) - 1)]
        return f"{self.source}, line {line} (t = {given_s:.2f} s)"

    def given_s(self, t: float) -> float:
        """Return the time in the file or recording (s) for a time of the path (s)."""
        return self.begin_s + t * self.factor

    def beginning(self, given_s: float) -> ArmPath:
        """Return the path from a time of the file or recording (s) on, 0: all of it; raises WrongUsage outside its times."""
        if given_s == 0:
            return self
        begin, end = self.begin_s, self.given_s(self.duration_s)
        if not begin <= given_s < end:
            raise wrong_usage(
                f"{self.source} lasts from {begin:g} to {end:g} s, so a replay cannot begin at {given_s:g} s. "
                "Give a time between them.",
            )
        skipped_s = (given_s - begin) / self.factor
        later = self.t > skipped_s
        later[-1] = True  # also after rounding
        t = np.concatenate(([0.0], self.t[later] - skipped_s))
        arms = np.concatenate((self.at(np.array([skipped_s])), self.arms[later]))
        lines = self.lines[-len(t) + 1 :]
        return replace(self, t=t, arms=arms, lines=lines[:1] + lines, begin_s=given_s)

    def at_speed(self, factor: float) -> ArmPath:
        """Return the path at `factor` times its speed; raises WrongUsage if the factor or the duration is invalid."""
        whole = checked_factor(self.factor * checked_factor(factor))
        path = replace(self, t=self.t / factor, factor=whole)
        path.check_length()
        return path

    def check_length(self) -> None:
        """Raise WrongUsage (BAD_VALUE) if the path is longer than LONGEST_S."""
        if self.duration_s <= LONGEST_S:
            return
        at_factor = "" if self.factor == 1 else f" at the speed factor {self.factor:g}"
        raise wrong_usage(
            f"{self.source} takes {self.duration_s:.0f} s{at_factor}; at most {LONGEST_S:.0f} s is allowed. "
            "Replay it faster, or in parts.",
        )

    def at(self, t: Floats) -> Floats:
        """Return the arm angles (m, 3) in deg at times t (m,) in s.

        They are interpolated by cubics without overshoot between points, and constant before the first point and after
        the last.
        """
        t = np.clip(t, self.t[0], self.t[-1])
        i = np.clip(np.searchsorted(self.t, t, side="right") - 1, 0, len(self.t) - 2)
        h = (self.t[i + 1] - self.t[i])[:, None]
        u = ((t - self.t[i])[:, None]) / h
        slopes = self._slopes()
        return np.asarray(
            (1 + 2 * u) * (1 - u) ** 2 * self.arms[i]
            + u * (1 - u) ** 2 * h * slopes[i]
            + u**2 * (3 - 2 * u) * self.arms[i + 1]
            + u**2 * (u - 1) * h * slopes[i + 1],
            dtype=np.float64,
        )

    def _slopes(self) -> Floats:
        """Return speeds (deg/s) at the points: 0 at turning points and ends, else a mean of the slopes on both sides.

        With a weighted harmonic mean the interpolation is monotonic between two points (Fritsch and Butland, 1984).
        """
        h = np.diff(self.t)[:, None]
        secants = np.diff(self.arms, axis=0) / h
        slopes = np.zeros_like(self.arms)
        before, after = secants[:-1], secants[1:]
        one, other = 2 * h[1:] + h[:-1], h[1:] + 2 * h[:-1]
        same = before * after > LEAST
        safe_before, safe_after = np.where(same, before, 1.0), np.where(same, after, 1.0)
        slopes[1:-1] = np.where(same, (one + other) / (one / safe_before + other / safe_after), 0.0)
        return slopes


def path_of(read: MotionFile, limits: MotionLimits) -> ArmPath:
    """Return the path of a motion file, for a robot with these limits.

    Raises:
        WrongUsage: BAD_VALUE, the file is a choreography, has only one point, or has two points at the same time.
        Refused: OUT_OF_REACH, a head orientation exceeds the tilt limit; the message names the line.
    """
    if read.with_speed:
        raise wrong_usage(
            f"{read.source} has a column {SPEED}, so it is a choreography: play it with `beatrix play`.",
        )
    points = read.points
    if len(points) < 2:
        raise wrong_usage(f"{read.source} has one point; a path needs at least two. Add a point.")
    for before, after in itertools.pairwise(points):
        if after.t == before.t:
            raise WrongLine(
                after.line,
                f"{read.source}, line {after.line}: t_s is {after.t:g}, the same as in the line before. Times of a path "
                "must increase from point to point.",
            )
    arms = []
    for point in points:
        with naming(f"{read.source}, line {point.line} (t = {point.t:.2f} s)"):
            arms.append(arms_of(point.place, limits))
    t = np.array([point.t for point in points])
    lines = tuple(point.line for point in points)
    return ArmPath(read.source, t - t[0], np.array(arms), lines, begin_s=points[0].t)


def arms_of(place: Place, limits: MotionLimits) -> tuple[float, float, float]:
    """Return the arm angles (deg) for angles of head or arms (deg); raises Refused if the head may not tilt so far."""
    if not isinstance(place, HeadAngles):
        return place
    x, y, z = limits.arms_of_head(*(math.radians(angle) for angle in place))
    return math.degrees(x), math.degrees(y), math.degrees(z)


def path_of_recording(source: str, recorded_s: Floats, angles: Floats) -> ArmPath:
    """Return the path of recorded arm angles (n, 3) in deg, without the rests before the first motion and after the last.

    `recorded_s`: their times (n,) in s, ascending.

    Raises:
        WrongUsage: BAD_VALUE, the robot did not move, or its motions span more than a day.
    """
    moved = np.flatnonzero(np.max(np.abs(angles - angles[:1]), axis=1) > REST_DEG)
    unfinished = np.flatnonzero(np.max(np.abs(angles - angles[-1:]), axis=1) > REST_DEG)
    if not len(moved):
        raise wrong_usage(f"{source}: the robot did not move, so there is nothing to replay.")
    begin_s = max(recorded_s[0], recorded_s[moved[0]] - STILL_S)
    end_s = min(recorded_s[-1], recorded_s[unfinished[-1]] + STILL_S)
    if end_s - begin_s > DAY_S:  # after a change of a clock the next lines could allocate all memory
        raise wrong_usage(
            f"{source}: its motions span {end_s - begin_s:.0f} s; at most {DAY_S:.0f} s is allowed. Record shorter parts.",
        )
    t = np.arange(begin_s, end_s + POINT_S, POINT_S)
    return ArmPath(
        source, t - begin_s, np.column_stack([np.interp(t, recorded_s, column) for column in angles.T])
    )


def check_choreography(choreography: Choreography, robot: RobotData) -> None:
    """Check each pose and the path to it from the previous pose, as the robot would check them.

    The position before the first pose is unknown, so only the first pose itself and its speed are checked.

    Raises:
        Refused: a pose, a path or a speed exceeds a limit; the message names line and time.
    """
    planner = Planner(robot)
    here: Arms | None = None
    for index, (_title, step) in enumerate(choreography.steps):
        with naming(choreography.where(index)):
            start = first_arms(step, planner) if here is None else here
            here = planner.goal(step.query(), resting(planner.gear.to_steps(start))).target


def first_arms(step: Step, planner: Planner) -> Arms:
    """Return the arm angles (rad) of the first pose; raises Refused if it exceeds a limit or is out of reach."""
    if isinstance(step, Pose):
        place: Place = HeadAngles(step.yaw, step.pitch, step.roll)
    else:
        place = ArmAngles(step.short, step.middle, step.long)
    x, y, z = (math.radians(angle) for angle in arms_of(place, planner.limits))
    planner.limits.check_pose((x, y, z))
    return x, y, z


def resting(position: tuple[int, int, int]) -> Telemetry:
    """Return the telemetry of a board whose arms rest at this position (microsteps)."""
    return Telemetry(0, 0, 0, 0, 0, position, (0, 0, 0), 0, 0)
