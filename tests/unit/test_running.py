"""Numbers of motions."""

from __future__ import annotations

from hypothesis import example, given
from hypothesis import strategies as st

from beatrix_zenoh.node.running import NUMBERS, next_number


@example(last=5, boards=6)
@given(last=st.integers(0, NUMBERS), boards=st.integers(0, NUMBERS))
def test_a_number_is_neither_the_last_nor_the_boards_nor_that_of_text(last: int, boards: int) -> None:
    number = next_number(last, boards)
    assert 0 < number <= NUMBERS
    assert number not in (last, boards)
