"""The firmware's motion in continuous form: a trapezoidal speed profile for each arm, from any velocity to rest."""

from __future__ import annotations

import itertools
import math
from bisect import bisect_right
from functools import cached_property
from typing import Final, NamedTuple

import msgspec

from beatrix_zenoh.motion.gear import Arms

_REST: Arms = (0.0, 0.0, 0.0)
_SHORTEST: Final = 1e-9
"""Sections shorter than this (s) are rounding errors and are left out."""
_SLOWEST_SHARE: Final = 1 / 16
"""Lowest speed of an arm, as a share of speed[0], in a straight motion that begins while the arms move: an arm with a
short distance may have to reverse, and needs some speed to arrive."""


class Section(NamedTuple):
    """Part of a trajectory with constant accelerations."""

    begin: float
    """time (s) after the start of the trajectory"""
    duration: float
    """s"""
    arms: Arms
    """angles (rad) at `begin`"""
    velocity: Arms
    """velocities (rad/s) at `begin`"""
    acceleration: Arms
    """rad/s2"""

    def at(self, t: float) -> tuple[Arms, Arms]:
        """Return angles (rad) and velocities (rad/s) `t` seconds after `begin`."""
        (x, y, z), (u, v, w), (a, b, c) = self.arms, self.velocity, self.acceleration
        h = t / 2
        velocity = (u + a * t, v + b * t, w + c * t)
        return (x + (u + velocity[0]) * h, y + (v + velocity[1]) * h, z + (w + velocity[2]) * h), velocity


_Piece = tuple[float, float, float, float]
"""Begin, position, velocity and acceleration of one arm; a plain tuple, because a check of a path makes a dozen."""
_Profile = tuple[_Piece, ...]


class Trajectory(msgspec.Struct, frozen=True, dict=True):
    """Angles of the arms over time; after the end the arms rest."""

    start: Arms
    """rad"""
    target: Arms
    """rad"""
    profiles: tuple[_Profile, ...]
    """the motions of the arms"""

    @property
    def duration(self) -> float:
        """Time (s) until the arms rest."""
        return max(profile[-1][0] for profile in self.profiles)

    @property
    def lengths(self) -> Arms:
        """Lengths of the paths of the arms (rad)."""
        one, two, three = self.profiles
        return _length(one), _length(two), _length(three)

    @cached_property
    def sections(self) -> tuple[Section, ...]:
        """Parts in which all arms have constant accelerations. Computed when read: a short motion does not need them."""
        return _sections(self.profiles)

    def at(self, t: float) -> tuple[Arms, Arms]:
        """Return angles (rad) and velocities (rad/s) of the arms `t` seconds after the start."""
        if t >= self.duration or not self.sections:
            return self.target, _REST
        section = self.sections[max(0, bisect_right(self.sections, t, key=lambda section: section.begin) - 1)]
        return section.at(max(0.0, t - section.begin))


def shortest_s(way: float, speed: float, acceleration: float) -> float:
    """Return the shortest duration (s) of a motion of one arm from rest to rest over `way` (rad or deg, >= 0).

    speed: top speed, > 0; acceleration: > 0; both with the unit of `way`.
    """
    if way * acceleration > speed * speed:
        return way / speed + speed / acceleration
    return 2 * math.sqrt(way / acceleration)


def speed_for(way: float, duration: float, acceleration: float) -> float:
    """Return the top speed with which one arm needs `duration` (s) from rest to rest over `way` (rad or deg, >= 0).

    If the duration is too short even without a top speed, return the highest speed that the arm reaches.
    """
    gained = acceleration * duration
    return 0.5 * (gained - math.sqrt(max(0.0, gained * gained - 4 * acceleration * way)))


def plan(
    start: Arms, velocity: Arms, target: Arms, speed: Arms, acceleration: float, *, straight: bool
) -> Trajectory:
    """Return the trajectory of arms from `start` (rad), where they have `velocity` (rad/s), to rest at `target` (rad).

    speed: top speed of each arm (rad/s), > 0. acceleration: rad/s2, > 0. An arm that cannot stop before its target
    stops beyond it and returns; an arm above its new top speed slows down to it.
    straight: speed[0] is the speed of the arm with the longest distance; the other arms are slower in proportion to
    their distances. From rest their accelerations are lower in the same proportion, so that all arms start and arrive
    together on a straight line. Arms that move at the start cannot stay on a line: each of them brakes and accelerates
    with `acceleration`.
    """
    travel = (target[0] - start[0], target[1] - start[1], target[2] - start[2])
    longest = max(map(abs, travel))
    if straight and longest and velocity == _REST:
        leader = _profile(0.0, 0.0, longest, speed[0], acceleration)
        shares = zip(start, (way / longest for way in travel), strict=True)
        profiles = (
            tuple((t, arm + share * p, share * v, share * rate) for t, p, v, rate in leader)
            for arm, share in shares
        )
        return Trajectory(start, target, tuple(profiles))
    if straight and longest:
        x, y, z = (speed[0] * max(_SLOWEST_SHARE, abs(way) / longest) for way in travel)
        speed = (x, y, z)
    axes = zip(start, velocity, target, speed, strict=True)
    return Trajectory(
        start, target, tuple(_profile(p, v, goal, top, acceleration) for p, v, goal, top in axes)
    )


