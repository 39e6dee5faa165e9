"""The motions of two robots, each with its lead and its lag, and the time of the second that belongs to the first.

Motions are matched by their requests, or by their movement if the requests were not recorded. All times are in s.
"""

from __future__ import annotations

import bisect
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.names import ARMS
from beatrix_zenoh.recording.lag import EXPLAINED, FAR_S, NEAR_S, Shift, best_shift, chosen, gains, lag
from beatrix_zenoh.recording.requests import NOT_ASKED, Alone, MotionRequest, Shared, alone, pairs, shared
from beatrix_zenoh.recording.series import GRID_S, Flags, Floats, Recording, resample, resting, runs, sampled

LOCAL_S = 0.15
"""Largest difference of the first search between the shift of a motion and that of its requests."""
AROUND_S = 0.1
"""A motion is compared with this much rest before and after it."""
BEFORE_S = 0.3
"""A movement may be seen this long after its request, and a request this long after the movement: clocks are read in
slices of 20 ms, and robots begin slowly."""
BEGUN_S = 10.0
"""A movement that already runs when the recording begins may have been requested this much earlier."""
BEGUN = "it began before the recording, so its lead is not known"
CHANGED_S = 0.1
"""If the shift of the requests changes by more than this, a new motion begins."""
AGREE_S = 0.05
"""Largest difference between the shifts of two arms in one motion."""
CLEAR_DEG = 3.0
"""The shift of an arm is judged if it turns by more than this."""
TOGETHER_DEG = 1.0
"""Robots at rest whose arms differ by less than this stand together again."""
SOONER_S = 0.5
"""A hardware that begins this much before the end of the lead was sent the motion by a click."""

Interval = tuple[float, float]


@dataclass(frozen=True)
class MovedPart:
    """A motion of both robots: times by the clock of the first."""

    begin_s: float
    end_s: float
    lead_s: float | None
    """the lead that was requested; None: no lead was requested, or the requests were not recorded"""
    shift_s: float
    """start of the second minus start of the first; if `lag_s` is NaN, the best estimate"""
    lag_s: float
    """what remains of `shift_s` without the lead; NaN: unknown"""
    why: str = ""
    """why the lag is unknown"""

    @property
    def measured(self) -> bool:
        """Whether `shift_s` was measured."""
        return not self.why


@dataclass(frozen=True)
class Alignment:
    """Which time of the second robot belongs to which time of the first."""

    parts: tuple[MovedPart, ...]
    apart: tuple[Interval, ...]
    """times of the first in which the robots were not asked for the same movement"""
    alone: tuple[Alone, ...]
    early: tuple[Shared, ...]
    """motions that only one of the robots carried out to the end"""
    followed: tuple[Alone, ...]
    """requests to the hardware that the simulation, which was not asked, followed"""
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


@dataclass(frozen=True)
class Expected:
    """A motion of the first robot, and what is known about its shift before it is measured."""

    begin_s: float
    end_s: float
    shift_s: float
    lead_s: float | None = None
    unknown: str = ""
    """why the lag is unknown, whatever is measured"""
    limits_s: tuple[float, ...] = (LOCAL_S, NEAR_S)


def aligned(first: Recording, second: Recording) -> Alignment:
    """Match the motions of both robots and measure the shift of each."""
    ways = movements(first), movements(second)
    matched: list[Shared] = []
    single: list[Alone] = []
    followed: list[Alone] = []
    if first.requests is not None and second.requests is not None:
        asked = within(first)
        both = pairs(asked, within(second))
        matched = shared(both)
        for motion in alone(both, float(first.t[0])):
            (followed if follows(motion, ways[0], asked) else single).append(motion)
    expected = [*of_requests(ways[0], matched), *of_movement(first, second, ways, matched, single)]
    expected.sort(key=lambda motion: motion.begin_s)
    expected = [replace(motion, begin_s=max(motion.begin_s, float(first.t[0]))) for motion in expected]
    parts = all_measured(first, second, expected)
    known = [part.shift_s for part in parts if part.measured and not part.lead_s]
    shift_s = float(np.median(known)) if known else 0.0
    early = tuple(motion for motion in matched if ended_early(motion))
    plain = Alignment(parts, (), tuple(single), early, tuple(followed), shift_s)
    left_out = tuple(apart(first, second, plain, ways, matched))
    kept = tuple(
        part
        for part in parts
        if part.measured or not any(begin_s <= part.begin_s < end_s for begin_s, end_s in left_out)
    )
    return replace(plain, parts=kept, apart=left_out)


