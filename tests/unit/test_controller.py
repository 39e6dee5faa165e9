"""Numbers of motions."""

from __future__ import annotations

from hypothesis import example, given
from hypothesis import strategies as st

from beatrix_zenoh.node.controller import NUMBERS, next_number


@example(last=5, on_board=6)
@given(last=st.integers(0, NUMBERS), on_board=st.integers(0, NUMBERS))
def test_a_motion_number_is_neither_0_nor_the_last_one_nor_that_on_the_board(
    last: int, on_board: int
) -> None:
    number = next_number(last, on_board)
    assert 0 < number <= NUMBERS
    assert number not in (last, on_board)
