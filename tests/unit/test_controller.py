"""Numbers of motions."""

from __future__ import annotations

from hypothesis import example, given
from hypothesis import strategies as st

from beatrix_zenoh.node.controller import NUMBERS, next_number


@example(last=5, on_board=6)
@given(last=st.integers(0, NUMBERS), on_board=st.integers(0, NUMBERS))
def test_a_number_differs_from_the_last_one_the_boards_and_that_of_text(last: int, on_board: int) -> None:
    number = next_number(last, on_board)
    assert 0 < number <= NUMBERS
    assert number not in (last, on_board)
