"""The lease that a seat takes: one decision in each test."""

from __future__ import annotations

import pytest
from access_callers import ANA, ANA_AGAIN, BEN, BOSS, CLEO, refusal

from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.errors import Refused
from beatrix_zenoh.contract.names import TEACHER
from beatrix_zenoh.contract.refusals import LINGER_S
from beatrix_zenoh.node.access import Access, Operation
from beatrix_zenoh.node.callers import IDLE_S, SETTLE_S, WAITING_MAX, Caller
from beatrix_zenoh.node.lease_queries import give_back, standing, take


@pytest.fixture
def access() -> Access:
    return Access()


def test_only_a_free_robot_can_be_taken(access: Access) -> None:
    assert take(access, ANA, 0) == 1
    with pytest.raises(Refused) as refused:
        take(access, BEN, 1)
    assert refused.value.detail is not None
    assert (refused.value.reason, refused.value.detail.holder) == (Reason.NOT_HOLDER, "ana")


def test_a_robot_that_another_seat_moves_is_not_free(access: Access) -> None:
    access.take(BEN)
    with pytest.raises(Refused):
        take(access, ANA, 0)
    access.rested(1)
    assert take(access, ANA, 1 + LINGER_S) == 1


def test_the_same_session_keeps_its_number_and_another_gets_a_new_one(access: Access) -> None:
    assert [take(access, ANA, 0), take(access, ANA, 1), take(access, ANA_AGAIN, 2)] == [1, 1, 2]
    assert refusal(access, ANA, 3, lease=1) is Reason.NOT_HOLDER, "the number of an earlier lease"
    assert refusal(access, ANA_AGAIN, 3, lease=2) is Reason.OK


def test_the_teacher_takes_a_robot_from_its_holder(access: Access) -> None:
    take(access, ANA, 0)
    assert take(access, BOSS, 1) == 2
    assert refusal(access, ANA, 1, lease=1) is Reason.NOT_HOLDER
    assert standing(access, 1).holder == TEACHER


def test_a_lease_ends_with_its_session_and_the_first_waiting_seat_gets_the_robot(access: Access) -> None:
    take(access, ANA, 0)
    assert take(access, BEN, 1, wait=True) == take(access, CLEO, 2, wait=True) == 0
    assert standing(access, 3).waiting == ("ben", "cleo")
    access.session_changed(BEN, 4, alive=False)
    access.session_changed(ANA, 4, alive=False)
    assert not access.give_up_sessions(4 + SETTLE_S / 2)
    now = standing(access, 4 + SETTLE_S / 2)
    assert (now.holder, now.lease, now.waiting) == ("ana", 1, ("ben", "cleo"))
    access.give_up_sessions(4 + SETTLE_S)
    now = standing(access, 4 + SETTLE_S)
    assert (now.holder, now.lease, now.waiting) == ("cleo", 2, ())


def test_a_motion_with_the_number_of_an_ended_lease_is_refused(access: Access) -> None:
    take(access, ANA, 0)
    give_back(access, ANA)
    assert refusal(access, ANA, 1) is Reason.OK
    assert refusal(access, ANA, 1, lease=1) is Reason.NOT_HOLDER


def test_an_idle_holder_loses_the_robot_only_to_a_seat_that_waits(access: Access) -> None:
    take(access, ANA, 0)
    assert standing(access, 2 * IDLE_S).holder == "ana"
    take(access, BEN, 2 * IDLE_S, wait=True)
    assert standing(access, 2 * IDLE_S).holder == "ben"


def test_a_holder_that_moves_is_not_idle(access: Access) -> None:
    take(access, ANA, 0)
    access.lease.turn.limit_s = 2000
    take(access, BEN, 1, wait=True)
    access.take(ANA)
    assert standing(access, 1000).holder == "ana"
    access.authorize(Operation.MOVE, ANA, 1000)
    access.rested(1001)
    assert standing(access, 1000 + IDLE_S - 1).holder == "ana"
    assert standing(access, 1001 + IDLE_S).holder == "ben"


def test_give_back_removes_a_waiting_seat_from_the_queue(access: Access) -> None:
    take(access, ANA, 0)
    take(access, BEN, 0, wait=True)
    assert give_back(access, BEN)
    assert not give_back(access, BEN)
    assert standing(access, 0).waiting == ()


def test_the_teacher_ends_the_lease_of_a_seat(access: Access) -> None:
    take(access, ANA, 0)
    assert give_back(access, BOSS)
    assert standing(access, 0).holder == ""


def test_the_queue_is_bounded(access: Access) -> None:
    take(access, ANA, 0)
    for number in range(WAITING_MAX):
        take(access, Caller(f"s{number}", ""), 0, wait=True)
    take(access, Caller("s0", ""), 0, wait=True)
    with pytest.raises(Refused) as refused:
        take(access, BEN, 0, wait=True)
    assert refused.value.reason is Reason.BUSY


def test_take_is_refused_if_the_robot_was_frozen_since_authorize(access: Access) -> None:
    access.authorize(Operation.MOVE, ANA, 0)
    access.teacher.frozen = True
    with pytest.raises(Refused) as refused:
        access.take(ANA)
    assert refused.value.reason is Reason.FROZEN
    access.teacher.frozen = False
    access.take(ANA)