def all_measured(first: Recording, second: Recording, expected: Sequence[Expected]) -> tuple[MovedPart, ...]:
    """Measure the shift of each motion; if none is found, with each arm of the second in the scale of the first."""
    parts = tuple(measured(first, second, motion) for motion in expected)
    if any(part.measured for part in parts):
        return parts
    windows = [window(first, second, part) for part in parts]
    t = np.concatenate([np.empty(0), *windows])
    if len(t) < 2:
        return parts
    one, other = (chosen(each, range(len(ARMS))) for each in (first, second))
    shifts = np.repeat([part.shift_s for part in parts], [len(each) for each in windows])
    factors = gains(one, other, t, t + shifts)
    rescaled = tuple(
        measured(first, replace(other, angles=other.angles / factors), motion) for motion in expected
    )
    return rescaled if any(part.measured for part in rescaled) else parts


def within(recorded: Recording) -> list[MotionRequest]:
    """Return the requests during a recording."""
    return [
        request
        for request in recorded.requests or ()
        if recorded.t[0] - BEGUN_S <= request.t <= recorded.t[-1]
    ]


def follows(motion: Alone, ways: Sequence[Interval], asked: Sequence[MotionRequest]) -> bool:
    """Return whether the simulation moved with the hardware although no request reached it: it follows.

    Args:
        motion: a motion of one robot alone.
        ways: the movements of the simulation.
        asked: the requests to the simulation.
    """
    way = next((way for way in ways if contains(way, motion.request.t)), None)
    if motion.why != NOT_ASKED or way is None:
        return False
    return not any(not each.refused and contains(way, each.t) for each in asked)


def movements(recorded: Recording) -> list[Interval]:
    """Return begin and end of each movement of a robot; one that runs at the begin began up to BEGUN_S before it."""
    t = np.arange(recorded.t[0], recorded.t[-1], GRID_S)
    return [
        (float(t[begin]) - (0.0 if begin else BEGUN_S), float(t[end - 1]))
        for begin, end in runs(~resting(resample(recorded, t)))
    ]


def of_requests(ways: Sequence[Interval], matched: Sequence[Shared]) -> list[Expected]:
    """Return the motions of the first robot that both were asked for; a movement of many requests is one motion."""
    found: list[Expected] = []
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


def of_group(begin_s: float, end_s: float, group: Sequence[Shared]) -> Expected:
    """Return the motion of requests with almost equal shifts."""
    shift_s = float(np.median([shift(motion) for motion in group]))
    return Expected(begin_s, end_s, shift_s, group[0].lead_s, separate(group, shift_s))


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


def of_movement(
    first: Recording,
    second: Recording,
    ways: tuple[list[Interval], list[Interval]],
    matched: Sequence[Shared],
    single: Sequence[Alone],
) -> list[Expected]:
    """Return the motions of the first robot without requests; each is expected where a movement of the second begins."""
    asked = [motion.first.t for motion in matched] + [each.request.t for each in single if not each.hardware]
    answered = [motion.hw.t for motion in matched] + [each.request.t for each in single if each.hardware]
    mine = [way for way in ways[0] if not any(contains(way, t) for t in asked)]
    theirs = [way for way in ways[1] if not any(contains(way, t) for t in answered)]
    whole_s = 0.0 if matched else lag(first.arms, second.arms)
    shifts = expected_shifts(mine, theirs, 0.0 if math.isnan(whole_s) else whole_s)
    asked_before = first.requests is not None and second.requests is not None
    return [
        Expected(
            *way,
            shift_s,
            unknown=BEGUN if asked_before and way[0] < first.t[0] else "",
            limits_s=(LOCAL_S, NEAR_S, FAR_S),
        )
        for way, shift_s in zip(mine, shifts, strict=True)
    ]


def expected_shifts(mine: Sequence[Interval], theirs: Sequence[Interval], whole_s: float) -> list[float]:
    """Return the expected shift of each movement: that of the movement of the second with the same number, or near it."""
    begins = [way[0] for way in theirs]
    if len(mine) == len(theirs) and all(
        abs(begin_s - way[0]) <= FAR_S for way, begin_s in zip(mine, begins, strict=True)
    ):
        return [begin_s - way[0] for way, begin_s in zip(mine, begins, strict=True)]
    found, last_s = [], -math.inf
    for way in mine:
        free = [begin_s - way[0] for begin_s in begins[bisect.bisect_right(begins, last_s) :]]
        shift_s = min(free, key=lambda each: abs(each - whole_s), default=math.inf)
        if abs(shift_s - whole_s) <= FAR_S:
            last_s = way[0] + shift_s
        else:
            shift_s = whole_s
        found.append(shift_s)
    return found


