"""Waits that take less than 0.2 s on a free computer: of those of a file, half must end within LIMIT_S.

Each wait has a patient time limit of its own, because any single one may be late on a busy computer. A change that
makes each reply slow makes all of them slow.
"""

from __future__ import annotations

import statistics
import time
from collections import defaultdict
from collections.abc import Iterator
from contextlib import contextmanager

LIMIT_S = 2.0
FEWEST = 5
"""With fewer waits of a kind, one late wait could decide."""
TOOK_S: defaultdict[str, list[float]] = defaultdict(list)


@contextmanager
def quick(what: str) -> Iterator[None]:
    """Measure a block that normally takes less than 0.2 s."""
    began_s = time.monotonic()
    yield
    TOOK_S[what].append(time.monotonic() - began_s)


def check_quick_waits() -> None:
    """Assert that half of the waits of each kind ended within LIMIT_S, and forget them."""
    medians = {what: statistics.median(took) for what, took in TOOK_S.items() if len(took) >= FEWEST}
    TOOK_S.clear()
    slow = {what: round(median, 1) for what, median in medians.items() if median > LIMIT_S}
    assert not slow, f"medians (s) above {LIMIT_S} s: {slow}"
