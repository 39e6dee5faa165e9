"""Gaps of a log: each is counted, and has the name of its cause."""

from __future__ import annotations

import time

import msgspec
import pytest
from statuses import AT_HOME

from beatrix_zenoh.client.log import find_gaps
from beatrix_zenoh.client.subscription import Arrival
from beatrix_zenoh.contract._generated.messages import Positions


def positions(*steps: tuple[int, float]) -> list[Positions]:
    """Return positions with these numbers and times (s)."""
    return [msgspec.structs.replace(AT_HOME, seq=seq, t_mono_ns=round(t * 1e9)) for seq, t in steps]


@pytest.mark.parametrize(
    ("steps", "lost", "cause"),
    [
        ([(1, 0.0), (2, 0.02), (3, 0.04)], None, ""),
        ([(1, 0.0), (4, 0.06)], 2, "2 were lost on the way"),
        ([(1, 0.0), (11, 0.2)], 9, "9 were lost on the way"),
        ([(1, 0.0), (2, 0.2)], 0, "the robot had no new ones"),
        ([(1, 0.0), (2, 0.0), (3, 0.2)], 0, "the robot had no new ones"),  # the second one repeats
        ([(90, 0.0), (1, 4.0)], 0, "the robot's node was started again"),
    ],
)
def test_a_gap_has_its_cause(steps: list[tuple[int, float]], lost: int | None, cause: str) -> None:
    given = positions(*steps)
    gaps = find_gaps(given, Arrival(given[-1], "bea", "hw", time.monotonic_ns(), 0))
    assert [(gap.lost, gap.cause) for gap in gaps] == ([] if lost is None else [(lost, cause)])


def test_silence_up_to_the_end_is_a_gap() -> None:
    given = positions((1, 0.0), (2, 0.02))
    gaps = find_gaps(given, Arrival(given[-1], "bea", "hw", time.monotonic_ns() - 2_000_000_000, 0))
    assert [(round(gap.t, 2), gap.cause) for gap in gaps] == [(0.02, "the robot was silent up to the end")]
    assert gaps[0].seconds == pytest.approx(2, abs=0.5)
