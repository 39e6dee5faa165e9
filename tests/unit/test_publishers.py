"""Two programs under one key: their numbers alternate; those of one node, restarted or not, do not."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from beatrix_zenoh.contract.publishers import NUMBERS, WITHIN, Publishers
from beatrix_zenoh.recording.samples import lost


def alternating(one: int, other: int, each: int = 1) -> list[int]:
    """Return the numbers of two programs, of which each publishes `each` times in turn."""
    turns = [range(k * each, (k + 1) * each) for k in range(20)]
    return list(itertools.chain(*([one + k for k in turn] + [other + k for k in turn] for turn in turns)))


@pytest.mark.parametrize(
    ("numbers", "several"),
    [
        ([], False),
        (list(range(500)), False),
        ([NUMBERS - 2, NUMBERS - 1, 0, 1], False),
        ([7] * 500, False),
        ([*range(500), *range(500)], False),
        ([*range(WITHIN), *range(WITHIN), *range(WITHIN), *range(WITHIN)], False),
        ([1, 5, 9, 400, 401], False),
        (alternating(1000, 5000), True),
        (alternating(1000, 1002), True),
        (alternating(1000, 5000, each=3), True),
        (alternating(NUMBERS - 10, 0), True),
    ],
)
def test_only_numbers_of_two_programs_are_named_so(numbers: list[int], *, several: bool) -> None:
    publishers = Publishers()
    assert any(publishers.several(number % NUMBERS) for number in numbers) == several
    wrapped = np.array(numbers, dtype=np.int64) % NUMBERS
    assert (lost(wrapped) is None) == several


def test_one_second_after_the_other_program_has_ended_one_remains() -> None:
    publishers = Publishers()
    assert [publishers.several(number) for number in alternating(1000, 5000)][-1]
    after = [publishers.several(number) for number in range(5020, 5020 + WITHIN)]
    assert after[0]
    assert not after[-1]
