"""Check of the status by a client: whether a seat may move the robot."""

from __future__ import annotations

import msgspec
import pytest
from statuses import BOARD, READY

from beatrix_zenoh.client.twin_state import may_move
from beatrix_zenoh.contract._generated.messages import Fault, Reason
from beatrix_zenoh.contract.errors import BeatrixError

LOST = msgspec.structs.replace(BOARD, connected=False)


@pytest.mark.parametrize(("holder", "who"), [("", "ana"), ("ana", "ana"), ("ben", "teacher")])
def test_the_holder_or_the_teacher_may_move_a_ready_robot(holder: str, who: str) -> None:
    may_move(msgspec.structs.replace(READY, holder=holder), who)


@pytest.mark.parametrize(
    ("change", "reason", "text"),
    [
        ({"holder": "ben"}, Reason.NOT_HOLDER, "ben drives this robot"),
        ({"enabled": False}, Reason.NOT_ENABLED, "The motors are off"),
        ({"calibrated": False}, Reason.NOT_CALIBRATED, "Home is not known"),
        ({"enabled": False, "fault": Fault.EMERGENCY}, Reason.EMERGENCY, "EMERGENCY_STOP is latched"),
        ({"board": LOST, "fault": Fault.BOARD_LOST}, Reason.BOARD_LOST, "does not answer"),
        (
            {"board": LOST, "fault": Fault.CONTRACT_MISMATCH},
            Reason.CONTRACT_MISMATCH,
            "of another version",
        ),
        (
            {"board": LOST, "fault": Fault.BOARD_LOST, "warnings": ["The board is gone: plug it in."]},
            Reason.BOARD_LOST,
            "plug it in",
        ),
    ],
)
def test_the_first_missing_condition_is_raised(change: dict[str, object], reason: Reason, text: str) -> None:
    with pytest.raises(BeatrixError, match=text) as refusal:
        may_move(msgspec.structs.replace(READY, **change), "ana")
    assert refusal.value.reason is reason
