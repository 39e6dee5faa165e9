"""Two programs under one key: their numbers alternate; those of one node, restarted or not, do not."""

from __future__ import annotations

import itertools

import pytest

from beatrix_zenoh.contract.publishers import NUMBERS, WITHIN, Order, Publishers
from beatrix_zenoh.recording.samples import lost


def alternating(one: int, other: int, each: int = 1) -> list[int]:
    """Return the numbers of two programs, of which each publishes `each` times in turn."""
    turns = [range(k * each, (k + 1) * each) for k in range(20)]
    return list(itertools.chain(*([one + k for k in turn] + [other + k for k in turn] for turn in turns)))


def swapped(count: int) -> list[int]:
    """Return the numbers of one program of which the network swaps some neighbours."""
    return [number + (1, -1)[number % 2] if number % 8 in (2, 3) else number for number in range(count)]


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
        (swapped(500), False),
        ([number + NUMBERS - 250 for number in swapped(500)], False),
        ([0, 9, *range(1, 9), 20, *range(10, 20)], False),
        (alternating(1000, 5000), True),
        (alternating(1000, 1002), True),
        (alternating(1000, 5000, each=3), True),
        (alternating(NUMBERS - 10, 0), True),
    ],
)
def test_only_numbers_of_two_programs_are_named_so(numbers: list[int], *, several: bool) -> None:
    publishers = Publishers()
    assert any(publishers.several(number % NUMBERS) for number in numbers) == several
    assert (lost([number % NUMBERS for number in numbers]) is None) == several


@pytest.mark.parametrize("first", [0, NUMBERS - 100])
def test_numbers_that_come_later_than_their_neighbours_are_not_lost(first: int) -> None:
    numbers = [(first + number) % NUMBERS for number in swapped(400) if number not in (41, 77)]
    order = Order()
    assert not any(order.goes_back(number) for number in numbers)
    assert order.missing == 2
    assert lost(numbers) == 2
    assert lost([*numbers, *swapped(200)]) == 2, "the node was restarted"


def test_one_second_after_the_other_program_has_ended_one_remains() -> None:
    publishers = Publishers()
    assert [publishers.several(number) for number in alternating(1000, 5000)][-1]
    after = [publishers.several(number) for number in range(5020, 5020 + WITHIN)]
    assert after[0]
    assert not after[-1]