def window(
    first: Recording, second: Recording, motion: Expected | MovedPart, limit_s: float = LOCAL_S
) -> Floats:
    """Return the times of the first at which a motion is compared with the second, for shifts up to `limit_s` (s).

    Times in a gap of a recording are left out; there are none if less than a quarter of the motion remains.

    At the ends of the recordings up to half of the motion is left out, so that the second was recorded at each shift.
    """
    begin_s = max(motion.begin_s - AROUND_S, float(first.t[0]))
    t = np.arange(begin_s, min(motion.end_s + AROUND_S, float(first.t[-1])), GRID_S)
    seconds = t + motion.shift_s
    inner = t[(seconds - limit_s >= second.t[0]) & (seconds + limit_s <= second.t[-1])]
    kept = inner if 2 * len(inner) >= len(t) else t
    seconds = kept + motion.shift_s
    seen = kept[sampled(first, kept) & sampled(second, seconds, AGREE_S)]
    return seen if 4 * len(seen) >= len(kept) else seen[:0]


def measured(first: Recording, second: Recording, motion: Expected) -> MovedPart:
    """Measure the shift of a motion; it stays unknown if no shift explains the movement of each arm."""
    one, other = chosen(first, range(len(ARMS))), chosen(second, range(len(ARMS)))
    found, t = Shift(math.nan, math.inf), first.t
    for limit_s in motion.limits_s:
        t = window(first, second, motion, limit_s)
        found = best_shift(one, other, t, motion.shift_s, limit_s)
        if found.left < EXPLAINED and not math.isnan(found.s):
            break
    gaps = "" if len(t) else "most of it lies in gaps of the recordings"
    why = (
        motion.unknown or gaps or unknown(found, motion.limits_s[-1]) or disagreement(one, other, t, found.s)
    )
    lead_s = motion.lead_s or 0.0
    if not why and found.s < lead_s - SOONER_S:
        return MovedPart(
            motion.begin_s,
            motion.end_s,
            motion.lead_s,
            found.s,
            math.nan,
            f"the hardware began {lead_s - found.s:.1f} s before the lead of {lead_s:g} s had ended",
        )
    shift_s = motion.shift_s if math.isnan(found.s) or (why and not motion.unknown) else found.s
    return MovedPart(
        motion.begin_s, motion.end_s, motion.lead_s, shift_s, math.nan if why else shift_s - lead_s, why
    )


def unknown(found: Shift, limit_s: float) -> str:
    """Return why a shift is unknown; empty: it is known."""
    if found.left == math.inf:
        return "the recording ends before the hardware made it"
    if found.left >= EXPLAINED:
        return f"no shift of up to {limit_s:g} s explains more than {max(0.0, 1 - found.left):.0%} of the movement"
    return f"the shift is longer than the {limit_s:g} s that were searched" if math.isnan(found.s) else ""


def disagreement(one: Recording, other: Recording, t: Floats, shift_s: float) -> str:
    """Return a sentence if arms that turn clearly have different shifts; empty if they agree."""
    ways = np.ptp(resample(one, t), axis=0)
    for i, arm in enumerate(ARMS):
        if ways[i] < max(CLEAR_DEG, 0.2 * ways.max()):
            continue
        own = best_shift(chosen(one, [i]), chosen(other, [i]), t, shift_s, LOCAL_S)
        if own.left >= 2 * EXPLAINED or not abs(own.s - shift_s) <= AGREE_S:
            return f"the {arm} arm does not move as the others do"
    return ""


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
    ends = [
        motion.sim.end_s + AROUND_S
        for motion in matched
        if motion.sim.absolute and motion.sim.end_s is not None and motion.hw.end is Reason.OK
    ]
    found = []
    begins = [(each.request.t, each.hardware) for each in plain.alone]
    begins += [(motion.first.t, False) for motion in plain.early]
    for begin_s, hardware in begins:
        own = ways[1] if hardware else ways[0]
        way = next((way for way in own if contains(way, begin_s)), (begin_s, begin_s))
        start_s, rest_s = min(way[0], begin_s), way[1]
        if hardware:
            start_s, rest_s = (float(np.interp(each, seconds, t)) for each in (start_s, rest_s))
        later = together[together > rest_s + AROUND_S]
        reached = [end_s for end_s in ends if end_s > rest_s + 2 * AROUND_S]
        until_s = min([*later[:1].tolist(), *reached], default=float(t[-1]))
        found.append((start_s - 2 * AROUND_S, until_s))
    return found


def ended_early(motion: Shared) -> bool:
    """Return whether one robot carried the motion out, or began the next one, and the other did not."""
    ends = motion.sim.end, motion.hw.end
    carried_out = [end in (Reason.OK, Reason.REPLACED) for end in ends]
    return None not in ends and carried_out[0] != carried_out[1]
