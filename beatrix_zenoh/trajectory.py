"""The firmware's time law in continuous form: per-arm trapezoids of speed that may start in motion."""

from __future__ import annotations

import itertools
import math
from bisect import bisect_right
from dataclasses import dataclass
from typing import Final, NamedTuple

from beatrix_zenoh.drive import Arms

_REST: Arms = (0.0, 0.0, 0.0)
_SHORTEST: Final = 1e-9
"""Sections shorter than this (s) are rounding."""
_SLOWEST_SHARE: Final = 1 / 16
"""An arm in motion always keeps this share of the speed, else one that only has to turn back might never arrive."""


class Section(NamedTuple):
    """Part of a trajectory with constant accelerations."""

    begin: float
    """s after the start"""
    duration: float
    """s"""
    arms: Arms
    """rad, at its begin"""
    velocity: Arms
    """rad/s, at its begin"""
    acceleration: Arms
    """rad/s2"""

    def at(self, t: float) -> tuple[Arms, Arms]:
        """Angles (rad) and velocities (rad/s) t seconds after its begin."""
        (x, y, z), (u, v, w), (a, b, c) = self.arms, self.velocity, self.acceleration
        h = t / 2
        velocity = (u + a * t, v + b * t, w + c * t)
        return (x + (u + velocity[0]) * h, y + (v + velocity[1]) * h, z + (w + velocity[2]) * h), velocity


@dataclass(frozen=True, slots=True)
class Trajectory:
    """Where the arms are at what time; before its start and after its end they rest where they are then."""

    sections: tuple[Section, ...]
    target: Arms
    """rad"""
    duration: float
    """s"""

    def at(self, t: float) -> tuple[Arms, Arms]:
        """Angles (rad) and velocities (rad/s) of the arms t seconds after the start."""
        if t >= self.duration:
            return self.target, _REST
        section = self.sections[max(0, bisect_right(self.sections, t, key=lambda section: section.begin) - 1)]
        return section.at(max(0.0, t - section.begin))


class _Piece(NamedTuple):
    begin: float
    position: float
    velocity: float
    acceleration: float


_Profile = tuple[_Piece, ...]


def plan(
    start: Arms, velocity: Arms, target: Arms, speed: Arms, acceleration: float, *, straight: bool
) -> Trajectory:
    """Trajectory from `start` (rad), moving with `velocity` (rad/s), to rest at `target` (rad).

    speed: top speed of each arm (rad/s), > 0. acceleration: rad/s2, > 0. An arm that cannot stop before its target
    stops behind it and turns back; one that is faster than its new top speed slows down to it.
    straight: speed[0] is that of the arm with most to do and the others are slowed in proportion; from rest the
    accelerations are as well, so that all start and arrive together on a straight line. In motion that is impossible,
    and every arm brakes and accelerates as fast as it may.
    """
    travel = tuple(b - a for a, b in zip(start, target, strict=True))
    longest = max(abs(way) for way in travel)
    if straight and longest and velocity == _REST:
        leader = _profile(0.0, 0.0, longest, speed[0], acceleration)
        shares = [way / longest for way in travel]
        profiles = [_scaled(leader, p, share) for p, share in zip(start, shares, strict=True)]
    else:
        if straight and longest:
            x, y, z = (speed[0] * max(_SLOWEST_SHARE, abs(way) / longest) for way in travel)
            speed = (x, y, z)
        axes = zip(start, velocity, target, speed, strict=True)
        profiles = [_profile(p, v, goal, top, acceleration) for p, v, goal, top in axes]
    sections = _sections(profiles)
    end = sections[-1].begin + sections[-1].duration if sections else 0.0
    return Trajectory(sections, target, end)


def _profile(start: float, velocity: float, target: float, speed: float, acceleration: float) -> _Profile:
    """Time-optimal way of one arm to rest at its target, with limited speed and acceleration.

    The sign of what would be left after braking decides the direction; with u the velocity and d the way in that
    direction the peak p follows from (p^2 - u^2) / 2a + p^2 / 2a = d, unless the speed limit cuts it off.
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
            pieces.append(_Piece(t, p, v, rate))
            t, p, v = t + duration, p + (v + rate * duration / 2) * duration, v + rate * duration
    return (*pieces, _Piece(t, target, 0.0, 0.0))


def _scaled(profile: _Profile, start: float, share: float) -> _Profile:
    return tuple(_Piece(t, start + share * p, share * v, share * a) for t, p, v, a in profile)


def _sections(profiles: list[_Profile]) -> tuple[Section, ...]:
    """The pieces of the three arms, cut where any of them changes its acceleration."""
    cuts = sorted({piece.begin for profile in profiles for piece in profile})
    cuts = [
        cut for cut, following in zip(cuts, [*cuts[1:], math.inf], strict=True) if following - cut > _SHORTEST
    ]
    sections = []
    for begin, end in itertools.pairwise(cuts):
        (p, u, a), (q, v, b), (r, w, c) = (_state(profile, begin) for profile in profiles)
        sections.append(Section(begin, end - begin, (p, q, r), (u, v, w), (a, b, c)))
    return tuple(sections)


def _state(profile: _Profile, t: float) -> tuple[float, float, float]:
    piece = profile[0]
    for following in profile[1:]:
        if following.begin > t + _SHORTEST:
            break
        piece = following
    since = t - piece.begin
    return (
        piece.position + (piece.velocity + piece.acceleration * since / 2) * since,
        piece.velocity + piece.acceleration * since,
        piece.acceleration,
    )
