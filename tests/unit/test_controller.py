"""The controller: numbers of motions, and the reasons and sentences of their ends."""

from __future__ import annotations

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract._generated.serial import BoardOutcome
from beatrix_zenoh.node.controller import NUMBERS, StopCause, motion_end, next_number

ARMS = (0.1, 0.0, -0.1)
WHERE = "5.7°, 0.0°, -5.7°"


@pytest.mark.parametrize(
    ("outcome", "cause", "reason", "expected"),
    [
        (BoardOutcome.DONE, StopCause.STOP, Reason.OK, f"Arrived; the arms rest at {WHERE}."),
        (BoardOutcome.STOPPED, StopCause.STOP, Reason.STOPPED, f"Ended by STOP; the arms rest at {WHERE}."),
        (
            BoardOutcome.STOPPED,
            StopCause.FROZEN,
            Reason.STOPPED,
            "Ended by the teacher, who has frozen the robot; the arms rest",
        ),
        (
            BoardOutcome.STOPPED,
            StopCause.SHUTDOWN,
            Reason.SHUTDOWN,
            "Ended by its node, which is closing; the arms rest",
        ),
        (
            BoardOutcome.STOPPED,
            StopCause.CLIENT_LOST,
            Reason.CLIENT_LOST,
            "because the client that requested it is gone",
        ),
        (
            BoardOutcome.HOST_LOST,
            StopCause.STOP,
            Reason.HOST_LOST,
            "received no frame of its node for half a second",
        ),
        (BoardOutcome.GAP, StopCause.STOP, Reason.ARM_GAP, "Ended by the guard: arms came too close"),
    ],
)
def test_reason_and_sentence_agree(
    outcome: BoardOutcome, cause: StopCause, reason: Reason, expected: str
) -> None:
    actual, text = motion_end(outcome, cause, ARMS)
    assert actual is reason
    assert expected in text


@pytest.mark.parametrize("outcome", [BoardOutcome.DISABLED, BoardOutcome.EMERGENCY])
def test_the_sentence_about_arms_without_power_does_not_claim_that_they_rest(outcome: BoardOutcome) -> None:
    _, text = motion_end(outcome, StopCause.STOP, ARMS)
    assert "rest" not in text
    first = "reset, enable" if outcome is BoardOutcome.EMERGENCY else "enable"
    assert f"The arms were at {WHERE}; without power the head may have sunk: set it upright, {first}" in text


@pytest.mark.parametrize(
    ("outcome", "cause", "named"),
    [
        (BoardOutcome.STOPPED, StopCause.STOP, "Ended by STOP of ben; "),
        (BoardOutcome.EMERGENCY, StopCause.STOP, "of ben. The arms were at"),
        (BoardOutcome.STOPPED, StopCause.FROZEN, ""),
        (BoardOutcome.DONE, StopCause.STOP, ""),
        (BoardOutcome.DISABLED, StopCause.STOP, ""),
    ],
)
def test_the_sentence_names_the_seat_that_pressed_stop(
    outcome: BoardOutcome, cause: StopCause, named: str
) -> None:
    _, text = motion_end(outcome, cause, ARMS, "ben")
    assert named in text
    assert bool(named) == ("ben" in text)


def test_an_unknown_outcome_is_a_contract_mismatch() -> None:
    reason, text = motion_end(99, StopCause.STOP, ARMS)
    assert reason is Reason.CONTRACT_MISMATCH
    assert "(99)" in text


def test_every_outcome_has_a_sentence() -> None:
    for outcome in BoardOutcome:
        if outcome is not BoardOutcome.NONE:
            _, text = motion_end(outcome, StopCause.STOP, ARMS)
            assert text[0].isupper()
            assert text.endswith(".")


@example(last=5, on_board=6)
@given(last=st.integers(0, NUMBERS), on_board=st.integers(0, NUMBERS))
def test_a_motion_number_is_neither_0_nor_the_last_one_nor_that_on_the_board(
    last: int, on_board: int
) -> None:
    number = next_number(last, on_board)
    assert 0 < number <= NUMBERS
    assert number not in (last, on_board)