def _profile(start: float, velocity: float, target: float, speed: float, acceleration: float) -> _Profile:
    """Return the time-optimal motion of one arm to rest at its target, with limited speed and acceleration.

    The sign of the remaining distance after braking gives the direction; with u the velocity and d the distance in that
    direction the peak velocity p follows from (p^2 - u^2) / 2a + p^2 / 2a = d, unless the limit `speed` is lower.
    """
    left = target - start - velocity * abs(velocity) / (2 * acceleration)
    sign = math.copysign(1.0, left)
    u, way = sign * velocity, sign * (target - start)
    peak = min(speed, math.sqrt(max(0.0, acceleration * way + u * u / 2)))
    first = abs(peak - u) / acceleration
    ramp = math.copysign(acceleration, peak - u)
    cruise = 0.0
    if peak == speed:
        cruise = max(0.0, way - (u + peak) / 2 * first - peak * peak / (2 * acceleration)) / peak
    pieces = []
    t, p, v = 0.0, start, velocity
    for duration, rate in ((first, sign * ramp), (cruise, 0.0), (peak / acceleration, -sign * acceleration)):
        if duration > 0:
            pieces.append((t, p, v, rate))
            t, p, v = t + duration, p + (v + rate * duration / 2) * duration, v + rate * duration
    return (*pieces, (t, target, 0.0, 0.0))


def _length(profile: _Profile) -> float:
    """Return the length of the path of one arm (rad), or a little more."""
    way = 0.0
    for (begin, _, velocity, rate), (end, *_) in itertools.pairwise(profile):
        way += (end - begin) * max(abs(velocity), abs(velocity + rate * (end - begin)))
    return way


def _sections(profiles: tuple[_Profile, ...]) -> tuple[Section, ...]:
    """Return sections in which all three arms have constant acceleration."""
    cuts = sorted({piece[0] for profile in profiles for piece in profile})
    cuts = [
        cut for cut, following in zip(cuts, [*cuts[1:], math.inf], strict=True) if following - cut > _SHORTEST
    ]
    one, two, three = profiles
    sections = []
    for begin, end in itertools.pairwise(cuts):
        (p, u, a), (q, v, b), (r, w, c) = _state(one, begin), _state(two, begin), _state(three, begin)
        sections.append(Section(begin, end - begin, (p, q, r), (u, v, w), (a, b, c)))
    return tuple(sections)


def _state(profile: _Profile, t: float) -> tuple[float, float, float]:
    latest = t + _SHORTEST
    piece = profile[0]
    for following in profile:
        if following[0] > latest:
            break
        piece = following
    begin, position, velocity, acceleration = piece
    since = t - begin
    return (
        position + (velocity + acceleration * since / 2) * since,
        velocity + acceleration * since,
        acceleration,
    )


_LEAST_SHARE = 0.01
"""Lowest speed of an arm that hardly moves, as a share of the speed of the arm with the longest distance."""


class PlannedMotion(msgspec.Struct, frozen=True):
    """Start, velocity at the start, goal and top speeds of a motion, in rad and rad/s.

    `straight` has the meaning of the argument of `trajectory.plan`.
    """

    start: Arms
    velocity: Arms
    target: Arms
    speed: Arms
    straight: bool

    def trajectory(self, acceleration: float) -> Trajectory:
        """Return the trajectory that the firmware would follow with this acceleration (rad/s2)."""
        return plan(self.start, self.velocity, self.target, self.speed, acceleration, straight=self.straight)

    def proportional_speed(self) -> Arms:
        """Return speeds (rad/s) with which the arms arrive at about the same time; no arm becomes faster."""
        travel = [abs(b - a) for a, b in zip(self.start, self.target, strict=True)]
        longest = max(*travel, 1e-9)
        x, y, z = (min(self.speed) * max(_LEAST_SHARE, way / longest) for way in travel)
        return x, y, z
