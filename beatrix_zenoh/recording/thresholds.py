"""Thresholds for a comparison, for exercises that pass or fail."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.errors import WrongUsage
from beatrix_zenoh.recording.compare import Comparison
from beatrix_zenoh.recording.finding import count


@dataclass(frozen=True)
class Thresholds:
    """The largest allowed values; None: not checked."""

    lag_s: float | None = None
    """largest lag of the set points, of either robot behind the other, without the lead"""
    rms_deg: float | None = None
    """largest root mean square difference of an axis after removal of each motion's lead and lag"""
    largest_deg: float | None = None
    """largest difference of an axis after removal of each motion's lead and lag"""
    rest_deg: float | None = None
    """largest difference of an axis while both robots rest"""
    missed_steps: int | None = None
    """full motor steps that slipped in the simulation"""

    def __post_init__(self) -> None:
        for name, value in vars(self).items():
            if value is not None and not (math.isfinite(value) and value >= 0):
                raise WrongUsage(Reason.BAD_VALUE, f"{name} is {value:g}: give a number, 0 or more.")

    def exceeded(self, found: Comparison, slipped: int | None) -> list[str]:
        """Return a sentence for each threshold that is exceeded or cannot be checked."""
        return [*self._lag(found), *self._numbers(found), *self._axes(found), *self._missed(slipped)]

    def _lag(self, found: Comparison) -> Iterator[str]:
        if self.lag_s is None:
            return
        if math.isnan(found.lag_s):
            yield (
                f"At most {self.lag_s:g} s of lag is allowed, but the lag could not be measured: {why_no_lag(found)} "
                "Move both robots during the comparison."
            )
        elif abs(found.lag_s) > self.lag_s:
            lag = distinct(found.lag_s, self.lag_s, "+")
            yield f"The lag is {lag} s; at most {self.lag_s:g} s in either direction is allowed."

    def _numbers(self, found: Comparison) -> Iterator[str]:
        unknown = sum(regular.without_numbers for regular in found.regularity)
        if unknown and any(limit is not None for limit in (self.rms_deg, self.largest_deg, self.rest_deg)):
            yield f"{count(unknown, 'sample')} had angles that are no numbers, so the differences there are not known."

    def _axes(self, found: Comparison) -> Iterator[str]:
        checks = (
            ("rms difference after removal of lead and lag", "rms_after", self.rms_deg),
            ("largest difference after removal of lead and lag", "largest_after", self.largest_deg),
            ("difference at rest", "at_rest", self.rest_deg),
        )
        for what, field, allowed in checks:
            if allowed is None:
                continue
            values = {axis.axis: float(getattr(axis, field)) for axis in found.axes}
            if all(math.isnan(value) for value in values.values()):
                why = (
                    "the robots never rested at the same time: let both rest for a second."
                    if field == "at_rest"
                    else "at no time were both robots asked for the same movement and recorded."
                )
                yield f"At most {allowed:g}° of {what} is allowed, but {why}"
                continue
            above = sorted(
                (name for name in values if not values[name] <= allowed), key=lambda name: -values[name]
            )
            if above:
                also = f" (and {', '.join(above[1:])})" if above[1:] else ""
                value = distinct(values[above[0]], allowed)
                yield f"The {what} is {value}° in {above[0]}{also}; at most {allowed:g}° is allowed."

    def _missed(self, slipped: int | None) -> Iterator[str]:
        if self.missed_steps is None:
            return
        if slipped is None:
            yield (
                f"At most {self.missed_steps} missed steps are allowed, but this source does not measure them: "
                "only a live simulation does."
            )
        elif abs(slipped) > self.missed_steps:
            yield f"The simulation missed {abs(slipped)} full steps; at most {self.missed_steps} are allowed."


def distinct(value: float, allowed: float, sign: str = "") -> str:
    """Format a value that exceeds an allowed one with so many decimals that it does not look equal to it."""
    digits = 3
    while digits < 9 and float(f"{abs(value):.{digits}f}") <= allowed:
        digits += 1
    return f"{value:{sign}.{digits}f}"


def why_no_lag(found: Comparison) -> str:
    """Return the reason why no lag was measured, as the end of a sentence."""
    if not found.anything_moved:
        return "nothing moved."
    if not found.moved:
        return "no motion was made by both robots."
    reasons = list(dict.fromkeys(part.why for part in found.moved if part.why))
    if not reasons:
        return "the set points of the two robots do not agree."
    return f"the two robots did not make the same movement ({reasons[0]})."
