"""The controller: numbers of motions, and the reasons and sentences of their ends."""

from __future__ import annotations

import pytest
from golden import same
from hypothesis import example, given
from hypothesis import strategies as st

from beatrix_zenoh.contract._generated.serial import BoardOutcome
from beatrix_zenoh.node.controller import NUMBERS, StopCause, motion_end, next_number

ARMS = (0.1, 0.0, -0.1)
UNKNOWN = 99
"""An outcome of firmware of another version."""
ENDS: list[tuple[int, StopCause]] = [
    *((outcome, StopCause.STOP) for outcome in BoardOutcome if outcome is not BoardOutcome.NONE),
    *((BoardOutcome.STOPPED, cause) for cause in StopCause if cause is not StopCause.STOP),
    (UNKNOWN, StopCause.STOP),
]


@pytest.mark.parametrize(("outcome", "cause"), ENDS)
def test_each_end_of_a_motion_has_its_reason_and_sentence(outcome: int, cause: StopCause) -> None:
    name = "UNKNOWN" if outcome == UNKNOWN else BoardOutcome(outcome).name
    for seat in ("", "ben"):
        reason, text = motion_end(outcome, cause, ARMS, seat)
        same(f"motion end.{name} {cause.name} {seat}".rstrip(), f"{reason}: {text}")
        if outcome in (BoardOutcome.DISABLED, BoardOutcome.EMERGENCY):
            assert "rest" not in text, "arms without power may sink"


@example(last=5, on_board=6)
@given(last=st.integers(0, NUMBERS), on_board=st.integers(0, NUMBERS))
def test_a_motion_number_is_neither_0_nor_the_last_one_nor_that_on_the_board(
    last: int, on_board: int
) -> None:
    number = next_number(last, on_board)
    assert 0 < number <= NUMBERS
    assert number not in (last, on_board)
