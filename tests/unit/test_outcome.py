"""What people are told of a motion that has ended."""

from __future__ import annotations

import pytest

from beatrix_zenoh._generated.messages import Reason
from beatrix_zenoh._generated.serial import Outcome
from beatrix_zenoh.node import outcome

ARMS = (0.1, 0.0, -0.1)
WHERE = "5.7, 0.0, -5.7 deg"


@pytest.mark.parametrize(
    ("how", "cause", "reason", "told"),
    [
        (Outcome.DONE, Reason.STOPPED, Reason.OK, f"There: arms at {WHERE}."),
        (Outcome.STOPPED, Reason.STOPPED, Reason.STOPPED, f"Ended by STOP; the arms rest at {WHERE}."),
        (
            Outcome.STOPPED,
            Reason.SHUTDOWN,
            Reason.SHUTDOWN,
            "Ended by its node, which is closing; the arms rest",
        ),
        (
            Outcome.STOPPED,
            Reason.CLIENT_LOST,
            Reason.CLIENT_LOST,
            "nobody who asked for it is heard any more",
        ),
        (Outcome.HOST_LOST, Reason.STOPPED, Reason.HOST_LOST, "did not hear its node for half a second"),
        (Outcome.GAP, Reason.STOPPED, Reason.ARM_GAP, "Ended by the guard: arms came too close"),
    ],
)
def test_reason_and_sentence_agree(how: Outcome, cause: Reason, reason: Reason, told: str) -> None:
    why, text = outcome.ended(how, cause, ARMS)
    assert why is reason
    assert told in text


@pytest.mark.parametrize("how", [Outcome.DISABLED, Outcome.EMERGENCY])
def test_arms_without_power_are_not_said_to_rest(how: Outcome) -> None:
    _, text = outcome.ended(how, Reason.STOPPED, ARMS)
    assert "rest" not in text
    assert (
        f"The arms were at {WHERE}; without power the head may have sunk: set it upright, enable, calibrate."
        in text
    )


def test_an_ending_of_another_firmware_is_told_as_such() -> None:
    reason, text = outcome.ended(99, Reason.STOPPED, ARMS)
    assert reason is Reason.CONTRACT_MISMATCH
    assert "(99)" in text


def test_every_ending_has_a_sentence() -> None:
    for how in Outcome:
        if how is not Outcome.NONE:
            _, text = outcome.ended(how, Reason.STOPPED, ARMS)
            assert text[0].isupper()
            assert text.endswith(".")


def test_who_loses_a_board_in_mid_move_knows_what_it_does() -> None:
    assert "half a second" in outcome.lost(reset=False)
    assert "calibrate" in outcome.lost(reset=True)
