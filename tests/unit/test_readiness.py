"""Whether a robot may move, seen from its status: as the robot itself would say."""

from __future__ import annotations

import msgspec
import pytest
from statuses import BOARD, READY

from beatrix_zenoh._generated.messages import Fault, Reason
from beatrix_zenoh.errors import BeatrixError
from beatrix_zenoh.twin import may_move

LOST = msgspec.structs.replace(BOARD, connected=False)


@pytest.mark.parametrize(("holder", "who"), [("", "ana"), ("ana", "ana"), ("ben", "teacher")])
def test_who_holds_it_or_may_take_it_moves_a_ready_robot(holder: str, who: str) -> None:
    may_move(msgspec.structs.replace(READY, holder=holder), who)


@pytest.mark.parametrize(
    ("change", "reason", "said"),
    [
        ({"holder": "ben"}, Reason.NOT_HOLDER, "ben drives this robot"),
        ({"enabled": False}, Reason.NOT_ENABLED, "The motors are off"),
        ({"calibrated": False}, Reason.NOT_CALIBRATED, "Home is not known"),
        ({"enabled": False, "fault": Fault.EMERGENCY}, Reason.NOT_ENABLED, "The emergency stop is latched"),
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
def test_the_first_that_is_missing_is_said(change: dict[str, object], reason: Reason, said: str) -> None:
    with pytest.raises(BeatrixError, match=said) as refusal:
        may_move(msgspec.structs.replace(READY, **change), "ana")
    assert refusal.value.reason is reason
