"""Clock conversion: the error of the estimate with delays, drift, resets and pauses."""

from __future__ import annotations

import random
import statistics
from collections.abc import Iterator

import pytest

from beatrix_zenoh.board.timing import BoardClock

MS = 1_000_000
PERIOD_MS = 10


def estimate_errors(
    clock: BoardClock,
    seconds: float,
    *,
    drift_ppm: float = 0.0,
    begin_ms: int = 0,
    at_ns: int = 10**12,
    seed: int = 1,
) -> Iterator[float]:
    """Yield the error (ms) of each estimate; telemetry comes every 10 ms, up to 5 ms late, one in fifty 50 ms late."""
    chance = random.Random(seed)
    for n in range(int(seconds * 1000 / PERIOD_MS)):
        true_ns = at_ns + round(n * PERIOD_MS * MS * (1 + drift_ppm / 1e6))
        delay_ns = 50 * MS if chance.random() < 0.02 else round(chance.random() * 5 * MS)
        tick = (begin_ms + n * PERIOD_MS) % 65536
        yield (clock.feed(tick, true_ns + delay_ns) - true_ns) / MS


@pytest.mark.parametrize("drift_ppm", [0, 100, -100, 1000, -1000])
def test_errors_are_below_2_ms_with_a_deviation_below_1_ms(drift_ppm: float) -> None:
    errors = list(estimate_errors(BoardClock(), 60, drift_ppm=drift_ppm))[500:]
    assert statistics.pstdev(errors) < 1
    assert max(map(abs, errors)) < 2


def test_the_estimate_remains_correct_when_the_tick_wraps_around() -> None:
    errors = list(estimate_errors(BoardClock(), 30, begin_ms=65536 - 15_000))[100:]
    assert max(map(abs, errors)) < 1


def test_the_estimate_recovers_within_200_ms_of_a_restart() -> None:
    clock = BoardClock()
    list(estimate_errors(clock, 20))
    clock.restart()
    errors = list(estimate_errors(clock, 5, at_ns=2 * 10**12))
    assert max(map(abs, errors[20:])) < 1


@pytest.mark.parametrize("pause_ms", [20, 100, 700, 40_000])
def test_the_estimate_recovers_within_1_2_s_of_a_pause_of_virtual_time(pause_ms: int) -> None:
    """The tick continues from its last value, at a later time of the host's clock."""
    clock = BoardClock()
    list(estimate_errors(clock, 20))
    errors = list(estimate_errors(clock, 5, begin_ms=20_000, at_ns=10**12 + (20_000 + pause_ms) * MS))
    assert max(map(abs, errors[120:])) < 1


def test_an_estimate_is_never_later_than_the_arrival() -> None:
    clock, chance = BoardClock(), random.Random(3)
    for n in range(5000):
        at = 10**12 + n * PERIOD_MS * MS + round(chance.random() * 5 * MS)
        assert clock.feed(n * PERIOD_MS % 65536, at) <= at
