"""Access rules: freeze, mute, the end of a turn, and the latch that the teacher has set."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from access_callers import ANA, ANA_AGAIN, BEN, BOSS, begin_motion, refusal

from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.errors import Refused
from beatrix_zenoh.node.access import Access, Operation
from beatrix_zenoh.node.callers import Caller
from beatrix_zenoh.node.lease_queries import end_turn, mute


@pytest.fixture
def access() -> Access:
    return Access()


@pytest.mark.parametrize("pressers", [(BOSS,), (BEN, BOSS), (BOSS, BEN)], ids=str)
def test_only_the_teacher_resets_an_emergency_stop_of_the_teacher(
    access: Access, pressers: tuple[Caller, ...]
) -> None:
    for presser in pressers:
        access.stop_pressed(presser, 1, emergency=True)
    assert refusal(access, ANA, 2, Operation.RESET) is Reason.TEACHER_ONLY
    with pytest.raises(Refused, match="Wait until the teacher resets"):
        access.authorize(Operation.ENABLE, ANA, 2)
    assert refusal(access, BOSS, 2, Operation.RESET) is Reason.OK
    access.reset(2)
    assert refusal(access, ANA, 3, Operation.RESET) is Reason.OK


def test_every_seat_resets_the_emergency_stop_of_a_student(access: Access) -> None:
    access.stop_pressed(BEN, 1, emergency=True)
    assert refusal(access, ANA, 2, Operation.RESET) is Reason.OK


def test_while_the_robot_is_frozen_only_the_teacher_resets_and_every_seat_may_press_emergency_stop(
    access: Access,
) -> None:
    access.teacher.frozen = True
    access.stop_pressed(BEN, 1, emergency=True)
    assert access.latched
    assert refusal(access, ANA, 2, Operation.RESET) is Reason.FROZEN
    assert refusal(access, BOSS, 2, Operation.RESET) is Reason.OK


# -- mute ---------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("action", "muted"),
    [(action, action not in (Operation.STOP, Operation.EMERGENCY_STOP)) for action in Operation],
)
def test_requests_of_a_muted_seat_are_refused(access: Access, action: Operation, muted: bool) -> None:
    mute(access, "ana", 0)
    expected = Reason.TEACHER_ONLY if action is Operation.GOVERN else Reason.MUTED if muted else Reason.OK
    assert refusal(access, ANA, 1, action) is expected
    assert refusal(access, ANA_AGAIN, 1, action) is expected
    access.teacher.muted -= {"ana"}
    assert refusal(access, ANA, 1, action) is (
        Reason.TEACHER_ONLY if action is Operation.GOVERN else Reason.OK
    )


@pytest.mark.parametrize("emergency", [False, True])
def test_the_stop_of_a_muted_seat_stops_no_other_seat(access: Access, emergency: bool) -> None:
    begin_motion(access, BEN, 0)
    mute(access, "ana", 0)
    with pytest.raises(Refused, match="nothing of yours moves") as refused:
        access.stop_pressed(ANA, 1, emergency=emergency)
    assert refused.value.reason is Reason.MUTED
    assert not access.latched
    assert refusal(access, BEN, 1.1) is Reason.OK, "the stream goes on"


def test_the_end_of_a_turn_gives_the_robot_to_the_next_seat_although_the_last_one_moves(
    access: Access,
) -> None:
    begin_motion(access, ANA, 0)
    access.lease.wait(BEN, 0)
    end_turn(access, 1)
    assert access.lease.holder(1) == "ben"
    assert refusal(access, ANA, 1.1) is Reason.NOT_HOLDER


@pytest.mark.parametrize(
    ("enders", "presser"),
    [("end_turn", "teacher"), ("take", "teacher"), ("give_back", ""), ("give_back take", "")],
)
def test_a_refusal_says_whether_the_teacher_has_ended_a_lease(
    access: Access, enders: str, presser: str
) -> None:
    number = access.lease.take(ANA, 0)
    ways: dict[str, Callable[[], object]] = {
        "end_turn": lambda: end_turn(access, 1),
        "take": lambda: access.lease.take(BOSS, 1),
        "give_back": lambda: access.lease.give_back(ANA),
    }
    for way in enders.split():
        ways[way]()
    with pytest.raises(Refused) as refused:
        access.authorize(Operation.MOVE, ANA, 2, lease=number)
    assert refused.value.reason is Reason.NOT_HOLDER
    assert refused.value.detail is not None
    assert (refused.value.detail.value, refused.value.detail.presser) == (number, presser)
