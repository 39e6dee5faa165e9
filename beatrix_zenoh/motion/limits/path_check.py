"""Check a trajectory against the limits everywhere, not only at sampled points.

Six margins must not become negative: one of tilt, two of yaw, three of gaps. At each point the check computes them and
their derivatives by the arms. For a displacement d of the arms Taylor's theorem gives

    margin(arms + d) >= margin + gradient . d - curvature / 2 * |d'|^2

where d' is d without the common turn of the arms (which changes neither tilt nor gaps, and yaw linearly). The check
advances as long as the right side stays positive. The inequality is true for the whole step: it can fail only outside
the limits, where `curvature` is not known, and the path cannot get there while the right side is positive. Steps are
long far from limits; along a limit they shrink with the square root of the margin.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, NamedTuple

from beatrix_zenoh.contract.errors import BeatrixError
from beatrix_zenoh.motion.gear import Arms
from beatrix_zenoh.motion.kinematics import Neck
from beatrix_zenoh.motion.rotation import dot, leaning
from beatrix_zenoh.motion.trajectory import Trajectory

TOLERANCE: Final = math.radians(0.1)
"""Largest excess (rad) over a limit between the points of the check; at a point the check reports half as much.

In a stream of motions, each begun while the previous one is just beyond a limit, the excess may be a third larger.
Arms stop on whole microsteps, so a goal at a limit is up to half a step (0.045 deg) beyond it when it is read back.
"""
_ROUNDING: Final = 1e-9
_STEP_OUTSIDE: Final = 0.02
"""Longest step (rad of |d'|) where the curvature is not known: well beyond the tilt limit."""
_SHORTEST: Final = 1e-6
"""Shortest step (s), so that every check ends. The tolerance is so wide that the check needs no shorter step."""
TILT_KNOWN_BEYOND: Final = math.radians(2.0)
"""The curvature is known this far beyond the tilt limit (rad), except close to a stretched rod."""
_SHORT_OF_REACH: Final = math.radians(0.5)
_CAUTION: Final = 1.5
"""Safety factor for the curvature between its samples."""
_LEVELS: Final = 6
_DIRECTIONS: Final = 12
_PROBE: Final = 1e-4
_PLANE: Final = (
    (1 / math.sqrt(2), -1 / math.sqrt(2), 0.0),
    (1 / math.sqrt(6), 1 / math.sqrt(6), -2 / math.sqrt(6)),
)
"""Two directions without a common turn, at right angles."""
TILT, YAW, GAP = 0, 1, 3
"""Indices of the margins: one of tilt, two of yaw, three of gaps."""

Margins = tuple[float, float, float, float, float, float]


class Bounds(NamedTuple):
    """Bounds of the neck (rad)."""

    tilt_max: float
    yaw_max: float
    gap_min: float


class Clearance(NamedTuple):
    """Margins to the limits at one position of the arms, and the derivatives of the margins."""

    values: Margins
    """cos(tilt), -yaw, yaw, three gaps: all must stay above a bound"""
    gradients: tuple[Arms, Arms, Arms, Arms, Arms, Arms]
    """derivatives of the values by the arm angles"""


@dataclass(frozen=True, slots=True)
class Violation:
    """The first point of a trajectory at which a limit is exceeded."""

    index: int
    """index of the margin; TILT if no head orientation is possible"""
    t: float
    """time (s) after the start"""
    arms: Arms
    """rad"""


class PathChecker:
    """Checks trajectories of one neck against fixed limits."""

    def __init__(self, neck: Neck, bounds: Bounds) -> None:
        self.neck, self.bounds = neck, bounds
        up_min, half = math.cos(bounds.tilt_max), TOLERANCE / 2
        up_slack = (up_min - math.cos(bounds.tilt_max + TOLERANCE)) / 2
        self._slack: Margins = (up_slack, half, half, half, half, half)
        yaw, gap = -bounds.yaw_max - half, bounds.gap_min - half
        self._ends: Margins = (up_min - up_slack, yaw, yaw, gap, gap, gap)
        self._up_known = math.cos(bounds.tilt_max + TILT_KNOWN_BEYOND)
        up_bend, yaw_bend = _curvature(neck, known_tilt(neck, bounds.tilt_max))
        self._curvature: Margins = (up_bend, yaw_bend, yaw_bend, 0.0, 0.0, 0.0)
        self._gap_by = _gap_gradients(neck)
        self._last: tuple[Arms, Clearance] | None = None
        """The last position whose clearance was computed."""

    def clearance(self, arms: Arms) -> Clearance:
        """Return the margins at these arm angles (rad); raises BeatrixError if no head orientation is possible."""
        head = self.neck.head(arms)
        x, y, z = head.yaw_by_arm
        return Clearance(
            (head.up, -head.yaw, head.yaw, *self.neck.gaps(arms)),
            (head.up_by_arm, (-x, -y, -z), head.yaw_by_arm, *self._gap_by),
        )

    def exceeded(self, arms: Arms, start: Arms | None = None) -> list[int]:
        """Return the indices of the limits that a head at rest exceeds; includes TILT if no orientation is possible.

        start: rad; a limit that is exceeded at the start counts only if it is exceeded by more.
        """
        floors = self._ends if start is None else tuple(map(min, self._ends, self._values(start)))
        pairs = zip(self._values(arms), floors, strict=True)
        return [i for i, (value, floor) in enumerate(pairs) if value < floor - _ROUNDING]

    def _values(self, arms: Arms) -> Margins:
        try:
            return self.clearance(arms).values
        except BeatrixError:
            return (-math.inf, math.inf, math.inf, *self.neck.gaps(arms))

    def first_violation(self, trajectory: Trajectory) -> Violation | None:
        """Return the first violation of a limit, None if the trajectory keeps all limits.

        A limit that is exceeded at the start must not be exceeded by more: the motion may only lead back.
        Raises BeatrixError if no head orientation is possible at the start.
        """
        last = self._last
        if last is not None and self._has_room(last[1], self._ends, last[0], trajectory):
            return None
        clearance = self.clearance(trajectory.start)
        self._last = trajectory.start, clearance
        floors = _Floors(clearance, self._ends)
        if self._has_room(clearance, floors.values, trajectory.start, trajectory):
            return None
        first: Clearance | None = clearance  # at the start, which exceeds no floor
        for section in trajectory.sections:
            since = 0.0
            while section.duration - since > _ROUNDING:
                arms, velocity = section.at(since)
                found = first or self._visit(floors, arms)
                first = None
                if isinstance(found, int):
                    return Violation(found, section.begin + since, arms)
                since += self._step(floors, found, velocity, section.acceleration, section.duration - since)
        found = self._visit(floors, trajectory.target)
        return Violation(found, trajectory.duration, trajectory.target) if isinstance(found, int) else None

    def _has_room(
        self, there: Clearance, floors: Sequence[float], arms: Arms, trajectory: Trajectory
    ) -> bool:
        """Return whether all margins at `arms` (rad) suffice for the way to the start and the whole path.

        In a stream of targets most motions then need no evaluation, and the others one.
        """
        (a, b, c), (x, y, z), (u, v, w) = arms, trajectory.start, trajectory.lengths
        x, y, z = abs(x - a) + u, abs(y - b) + v, abs(z - c) + w
        square = x * x + y * y + z * z
        for value, floor, (a, b, c), bend in zip(
            there.values, floors, there.gradients, self._curvature, strict=True
        ):
            if not value - floor >= abs(a) * x + abs(b) * y + abs(c) * z + bend / 2 * square:
                return False
        return True

    def _visit(self, floors: _Floors, arms: Arms) -> Clearance | int:
        try:
            clearance = self.clearance(arms)
        except BeatrixError:
            return TILT
        index = floors.first_used_up(clearance)
        return clearance if index is None else index

    def _step(
        self, floors: _Floors, here: Clearance, velocity: Arms, acceleration: Arms, left: float
    ) -> float:
        """Return a time (s) within which no margin can be used up."""
        step, speed, rate = left, _level(velocity), _level(acceleration)
        if here.values[TILT] <= self._up_known:
            pace = speed + math.sqrt(speed * speed + 2 * _STEP_OUTSIDE * rate)
            step = min(left, 2 * _STEP_OUTSIDE / pace) if pace else left
        for index, by in enumerate(here.gradients):
            first, second = dot(by, velocity), dot(by, acceleration)
            room = here.values[index] - floors.values[index] + self._slack[index]
            bend = self._curvature[index] / 2
            while step > _SHORTEST:
                length = (speed + rate * step / 2) * step
                if room + _lowest(first, second, step) >= bend * length * length:
                    break
                step /= 2
        return step


class _Floors:
    """The values that the margins of a motion must not fall below."""

    def __init__(self, start: Clearance, ends: Margins) -> None:
        self._ends = ends
        self.values = [min(end, value) for end, value in zip(ends, start.values, strict=True)]

    def first_used_up(self, clearance: Clearance) -> int | None:
        """Return the index of a margin that is used up here, or None.

        A motion may start outside the limits, where STOP or a push has left the arms, to lead back inside. Each margin
        that it gains becomes its floor, so that it cannot go back outside.
        """
        for index, value in enumerate(clearance.values):
            floor = self.values[index]
            if value < floor - _ROUNDING:
                return index
            if floor < self._ends[index]:
                self.values[index] = min(self._ends[index], max(floor, value))
        return None


def _level(vector: Arms) -> float:
    """Return the length of a vector of arm values without their common part."""
    x, y, z = vector
    mean = (x + y + z) / 3
    x, y, z = x - mean, y - mean, z - mean
    return math.sqrt(x * x + y * y + z * z)


def _lowest(first: float, second: float, duration: float) -> float:
    """Return the smallest value of first * t + second / 2 * t^2 for t from 0 to `duration`."""
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


def known_tilt(neck: Neck, tilt_max: float) -> float:
    """Return the tilt (rad) up to which the check computes the curvature; `tilt_max`: tilt limit (rad)."""
    return min(tilt_max + TILT_KNOWN_BEYOND, neck.reach - _SHORT_OF_REACH)


def _curvature(neck: Neck, tilt_max: float) -> tuple[float, float]:
    """Return bounds of the second derivatives of cos(tilt) and yaw by |d'|, for tilts up to tilt_max (rad)."""
    up = yaw = 0.0
    for level in range(_LEVELS + 1):
        tilt = tilt_max * level / _LEVELS
        for direction in range(_DIRECTIONS):
            angle = math.tau * direction / _DIRECTIONS
            one, other = _bend(neck, neck.inverse(0.0, *leaning(tilt, angle)))
            up, yaw = max(up, one), max(yaw, other)
    return _CAUTION * up, _CAUTION * yaw


def _bend(neck: Neck, arms: Arms) -> tuple[float, float]:
    """Return the norms of the second derivatives of cos(tilt) and yaw at one pose, by central differences."""
    up = yaw = 0.0
    for x, y, z in _PLANE:
        ahead = neck.head((arms[0] + _PROBE * x, arms[1] + _PROBE * y, arms[2] + _PROBE * z))
        behind = neck.head((arms[0] - _PROBE * x, arms[1] - _PROBE * y, arms[2] - _PROBE * z))
        for side in _PLANE:
            up += (dot(side, ahead.up_by_arm) - dot(side, behind.up_by_arm)) ** 2
            yaw += (dot(side, ahead.yaw_by_arm) - dot(side, behind.yaw_by_arm)) ** 2
    return math.sqrt(up) / (2 * _PROBE), math.sqrt(yaw) / (2 * _PROBE)
