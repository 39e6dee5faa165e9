"""The parts of one recording: files of `record --rotate`, or recordings that were merged into one file."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Final

import numpy as np

from beatrix_zenoh.client.session import Place
from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.errors import Refused
from beatrix_zenoh.recording.samples import Floats, Nanoseconds, Recorded, Samples

APART_NS: Final = 3_600_000_000_000
"""Parts further apart than this are not of one recording: a table would have 180 000 empty rows for each hour."""
OVERLAP_NS: Final = 1_000_000_000
"""Parts of one recording may overlap by samples that arrived late; more than this is another recording."""

Span = tuple[int, int]
"""First and last time (ns since 1970)."""


def check_parts(parts: Iterable[Mapping[Place, Span]], what: str, instead: str) -> None:
    """Check that parts are of one recording, by the spans of their robots.

    Args:
        parts: the spans of each part.
        what: beginning of the error.
        instead: what to do if they are not.

    Raises:
        Refused: BAD_VALUE, two parts contain the same time of a robot, or are far apart.
    """
    ends: dict[Place, int] = {}
    for part in sorted(parts, key=lambda part: union(part.values())):
        first_ns, _ = union(part.values())
        apart_ns = first_ns - max(ends.values(), default=first_ns)
        shared = [place for place, span in part.items() if ends.get(place, 0) - span[0] > OVERLAP_NS]
        if shared or apart_ns > APART_NS:
            how = (
                "contain the same time of {} ({})".format(*shared[0])
                if shared
                else f"are {apart_ns / 3.6e12:.1f} h apart"
            )
            raise Refused(
                Reason.BAD_VALUE,
                f"{what} {how}: they are not parts of one recording (`beatrix record --rotate`). {instead}",
            )
        ends |= {place: max(ends.get(place, 0), last_ns) for place, (_, last_ns) in part.items()}


def union(spans: Iterable[Span]) -> Span:
    """Return the span that contains these."""
    firsts, lasts = zip(*spans, strict=True)
    return min(firsts), max(lasts)


def spans_of(part: Recorded) -> dict[Place, Span]:
    """Return the span of each robot's samples."""
    return {place: (int(each.time_ns[0]), int(each.time_ns[-1])) for place, each in part.robots.items()}


def joined(parts: Sequence[Recorded]) -> dict[Place, Samples]:
    """Return the samples of all robots in the order of time, from the files of one recording in any order.

    Raises:
        Refused: BAD_VALUE, two files contain the same time of one robot, or are far apart, so they are not parts of one
            recording.
    """
    check_parts(map(spans_of, parts), "Two of the files", "Export them one by one.")
    places = sorted({place for part in parts for place in part.robots})
    return {
        place: concatenated([part.robots[place] for part in parts if place in part.robots])
        for place in places
    }


def concatenated(parts: Sequence[Samples]) -> Samples:
    """Return the samples of one robot from several files; a sample that several files contain comes once."""
    time_ns = np.concatenate([part.time_ns for part in parts])
    source = np.repeat(np.arange(len(parts)), [len(part.time_ns) for part in parts])
    order = np.argsort(time_ns, kind="stable")
    again = (np.diff(time_ns[order]) == 0) & (np.diff(source[order]) != 0)
    order = order[np.append(True, ~again)]
    return Samples(
        time_ns[order],
        np.concatenate([part.robot_ns for part in parts])[order],
        np.concatenate([part.arms for part in parts])[order],
        np.concatenate([part.commanded for part in parts])[order],
        np.concatenate([part.head for part in parts])[order],
        None
        if all(part.head_measured is None for part in parts)
        else np.concatenate([measured(part) for part in parts])[order],
        np.concatenate([part.velocity for part in parts])[order],
        np.concatenate([numbers(part.seq, len(part.time_ns)) for part in parts])[order],
        np.concatenate([numbers(part.repeats, len(part.time_ns)) for part in parts])[order],
    )  # fmt: skip


def numbers(values: Nanoseconds | None, count: int) -> Nanoseconds:
    """Return whole numbers (n,); -1: not recorded."""
    return np.full(count, -1, np.int64) if values is None else values


def measured(samples: Samples) -> Floats:
    """Return the measured orientation of the head (n, 3; deg); NaN: not measured."""
    return np.full_like(samples.head, np.nan) if samples.head_measured is None else samples.head_measured
