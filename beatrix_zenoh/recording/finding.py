"""Findings about the cause of differences, and those about anything but the movement: losses, requests, clocks."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from enum import StrEnum
from typing import Final

import numpy as np

from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.recording.compare import Comparison
from beatrix_zenoh.recording.motion_shifts import EQUAL_S, FEWEST, jump


class Cause(StrEnum):
    """The cause of differences."""

    STOOD_STILL = "stood still"
    NOT_ASKED = "not asked"
    STOPPED = "stopped"
    BEGAN_APART = "began apart"
    EXCHANGED = "exchanged"
    REVERSED = "reversed"
    SCALE = "scale"
    OFFSET = "offset"
    MISSED_STEPS = "missed steps"
    CREEP = "creep"
    DRIFT = "drift"
    CLOCK = "clock"
    JUMP = "jump"
    LOSS = "loss"
    NEW_HOME = "new home"
    FOLLOWED = "followed"


@dataclass(frozen=True)
class Finding:
    """A cause, the arms that it concerns, its size and a sentence about it."""

    cause: Cause
    sentence: str
    arms: tuple[str, ...] = ()
    value: float = math.nan
    """deg of BEGAN_APART, OFFSET and CREEP, full steps of MISSED_STEPS at the end, hardware / simulation - 1 of SCALE, s per s
    of DRIFT, s of CLOCK and JUMP, share of LOSS, number of motions of NOT_ASKED"""
    t: float = math.nan
    """time since the begin of the comparison (s), if the cause has one"""


def listed(names: tuple[str, ...]) -> str:
    """Join names: 'short, middle and long'."""
    return names[0] if len(names) == 1 else f"{', '.join(names[:-1])} and {names[-1]}"


def count(number: int, what: str) -> str:
    """Return a number with its noun."""
    return f"{number} {what}" + "s" * (number != 1)


DRIFT: Final = 0.002
"""Smallest drift (s per s) that is reported."""
CLOCK_S: Final = 1.0
"""All motions late by more than this: clocks that differ, or a lead that no request says."""
SURE: Final = 12.0
"""A drift is so many times its standard error: lags that only jitter show that in less than 1 of 700 recordings."""


def lost_samples(found: Comparison) -> Iterator[Finding]:
    """Yield a finding for each robot of which samples are missing."""
    for name, regular in zip(("simulation", "hardware"), found.regularity, strict=True):
        if regular.lost:
            share = regular.lost / (regular.lost + regular.samples)
            yield Finding(
                Cause.LOSS,
                f"{regular.lost} samples of the {name} are missing ({share:.1%}): the network, or a busy computer, lost them.",
                value=share,
            )
        if regular.without_numbers:
            yield Finding(
                Cause.LOSS,
                f"{count(regular.without_numbers, 'sample')} of the {name} had angles that are no numbers, and are left out.",
                value=regular.without_numbers / (regular.without_numbers + regular.samples),
            )


def new_homes(found: Comparison) -> Iterator[Finding]:
    """Yield a finding for each robot that got another home during the recording."""
    for name, times in zip(("simulation", "hardware"), found.homes, strict=True):
        if times:
            yield Finding(
                Cause.NEW_HOME,
                f"The {name} got another home {count(times, 'time')} (CALIBRATE), and its angles count from the newest; the "
                f"figures are of the longest part between, {found.seconds:.1f} s.",
                value=times,
            )


def following(found: Comparison) -> Iterator[Finding]:
    """Yield a finding if the simulation made motions by following the hardware."""
    if found.followed:
        yield Finding(
            Cause.FOLLOWED,
            f"The simulation was not asked for {count(len(found.followed), 'motion')}, and made what the hardware made: it "
            "follows the hardware, so that the lag is its own, with the opposite sign.",
            value=len(found.followed),
            t=found.followed[0].request.t - float(found.t[0]),
        )


def not_asked(found: Comparison) -> Iterator[Finding]:
    """Yield a finding for each reason for which only one robot made a motion."""
    groups: dict[tuple[bool, str], list[float]] = {}
    for each in found.alone:
        groups.setdefault((each.hardware, each.why), []).append(each.request.t - float(found.t[0]))
    for (hardware, why), times in groups.items():
        one = "hardware" if hardware else "simulation"
        made = f"Only the {one} made {count(len(times), 'motion')}"
        when = ", ".join(f"{t:.1f} s" for t in times[:4]) + (", ..." if len(times) > 4 else "")
        yield Finding(
            Cause.NOT_ASKED,
            f"{made} (at {when}), because {why}; the figures leave out the time until both stand together again.",
            value=len(times),
            t=times[0],
        )


def stopped(found: Comparison) -> Iterator[Finding]:
    """Yield a finding for the motions that only one robot carried out to the end."""
    for one, ends in (
        ("hardware", [motion for motion in found.early if motion.sim.end is Reason.OK]),
        ("simulation", [motion for motion in found.early if motion.sim.end is not Reason.OK]),
    ):
        if ends:
            ended = ends[0].hw if one == "hardware" else ends[0].sim
            yield Finding(
                Cause.STOPPED,
                f"Only the {one} ended {count(len(ends), 'motion')} before the goal ({ended.end}, at "
                f"{ends[0].sim.t - found.t[0]:.1f} s); the figures leave out the time until both stand together again.",
                value=len(ends),
                t=ends[0].sim.t - float(found.t[0]),
            )


def clocks(found: Comparison) -> Iterator[Finding]:
    """Yield a finding if the lags change once, grow steadily, or are all so large that clocks must differ."""
    jumped = jump(found.moved)
    if jumped is not None:
        t, value = jumped[0] - float(found.t[0]), jumped[1]
        side = "later" if value > 0 else "earlier"
        yield Finding(
            Cause.JUMP,
            f"From {t:.1f} s on the hardware is {abs(value):.2f} s {side} than before: its clock was set, or its requests came "
            f"{side}.",
            value=value,
            t=t,
        )
        return
    known = [part for part in found.moved if not math.isnan(part.lag_s)]
    if not known:
        return
    lags = np.array([part.lag_s for part in known])
    begins = np.array([part.begin_s for part in known])
    if len(known) >= FEWEST:
        since = begins - begins[0]
        line = np.polyfit(since, lags, 1)
        growth, left = line[0], lags - np.polyval(line, since)
        error = math.sqrt(np.sum(left**2) / (len(known) - 2) / np.sum((since - since.mean()) ** 2))
        if abs(growth) > max(DRIFT, SURE * error) and abs(lags[-1] - lags[0]) > EQUAL_S:
            way = "fast" if growth > 0 else "slow"
            yield Finding(
                Cause.DRIFT,
                f"The hardware's clock runs {abs(growth):.1%} {way}: the lag changes from {lags[0] * 1e3:.0f} to "
                f"{lags[-1] * 1e3:.0f} ms.",
                value=float(growth),
            )
            return
    typical = float(np.median(lags))
    if abs(typical) > CLOCK_S and np.ptp(lags) < EQUAL_S:
        side = "late" if typical > 0 else "early"
        yield Finding(
            Cause.CLOCK,
            f"Every motion of the hardware is {abs(typical):.2f} s {side}: its clock differs, or it had a lead that no "
            "request names.",
            value=typical,
        )
