"""Targets that make a robot follow a path at its times, planned and checked before the robot moves.

The firmware moves every arm to its target with the highest allowed acceleration. To follow a path, a robot gets a
target every 40 ms. The target contains, for each arm, a point ahead on the path, at which the path turns back or which
is just beyond the braking distance, and the speed that brings the arm back onto the path two targets later.
`trajectory.plan` calculates the resulting motion in advance.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, NamedTuple

import numpy as np

from beatrix_zenoh.client.degrees import RobotInfo, motion_query, robot_of
from beatrix_zenoh.client.twin import unlike
from beatrix_zenoh.contract._generated.messages import MotionQuery, Reason
from beatrix_zenoh.contract._generated.robot import RobotData
from beatrix_zenoh.contract.errors import Refused, naming
from beatrix_zenoh.motion.gear import Arms
from beatrix_zenoh.motion.limits import MotionLimits
from beatrix_zenoh.paths.path import ArmPath, Floats

TARGET_S: Final = 0.04
"""Time between two targets."""
LOOK_S: Final = 0.08
"""The speed of a target brings the arm back onto the path within this time. With shorter times the arms oscillate; with
longer times they leave the path where it turns."""
STEP_S: Final = 0.01
LEAD_IN_S: Final = 0.08
"""Targets begin this long before the path: an arm that starts late cannot catch up if the path accelerates fully."""
AHEAD_S: Final = 0.7
"""The longest time from now to the target's point on the path. A target is only as far ahead as the arm needs to brake,
because a robot checks each motion up to its end, where arms of different speeds must still be close to the path."""
TURN_DEG: Final = 0.1
"""Reversals of the path by less than this, about a microstep, are ignored."""
REST_DEG: Final = 0.001
AT_REST_DEG_S: Final = 10.0
"""Lowest speed of a correction where the path rests."""
KEEP_S: Final = 1.0
"""At rest a target is repeated after this time, because a seat holds a robot only until 2 s after a motion."""
OFF_DEG: Final = 3.0
"""Largest allowed deviation of an arm from the path (deg)."""
_REST: Final = (0.0, 0.0, 0.0)


class TimedTarget(NamedTuple):
    """A query and its time: s from the start of the path, negative before the start."""

    t: float
    query: MotionQuery


@dataclass(frozen=True)
class Following:
    """A path with its targets; the targets and the motions between them have been checked."""

    path: ArmPath
    start: MotionQuery
    """the motion to the start of the path, at the default speed of the robot"""
    targets: tuple[TimedTarget, ...]
    planned: Floats
    """planned arm angles (n, 3) in deg, in steps of STEP_S from LEAD_IN_S before the start of the path"""
    fastest: float
    """the speed limit of an arm, deg/s"""
    off_deg: float
    """largest deviation of an arm from the path (deg)"""

    def at(self, t: float) -> Floats:
        """Return planned arm angles (deg) `t` seconds after the start of the path, interpolated linearly."""
        place = min(max(0.0, (t + LEAD_IN_S) / STEP_S), len(self.planned) - 1.0)
        before = int(place)
        after = min(before + 1, len(self.planned) - 1)
        part = place - before
        return np.asarray((1 - part) * self.planned[before] + part * self.planned[after], dtype=np.float64)


def robots_of(infos: Sequence[RobotInfo]) -> list[RobotData]:
    """Return the robot data to check a motion against: those of the first robot, and of the second if they differ."""
    checked = infos if len(infos) > 1 and unlike(*infos) else infos[:1]
    return [robot_of(info) for info in checked]


def follow(path: ArmPath, robot: RobotData) -> Following:
    """Plan the targets for a path, and check the whole motion.

    Raises:
        Refused: the motion exceeds a limit or the path is too fast; the message names line and time.
        WrongUsage: the path is too long.
    """
    path.check_length()
    limits = MotionLimits(robot)
    for t, arms in zip(path.t, path.arms, strict=True):
        with naming(path.where(float(t))):
            limits.check_pose([math.radians(angle) for angle in arms])
    targets, way = planned(path, limits)
    start = motion_query(*path.arms[0], relative=False, speed=None)
    times = np.arange(len(way), dtype=np.float64) * STEP_S - LEAD_IN_S
    off_deg = float(np.max(np.abs(way - path.at(times))))
    return Following(path, start, tuple(targets), way, math.degrees(limits.speed_max), off_deg)


def planned(path: ArmPath, limits: MotionLimits) -> tuple[list[TimedTarget], Floats]:
    """Return the targets, and the planned arm angles as in `Following.planned`.

    Raises the errors of `follow`.
    """
    grid = path.at(np.arange(-LEAD_IN_S, path.duration_s + AHEAD_S + LOOK_S + STEP_S, STEP_S))
    position: Arms = _radians(grid[0])
    velocity: Arms = _REST
    targets: list[TimedTarget] = []
    way: list[list[float]] = []
    every = round(TARGET_S / STEP_S)
    for at in range(0, round((LEAD_IN_S + path.duration_s) / STEP_S) + every, every):
        t = at * STEP_S - LEAD_IN_S
        goal, speed = _aim(grid[at:], position, velocity, limits)
        with naming(path.where(t)):
            trajectory = limits.check_motion(
                position, velocity, _radians(goal), _radians(speed), straight=False
            )
        query = motion_query(*goal, relative=False, speed=speed)
        new = not targets or query != targets[-1].query or velocity != _REST
        if new or t - targets[-1].t >= KEEP_S:
            targets.append(TimedTarget(t, query))
        for step in range(every):
            way.append([math.degrees(angle) for angle in trajectory.at(step * STEP_S)[0]])
            off = float(np.max(np.abs(np.array(way[-1]) - grid[min(at + step, len(grid) - 1)])))
            if off > OFF_DEG:
                raise Refused(Reason.SPEED_LIMIT, too_fast(path, limits, off, t + step * STEP_S))
        position, velocity = trajectory.at(TARGET_S)
    return targets, np.array(way, dtype=np.float64)


def _aim(
    coming: Floats, position: Arms, velocity: Arms, limits: MotionLimits
) -> tuple[list[float], list[float]]:
    """Return goal (deg) and speed (deg/s) of each arm; `coming`: the next part of the path (deg) in steps of STEP_S."""
    slowest, fastest = math.degrees(limits.speed_min), math.degrees(limits.speed_max)
    look = round(LOOK_S / STEP_S)
    goals, speeds = [], []
    for arm in range(3):
        here, speed_now = math.degrees(position[arm]), math.degrees(velocity[arm])
        way = float(coming[look, arm]) - here
        acceleration = math.degrees(limits.acceleration)
        wanted = speed_for(way, speed_now, acceleration)
        if float(np.ptp(coming[: look + 1, arm])) < REST_DEG:
            # Rounded, because otherwise every target would differ from the last, and be sent.
            goals.append(round(float(coming[look, arm]), 6))
            speeds.append(min(fastest, max(AT_REST_DEG_S, abs(wanted))))
            continue
        speed = min(fastest, max(slowest, abs(wanted)))
        enough = here + math.copysign(speed * LOOK_S + speed**2 / (2 * acceleration), wanted)
        goals.append(furthest(coming[: round(AHEAD_S / STEP_S) + 1, arm], math.copysign(1.0, wanted), enough))
        speeds.append(speed)
    return goals, speeds


def speed_for(way: float, now: float, acceleration: float) -> float:
    """Return the speed (deg/s) with which an arm at speed `now` (deg/s) covers the distance `way` (deg) in LOOK_S.

    With c the speed and r = |c - now| / a the time to reach it, the distance is c LOOK_S - (c - now) r / 2.
    """
    more = way - now * LOOK_S
    root = LOOK_S**2 - 2 * abs(more) / acceleration
    change = acceleration * (LOOK_S - math.sqrt(max(0.0, root)))
    return now + math.copysign(change, more)


def furthest(coming: Floats, sign: float, enough: float) -> float:
    """Return the furthest point (deg) before the path turns back, or the first point beyond `enough` (deg).

    `sign` is the direction in which the arm turns.
    """
    ahead = sign * coming
    # Leave out the path before a reversal within LOOK_S: it runs against `sign` and would end the search.
    ahead = ahead[int(np.argmin(ahead[: round(LOOK_S / STEP_S) + 1])) :]
    peak = np.maximum.accumulate(ahead)
    ends = np.flatnonzero((peak - ahead > TURN_DEG) | (ahead >= sign * enough))
    return sign * float(peak[ends[0] if len(ends) else -1])


def too_fast(path: ArmPath, limits: MotionLimits, off_deg: float, t: float) -> str:
    """Return the message for a path that is too fast: an arm would be `off_deg` (deg) off it at the time `t` (s)."""
    return (
        f"{path.where(t)}: the path is too fast. The arms would deviate by {off_deg:.1f}° from the path; "
        f"at most {OFF_DEG:g}° is allowed. They turn at {math.degrees(limits.speed_max):g}°/s at most, and "
        f"accelerate at {math.degrees(limits.acceleration):g}°/s². Give the path more time, with a --speed-factor below "
        f"{path.factor:g} or points further apart."
    )


def _radians(angles: Sequence[float] | Floats) -> Arms:
    x, y, z = (math.radians(float(angle)) for angle in angles)
    return x, y, z
