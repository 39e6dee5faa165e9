"""Walk along a trajectory and find out whether it keeps its bounds everywhere, not only where one looks.

Six margins must not become negative: one of tilt, two of yaw, three of gaps. At each point the walk knows them and their
derivatives by the arms, and for a displacement d of the arms (Taylor)

    margin(arms + d) >= margin + gradient . d - curvature / 2 * |d'|^2

where d' is d without the common turn of the arms (which changes neither tilt nor gaps, and yaw linearly). So it may go
on as far as the right side stays positive. The bound holds for everything between the two points, because it could
only fail where the head is already outside, and the way there would have to cross it. Far from limits a step is long,
along a limit it shrinks with the square root of the slack.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final, NamedTuple

from beatrix_zenoh.drive import Arms
from beatrix_zenoh.errors import BeatrixError
from beatrix_zenoh.kinematics import Neck
from beatrix_zenoh.rotation import dot, leaning
from beatrix_zenoh.trajectory import Trajectory

TOLERANCE: Final = math.radians(0.1)
"""A value counts as beyond its limit from half of this (rad), and the walk guarantees that no motion is beyond by more
(a stream of motions, each begun while the one before is just beyond: by a third more).

Arms stand on microsteps, so what was asked at a limit is up to half a step (0.045 deg) beyond it when it is read back.
"""
_ROUNDING: Final = 1e-9
_STRIDE_OUTSIDE: Final = 0.02
"""Longest step (rad of |d'|) where the curvature is not known, because a limit is already exceeded."""
_SHORTEST: Final = 1e-6
"""Shortest step (s): never needed, for the slack is worth more, but it ends every walk."""
BEYOND: Final = math.radians(2.0)
"""Curvature is known this far beyond the tilt limit (rad), but for the last bit before a rod is stretched."""
_SHORT_OF_REACH: Final = math.radians(0.5)
_CAUTION: Final = 1.5
"""Curvature is sampled; between the samples it may be larger by this factor."""
_LEVELS: Final = 6
_DIRECTIONS: Final = 12
_PROBE: Final = 1e-4
_PLANE: Final = (
    (1 / math.sqrt(2), -1 / math.sqrt(2), 0.0),
    (1 / math.sqrt(6), 1 / math.sqrt(6), -2 / math.sqrt(6)),
)
"""Two directions without a common turn, at right angles."""
TILT, GAP = 0, 3
"""Index of the margins; between them two of yaw, from GAP on three gaps."""

Margins = tuple[float, float, float, float, float, float]


class Limit(NamedTuple):
    """Bounds of the neck (rad)."""

    tilt_max: float
    yaw_max: float
    gap_min: float


class Point(NamedTuple):
    """Where the head is at one point of the way."""

    values: Margins
    """cos(tilt), -yaw, yaw, three gaps: all must stay above a bound"""
    gradients: tuple[Arms, Arms, Arms, Arms, Arms, Arms]
    """of the values by the arms"""


@dataclass(frozen=True, slots=True)
class Breach:
    """Where a way leaves its bounds first."""

    index: int
    """of the margin; TILT as well if the arms fit no head"""
    t: float
    """s after the start"""
    arms: Arms
    """rad"""


class Walker:
    """Checks trajectories of one neck against fixed limits."""

    def __init__(self, neck: Neck, limit: Limit) -> None:
        self._neck = neck
        up_min, half = math.cos(limit.tilt_max), TOLERANCE / 2
        up_slack = (up_min - math.cos(limit.tilt_max + TOLERANCE)) / 2
        self._slack: Margins = (up_slack, half, half, half, half, half)
        yaw, gap = -limit.yaw_max - half, limit.gap_min - half
        self._ends: Margins = (up_min - up_slack, yaw, yaw, gap, gap, gap)
        self._up_known = math.cos(limit.tilt_max + BEYOND)
        up_bend, yaw_bend = _curvature(neck, looked_at(neck, limit.tilt_max))
        self._curvature: Margins = (up_bend, yaw_bend, yaw_bend, 0.0, 0.0, 0.0)
        self._gap_by = _gap_gradients(neck)

    def point(self, arms: Arms) -> Point:
        """The head at these arms; raises BeatrixError if none fits."""
        head = self._neck.head(arms)
        x, y, z = head.yaw_by_arm
        return Point(
            (head.up, -head.yaw, head.yaw, *self._neck.gaps(arms)),
            (head.up_by_arm, (-x, -y, -z), head.yaw_by_arm, *self._gap_by),
        )

    def beyond(self, arms: Arms) -> list[int]:
        """Indices of the limits that a head resting there exceeds; TILT as well if no head fits the arms."""
        try:
            values = self.point(arms).values
        except BeatrixError:
            values = (-math.inf, math.inf, math.inf, *self._neck.gaps(arms))
        pairs = zip(values, self._ends, strict=True)
        return [i for i, (value, end) in enumerate(pairs) if value < end - _ROUNDING]

    def walk(self, trajectory: Trajectory) -> Breach | None:
        """Where the way first leaves its bounds; None if it keeps them.

        Where the start already exceeds a limit, the way must not exceed it more than it did before: it leads back.
        Raises BeatrixError if no head fits the arms at the start.
        """
        start = trajectory.sections[0].arms if trajectory.sections else trajectory.target
        point = self.point(start)
        way = _Way(point, self._ends)
        if self._stays_near(way, point, trajectory):
            return None
        for section in trajectory.sections:
            since = 0.0
            while section.duration - since > _ROUNDING:
                arms, velocity = section.at(since)
                met = self._visit(way, arms)
                if isinstance(met, int):
                    return Breach(met, section.begin + since, arms)
                since += self._stride(way, met, velocity, section.acceleration, section.duration - since)
        met = self._visit(way, trajectory.target)
        return Breach(met, trajectory.duration, trajectory.target) if isinstance(met, int) else None

    def _stays_near(self, way: _Way, start: Point, trajectory: Trajectory) -> bool:
        """The way is so short that no margin can be used up on it: streams of targets are judged by one look."""
        x, y, z = _lengths(trajectory)
        square = x * x + y * y + z * z
        for value, floor, (a, b, c), bend in zip(
            start.values, way.floors, start.gradients, self._curvature, strict=True
        ):
            if value - floor < abs(a) * x + abs(b) * y + abs(c) * z + bend / 2 * square:
                return False
        return True

    def _visit(self, way: _Way, arms: Arms) -> Point | int:
        try:
            point = self.point(arms)
        except BeatrixError:
            return TILT
        index = way.visit(point)
        return point if index is None else index

    def _stride(self, way: _Way, point: Point, velocity: Arms, acceleration: Arms, left: float) -> float:
        """Time (s) for which no margin can be used up."""
        stride, speed, rate = left, _level(velocity), _level(acceleration)
        if point.values[TILT] <= self._up_known:
            pace = speed + math.sqrt(speed * speed + 2 * _STRIDE_OUTSIDE * rate)
            stride = min(left, 2 * _STRIDE_OUTSIDE / pace) if pace else left
        for index, by in enumerate(point.gradients):
            first, second = dot(by, velocity), dot(by, acceleration)
            room = point.values[index] - way.floors[index] + self._slack[index]
            bend = self._curvature[index] / 2
            while stride > _SHORTEST:
                length = (speed + rate * stride / 2) * stride
                if room + _lowest(first, second, stride) >= bend * length * length:
                    break
                stride /= 2
        return stride


class _Way:
    """What a walk must not fall below."""

    def __init__(self, start: Point, ends: Margins) -> None:
        self._ends = ends
        self.floors = [min(end, value) for end, value in zip(ends, start.values, strict=True)]

    def visit(self, point: Point) -> int | None:
        """Index of a margin that is used up here; else a start outside its bounds is left behind for good."""
        for index, value in enumerate(point.values):
            floor = self.floors[index]
            if value < floor - _ROUNDING:
                return index
            if floor < self._ends[index]:
                self.floors[index] = min(self._ends[index], max(floor, value))
        return None


def _lengths(trajectory: Trajectory) -> Arms:
    """What no arm's way is longer than, rad."""
    x = y = z = 0.0
    for section in trajectory.sections:
        t, (u, v, w), (a, b, c) = section.duration, section.velocity, section.acceleration
        x += t * max(abs(u), abs(u + a * t))
        y += t * max(abs(v), abs(v + b * t))
        z += t * max(abs(w), abs(w + c * t))
    return x, y, z


def _level(vector: Arms) -> float:
    """Length without the common turn."""
    x, y, z = vector
    mean = (x + y + z) / 3
    x, y, z = x - mean, y - mean, z - mean
    return math.sqrt(x * x + y * y + z * z)


def _lowest(first: float, second: float, duration: float) -> float:
    """Least of first * t + second / 2 * t^2 for t from 0 to duration."""
    end = (first + second * duration / 2) * duration
    if first < 0 < first + second * duration:
        end = -first * first / (2 * second)
    return min(0.0, end)


def _gap_gradients(neck: Neck) -> tuple[Arms, Arms, Arms]:
    home = neck.gaps((0.0, 0.0, 0.0))
    by_x, by_y, by_z = (
        tuple(moved - gap for moved, gap in zip(neck.gaps(unit), home, strict=True))
        for unit in ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    )
    first, second, third = zip(by_x, by_y, by_z, strict=True)
    return first, second, third


def looked_at(neck: Neck, tilt_max: float) -> float:
    """To what tilt (rad) the check of motions knows the neck, if its head may tilt by `tilt_max` (rad)."""
    return min(tilt_max + BEYOND, neck.reach - _SHORT_OF_REACH)


def _curvature(neck: Neck, tilt_max: float) -> tuple[float, float]:
    """Bounds of the second derivatives of cos(tilt) and yaw by |d'|, for tilts up to tilt_max (rad)."""
    up = yaw = 0.0
    for level in range(_LEVELS + 1):
        tilt = tilt_max * level / _LEVELS
        for direction in range(_DIRECTIONS):
            angle = math.tau * direction / _DIRECTIONS
            one, other = _bend(neck, neck.inverse(0.0, *leaning(tilt, angle)))
            up, yaw = max(up, one), max(yaw, other)
    return _CAUTION * up, _CAUTION * yaw


def _bend(neck: Neck, arms: Arms) -> tuple[float, float]:
    """Norms of the second derivatives of cos(tilt) and yaw at one pose, by central differences."""
    up = yaw = 0.0
    for x, y, z in _PLANE:
        ahead = neck.head((arms[0] + _PROBE * x, arms[1] + _PROBE * y, arms[2] + _PROBE * z))
        behind = neck.head((arms[0] - _PROBE * x, arms[1] - _PROBE * y, arms[2] - _PROBE * z))
        for side in _PLANE:
            up += (dot(side, ahead.up_by_arm) - dot(side, behind.up_by_arm)) ** 2
            yaw += (dot(side, ahead.yaw_by_arm) - dot(side, behind.yaw_by_arm)) ** 2
    return math.sqrt(up) / (2 * _PROBE), math.sqrt(yaw) / (2 * _PROBE)
