"""The difference between hardware and simulation of one robot, on a common grid of times."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator
from typing import Final, NamedTuple

from beatrix_zenoh.contract.names import SIDES

GRID_NS: Final = 20_000_000
"""Period of the grid, equal to that of positions at 50 Hz; grid points are whole multiples of it."""
GAP_NS: Final = 100_000_000
"""Samples further apart than this are not interpolated."""
WAITING: Final = 250
"""Samples of one side (5 s) that are kept until samples of the other side arrive."""

Angles = tuple[float, ...]


class AngleDifference(NamedTuple):
    """Hardware minus simulation at one point of the grid (deg), each within half a turn."""

    time_ns: int
    angles: Angles


class Difference:
    """Calculates the differences between both sides from their samples, for each grid point that both cover.

    Between two samples of a side its angles are interpolated linearly.
    """

    def __init__(self) -> None:
        self._samples: dict[str, deque[tuple[int, Angles]]] = {side: deque(maxlen=WAITING) for side in SIDES}
        self._next_ns = 0

    def add(self, side: str, time_ns: int, angles: Angles) -> Iterator[AngleDifference]:
        """Add a sample (deg), and yield the differences that are known now; samples out of order are ignored."""
        samples = self._samples[side]
        if samples and time_ns <= samples[-1][0]:
            return
        samples.append((time_ns, angles))
        sim, hw = self._samples["sim"], self._samples["hw"]
        if not sim or not hw:
            return
        self._next_ns = max(self._next_ns, -(-max(sim[0][0], hw[0][0]) // GRID_NS) * GRID_NS)
        last_ns = min(sim[-1][0], hw[-1][0])
        while self._next_ns <= last_ns:
            first, second = at(sim, self._next_ns), at(hw, self._next_ns)
            if first is not None and second is not None:
                yield AngleDifference(
                    self._next_ns,
                    tuple((b - a + 180.0) % 360.0 - 180.0 for a, b in zip(first, second, strict=True)),
                )
            self._next_ns += GRID_NS


def at(samples: deque[tuple[int, Angles]], time_ns: int) -> Angles | None:
    """Return the angles (deg) at a time; None before the first sample or inside a gap.

    Drops the samples that neither this time nor later times need.
    """
    while len(samples) > 1 and samples[1][0] <= time_ns:
        samples.popleft()
    (before_ns, before), (after_ns, after) = samples[0], samples[min(1, len(samples) - 1)]
    if time_ns < before_ns or after_ns - before_ns > GAP_NS:
        return before if time_ns == before_ns else None
    part = (time_ns - before_ns) / (after_ns - before_ns) if after_ns > before_ns else 0.0
    return tuple(a + part * (b - a) for a, b in zip(before, after, strict=True))
