"""The motions of two robots, each with its lead and its lag, and the time of the second that belongs to the first.

Motions are matched by their requests, or by their movement if the requests were not recorded. All times are in s.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.names import ARMS
from beatrix_zenoh.recording.motion_shifts import (
    AROUND_S,
    FAR_S,
    MovedPart,
    measured,
)
from beatrix_zenoh.recording.requests import MOVED, Alone, MotionRequest, Shared, alone, pairs, shared
from beatrix_zenoh.recording.series import GRID_S, Flags, Floats, Recording, resample, resting, runs

BEFORE_S = 0.3
"""A movement may be seen this long after its request, and a request this long after the movement: clocks are read in
slices of 20 ms, and robots begin slowly."""
BEGUN_S = 10.0
"""A movement that already runs when the recording begins may have been requested this much earlier."""
BEGUN = "it began before the recording, so its lead is not known"
CHANGED_S = 0.1
"""If the shift of the requests changes by more than this, a new motion begins."""
TOGETHER_DEG = 1.0
"""Robots at rest whose arms differ by less than this stand together again."""

Interval = tuple[float, float]


@dataclass(frozen=True)
class Alignment:
    """Which time of the second robot belongs to which time of the first."""

    parts: tuple[MovedPart, ...]
    apart: tuple[Interval, ...]
    """times of the first in which the robots were not asked for the same movement"""
    alone: tuple[Alone, ...]
    """motions that one of the robots did not make, or did not carry out to the end"""
    shift_s: float
    """shift where there are no motions"""

    def second_s(self, t: Floats) -> Floats:
        """Return the times of the second that belong to times of the first."""
        if not self.parts:
            return t + self.shift_s
        firsts = np.array([time for part in self.parts for time in (part.begin_s, part.end_s)])
        shifts = np.array([part.shift_s for part in self.parts for _ in range(2)])
        seconds = np.maximum.accumulate(firsts + shifts)
        inner = np.interp(t, firsts, seconds)
        inner = np.where(t < firsts[0], t + shifts[0], inner)
        return np.asarray(np.where(t > firsts[-1], t + seconds[-1] - firsts[-1], inner), dtype=np.float64)

    def comparable(self, t: Floats) -> Flags:
        """Return at which times of the first both robots were asked for the same movement."""
        flags = np.ones(len(t), dtype=np.bool_)
        for begin_s, end_s in self.apart:
            flags &= (t < begin_s) | (t > end_s)
        return flags


def aligned(first: Recording, second: Recording) -> Alignment:
    """Match the motions of both robots and measure the shift of each."""
    ways = movements(first), movements(second)
    asked, answered = requested(first, second, ways)
    span = float(first.t[0]), float(min(first.t[-1], second.t[-1]))
    both = pairs(asked, answered, *span)
    matched = shared(both)
    single = list(alone(both, span[1]))
    ways = (
        parted(ways[0], [each.t for each in single if not each.hardware]),
        parted(ways[1], [each.t for each in single if each.hardware]),
    )
    expected = of_requests(ways[0], matched)
    expected = [replace(motion, begin_s=max(motion.begin_s, span[0])) for motion in expected]
    parts = tuple(measured(first, second, motion) for motion in expected)
    known = [part.shift_s for part in parts if not part.why and not part.lead_s]
    shift_s = float(np.median(known)) if known else 0.0
    plain = Alignment(parts, (), (*single, *ended_early(matched)), shift_s)
    left_out = tuple(apart(first, second, plain, ways, matched))
    kept = tuple(
        part for part in parts if not any(begin_s <= part.begin_s < end_s for begin_s, end_s in left_out)
    )
    return replace(plain, parts=kept, apart=left_out)


def requested(
    first: Recording, second: Recording, ways: tuple[Sequence[Interval], Sequence[Interval]]
) -> tuple[list[MotionRequest], list[MotionRequest]]:
    """Return the requests during both recordings, also one for each movement without any: by number, or by time.

    A simulation that moves with the hardware although no request reached it follows: both have moved without a request.
    """
    asked, answered = within(first), within(second)
    unasked = [way for way in ways[0] if not caused(way, asked)]
    answered = [
        each
        for each in answered
        if each.refused or each.lead_s is not None or not any(contains(way, each.t) for way in unasked)
    ]
    unanswered = [way for way in ways[1] if not caused(way, answered)]
    numbered = len(unasked) == len(unanswered)
    asked += [moved(first, way, i * numbered) for i, way in enumerate(unasked)]
    answered += [moved(second, way, i * numbered) for i, way in enumerate(unanswered)]
    return sorted(asked, key=lambda each: each.t), sorted(answered, key=lambda each: each.t)


def within(recorded: Recording) -> list[MotionRequest]:
    """Return the requests during a recording, and those before and after it that belong to them."""
    return [
        request
        for request in recorded.requests
        if recorded.t[0] - BEGUN_S <= request.t <= recorded.t[-1] + FAR_S
    ]


def caused(way: Interval, requests: Sequence[MotionRequest]) -> bool:
    """Return whether a request may have caused, or changed, a movement."""
    return any(not each.refused and contains(way, each.t) for each in requests)


def moved(recorded: Recording, way: Interval, number: int) -> MotionRequest:
    """Return a request for a movement without one, which only a movement of the same number can answer."""
    return MotionRequest(max(way[0], float(recorded.t[0])), f"{MOVED} {number}", "")


def movements(recorded: Recording) -> list[Interval]:
    """Return begin and end of each movement of a robot; one that runs at the begin began up to BEGUN_S before it."""
    t = np.arange(recorded.t[0], recorded.t[-1], GRID_S)
    return [
        (float(t[begin]) - (0.0 if begin else BEGUN_S), float(t[end - 1]))
        for begin, end in runs(~resting(resample(recorded, t)))
    ]


def parted(ways: Sequence[Interval], times: Sequence[float]) -> list[Interval]:
    """Return movements, divided where a request to one robot alone (s) changed them."""
    edges = [[way[0], *sorted(t for t in times if way[0] + BEFORE_S < t < way[1]), way[1]] for way in ways]
    return [pair for each in edges for pair in itertools.pairwise(each)]


def of_requests(ways: Sequence[Interval], matched: Sequence[Shared]) -> list[MovedPart]:
    """Return the motions of the first robot that both were asked for; a movement of many requests is one motion."""
    found: list[MovedPart] = []
    for way in ways:
        asked = [motion for motion in matched if contains(way, motion.first.t)]
        begin_s, group = way[0], asked[:1]
        for motion in asked[1:]:
            if abs(shift(motion) - shift(group[0])) > CHANGED_S:
                found.append(of_group(begin_s, motion.first.t, group))
                begin_s, group = motion.first.t, []
            group.append(motion)
        if group:
            found.append(of_group(begin_s, way[1], group))
    return found


def of_group(begin_s: float, end_s: float, group: Sequence[Shared]) -> MovedPart:
    """Return the motion of requests with almost equal shifts."""
    shift_s = float(np.median([shift(motion) for motion in group]))
    without = group[0].sim.unrecorded
    begun = without and begin_s < group[0].sim.t
    unknown = BEGUN if begun else "" if without else separate(group, shift_s)
    return MovedPart(begin_s, end_s, group[0].lead_s, shift_s, why=unknown, single=len(group) == 1)


def separate(group: Sequence[Shared], pause_s: float) -> str:
    """Return a sentence if a person or a program asked one robot after the other; empty if both were asked together.

    Requests to both carry a lead, 0 included, so that the pause between two requests without it is no lag.
    """
    together = all(None not in (motion.lead_s, motion.hw.lead_s) for motion in group)
    if together or abs(pause_s) <= CHANGED_S:
        return ""
    return f"the robots were asked separately, {abs(pause_s):.1f} s apart"


def shift(motion: Shared) -> float:
    """Return the time of the request to the second minus that to the first."""
    return motion.hw.t - motion.first.t


def contains(way: Interval, t: float) -> bool:
    """Return whether a request at this time may have caused, or changed, a movement."""
    return way[0] - BEFORE_S <= t <= way[1]


def apart(
    first: Recording,
    second: Recording,
    plain: Alignment,
    ways: tuple[list[Interval], list[Interval]],
    matched: Sequence[Shared],
) -> list[Interval]:
    """Return the times of the first in which the robots were not asked for the same: until they stand together again."""
    t = np.arange(first.t[0], first.t[-1], GRID_S)
    seconds = plain.second_s(t)
    a, b = resample(first, t), resample(second, seconds)
    near = np.max(np.abs(a - b)[:, : len(ARMS)], axis=1) < TOGETHER_DEG
    together = t[resting(a) & resting(b) & near]
    reached = [
        (motion, max(motion.sim.end_s, float(np.interp(motion.hw.end_s, seconds, t))) + AROUND_S)
        for motion in matched
        if (motion.sim.end is motion.hw.end is Reason.OK and motion.sim.absolute)
        and (motion.sim.end_s is not None and motion.hw.end_s is not None)
    ]
    found = []
    for begin_s, hardware in plain.alone:
        own = ways[1] if hardware else ways[0]
        way = next((way for way in reversed(own) if contains(way, begin_s)), (begin_s, begin_s))
        start_s, rest_s = min(way[0], begin_s), way[1]
        if hardware:
            start_s, rest_s = (float(np.interp(each, seconds, t)) for each in (start_s, rest_s))
        later = together[together > rest_s + AROUND_S]
        ends = [end_s for motion, end_s in reached if (motion.hw if hardware else motion.sim).t > begin_s]
        until_s = min([*later[:1].tolist(), *ends], default=math.inf)
        found.append((start_s - 2 * AROUND_S, until_s))
    return found


def ended_early(matched: Sequence[Shared]) -> Iterator[Alone]:
    """Yield the motions that one robot carried out, or replaced by the next one, and the other did not."""
    for motion in matched:
        ends = motion.sim.end, motion.hw.end
        sim, hw = (end in (Reason.OK, Reason.REPLACED) for end in ends)
        if None not in ends and sim != hw:
            yield Alone(motion.hw.t if hw else motion.first.t, hardware=hw)
