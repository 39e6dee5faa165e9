"""Access rules, one by one."""

from __future__ import annotations

import pytest
from access_callers import ANA, ANA_AGAIN, BEN, BOSS, NO_SESSION, OLD, begin_motion, finish_motion, refusal

from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.errors import Refused
from beatrix_zenoh.contract.refusals import LINGER_S
from beatrix_zenoh.node.access import Access, Operation
from beatrix_zenoh.node.callers import ENDED_SESSIONS, Caller


@pytest.fixture
def access() -> Access:
    return Access()


# -- lease ---------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("caller", "action", "reason"),
    [
        (ANA, Operation.MOVE, Reason.OK),
        (ANA_AGAIN, Operation.MOVE, Reason.OK),
        (BEN, Operation.MOVE, Reason.NOT_HOLDER),
        (BEN, Operation.ENABLE, Reason.NOT_HOLDER),
        (BEN, Operation.DISABLE, Reason.NOT_HOLDER),
        (BEN, Operation.CALIBRATE, Reason.NOT_HOLDER),
        (BEN, Operation.STOP, Reason.OK),
        (BEN, Operation.EMERGENCY_STOP, Reason.OK),
        (BEN, Operation.RESET, Reason.OK),
        (BOSS, Operation.MOVE, Reason.OK),
        (OLD, Operation.MOVE, Reason.NOT_HOLDER),
    ],
)
def test_actions_of_each_caller_while_ana_holds_the_robot(
    access: Access, caller: Caller, action: Operation, reason: Reason
) -> None:
    assert refusal(begin_motion(access, ANA, 0), caller, 100, action) is reason


def test_the_refusal_has_the_holder_and_the_waiting_time(access: Access) -> None:
    finish_motion(access, ANA, 10)
    with pytest.raises(Refused) as refused:
        access.authorize(Operation.MOVE, BEN, 10.5)
    assert refused.value.detail is not None
    assert refused.value.detail.holder == "ana"
    assert refused.value.detail.wait_s == pytest.approx(LINGER_S - 0.5)


def test_the_lease_ends_exactly_linger_s_after_the_motion(access: Access) -> None:
    finish_motion(access, ANA, 10)
    assert access.lease.holder(10 + LINGER_S - 0.001) == "ana"
    assert refusal(access, BEN, 10 + LINGER_S - 0.001) is Reason.NOT_HOLDER
    assert access.lease.holder(10 + LINGER_S) == ""
    assert refusal(access, BEN, 10 + LINGER_S) is Reason.OK


def test_undo_take_restores_the_previous_lease(access: Access) -> None:
    begin_motion(access, ANA, 0)
    access.undo_take()
    assert access.lease.holder(1) == ""
    finish_motion(access, ANA, 2)
    begin_motion(access, ANA, 3.5)
    access.undo_take()
    assert access.lease.holder(2 + LINGER_S - 0.1) == "ana"
    assert access.lease.holder(2 + LINGER_S) == "", "the end of the lease has not changed"


# -- emergency latch ----------------------------------------------------------------------------


@pytest.mark.parametrize("caller", [ANA, BEN, BOSS, OLD, NO_SESSION], ids=lambda caller: caller.seat)
@pytest.mark.parametrize(
    ("action", "reason"),
    [
        (Operation.MOVE, Reason.EMERGENCY),
        (Operation.ENABLE, Reason.EMERGENCY),
        (Operation.CALIBRATE, Reason.EMERGENCY),
        (Operation.DISABLE, Reason.OK),
        (Operation.STOP, Reason.OK),
        (Operation.EMERGENCY_STOP, Reason.OK),
        (Operation.RESET, Reason.OK),
    ],
)
def test_actions_under_the_emergency_latch(
    access: Access, caller: Caller, action: Operation, reason: Reason
) -> None:
    begin_motion(access, ANA, 0).stop_pressed(BEN, 1, emergency=True)
    access.stop_sent(1)
    assert refusal(access, caller, 100, action) is reason


def test_the_refusal_under_the_latch_lists_reset_first(access: Access) -> None:
    access.latch(0)
    with pytest.raises(Refused) as refused:
        access.authorize(Operation.ENABLE, ANA, 1)
    assert refused.value.detail is not None
    assert refused.value.detail.needs[0] == "RESET"


def test_only_reset_clears_the_latch(access: Access) -> None:
    access.stop_pressed(ANA, 1, emergency=True)
    access.stop_pressed(ANA, 2)
    access.stop_sent(2)
    assert access.latched
    access.reset(3)
    assert not access.latched
    assert refusal(access, ANA, 3, Operation.ENABLE) is Reason.OK


def test_a_reset_received_before_the_emergency_stop_does_not_clear_it(access: Access) -> None:
    access.stop_pressed(BEN, 5, emergency=True)
    with pytest.raises(Refused) as refused:
        access.reset(4.9)
    assert refused.value.reason is Reason.EMERGENCY
    assert access.latched


def test_take_is_refused_if_emergency_stop_was_pressed_since_authorize(access: Access) -> None:
    access.authorize(Operation.MOVE, ANA, 0)
    access.stop_pressed(BEN, 0, emergency=True)
    with pytest.raises(Refused) as refused:
        access.take(ANA)
    assert refused.value.reason is Reason.EMERGENCY


# -- sessions -----------------------------------------------------------------------------------


def test_requests_of_an_ended_session_are_refused_until_it_is_back(access: Access) -> None:
    assert not access.session_changed(ANA, 0, alive=False)
    assert refusal(access, ANA, 0) is Reason.CLIENT_LOST
    assert refusal(access, ANA, 0, Operation.ENABLE) is Reason.CLIENT_LOST
    assert refusal(access, ANA, 0, Operation.STOP) is Reason.OK
    access.session_changed(ANA, 0, alive=True)
    assert refusal(access, ANA, 0) is Reason.OK


def test_only_the_end_of_the_moving_session_is_a_lost_client(access: Access) -> None:
    begin_motion(access, ANA, 0)
    assert not access.session_changed(BEN, 0, alive=False)
    assert not access.session_changed(ANA, 0, alive=True)
    assert access.session_changed(ANA, 0, alive=False)


def test_the_end_of_a_token_of_another_seat_ends_no_session(access: Access) -> None:
    begin_motion(access, ANA, 0)
    assert not access.session_changed(Caller("ben", ANA.session), 0, alive=False)
    assert refusal(access, ANA, 0) is Reason.OK


def test_only_the_newest_ended_sessions_are_remembered(access: Access) -> None:
    for number in range(ENDED_SESSIONS + 1):
        access.session_changed(Caller("x", f"s{number}"), 0, alive=False)
    assert refusal(access, Caller("x", "s0"), 0) is Reason.OK
    assert refusal(access, Caller("x", "s1"), 0) is Reason.CLIENT_LOST
