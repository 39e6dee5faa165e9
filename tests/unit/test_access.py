"""Access rules, one by one."""

from __future__ import annotations

import itertools
from collections.abc import Callable

import pytest
from access_callers import (
    ANA,
    ANA_AGAIN,
    BEN,
    BOSS,
    NO_SESSION,
    OLD,
    begin_motion,
    finish_motion,
    refusal,
)

from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.errors import Refused
from beatrix_zenoh.contract.refusals import LINGER_S
from beatrix_zenoh.node.access import Access, Operation
from beatrix_zenoh.node.callers import Caller
from beatrix_zenoh.node.lease_queries import mute, take
from sim_node.following.arms import follows


@pytest.fixture
def access() -> Access:
    return Access()


def follow(access: Access) -> None:
    access.following = True


def freeze(access: Access) -> None:
    access.teacher.frozen = True


def latch(access: Access) -> None:
    begin_motion(access, ANA, 0).stop_pressed(BEN, 1, emergency=True)
    access.stop_sent(1)


SITUATIONS: dict[str, Callable[[Access], object]] = {
    "ana moves it": lambda access: begin_motion(access, ANA, 0),
    "ana has taken it": lambda access: take(access, ANA, 0),
    "latched": latch,
    "frozen": freeze,
    "follows": follow,
}
MOVE, ENABLE, DISABLE, CALIBRATE = Operation.MOVE, Operation.ENABLE, Operation.DISABLE, Operation.CALIBRATE
STOPS, EVERYONE = (Operation.STOP, Operation.EMERGENCY_STOP), (ANA, BEN, BOSS, OLD, NO_SESSION)


@pytest.mark.parametrize(
    ("situation", "callers", "actions", "reason"),
    [
        ("ana moves it", (ANA, ANA_AGAIN, BOSS), (MOVE,), Reason.OK),
        ("ana moves it", (BEN,), (MOVE, ENABLE, DISABLE, CALIBRATE), Reason.NOT_HOLDER),
        ("ana moves it", (OLD,), (MOVE,), Reason.NOT_HOLDER),
        ("ana moves it", (BEN,), (*STOPS, Operation.RESET), Reason.OK),
        ("ana has taken it", (ANA, ANA_AGAIN, BOSS), (MOVE,), Reason.OK),
        ("ana has taken it", (BEN,), (MOVE, ENABLE, CALIBRATE), Reason.NOT_HOLDER),
        ("ana has taken it", (BEN,), STOPS, Reason.OK),
        ("latched", EVERYONE, (MOVE, ENABLE, CALIBRATE, Operation.FOLLOW), Reason.EMERGENCY),
        ("latched", EVERYONE, (DISABLE, *STOPS, Operation.RESET), Reason.OK),
        ("frozen", (ANA,), (MOVE, ENABLE, CALIBRATE, DISABLE, Operation.FOLLOW), Reason.FROZEN),
        ("frozen", (ANA,), STOPS, Reason.OK),
        ("frozen", (ANA,), (Operation.GOVERN,), Reason.TEACHER_ONLY),
        ("frozen", (BOSS,), (MOVE, Operation.GOVERN), Reason.OK),
        ("follows", (ANA, BOSS, OLD), (MOVE, CALIBRATE), Reason.FOLLOWING),
        (
            "follows",
            (ANA, BOSS, OLD),
            (ENABLE, DISABLE, Operation.FOLLOW, Operation.LEASE, *STOPS),
            Reason.OK,
        ),
    ],
)
def test_each_situation_allows_callers_their_actions(
    situation: str, callers: tuple[Caller, ...], actions: tuple[Operation, ...], reason: Reason
) -> None:
    access = Access()
    SITUATIONS[situation](access)
    for caller, action in itertools.product(callers, actions):
        assert refusal(access, caller, 1000, action) is reason, (caller, action)


# -- lease ---------------------------------------------------------------------------------------


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


@pytest.mark.parametrize(
    ("meanwhile", "reason"),
    [
        (lambda access: access.stop_pressed(BEN, 0, emergency=True), Reason.EMERGENCY),
        (lambda access: mute(access, "ana", 0), Reason.MUTED),
        (freeze, Reason.FROZEN),
    ],
)
def test_take_is_refused_for_what_has_happened_since_authorize(
    access: Access, meanwhile: Callable[[Access], object], reason: Reason
) -> None:
    access.authorize(Operation.MOVE, ANA, 0)
    meanwhile(access)
    with pytest.raises(Refused) as refused:
        access.take(ANA)
    assert refused.value.reason is reason


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


# -- a simulation that follows ----------------------------------------------------------------------


@pytest.fixture
def following() -> Access:
    """A simulation that follows."""
    made = Access()
    made.following = True
    return made


def test_stop_of_any_seat_ends_following_at_once(following: Access) -> None:
    following.stop_pressed(BEN, 1)
    assert not following.following
    assert not follows(following)


def test_freeze_ends_following(following: Access) -> None:
    following.teacher.frozen = True
    assert not follows(following)
    following.teacher.frozen = False
    assert not follows(following), "it does not begin again by itself"


def test_each_motion_that_follows_counts_so_that_a_stop_is_not_taken_for_a_repetition(
    following: Access,
) -> None:
    before = following.begun
    assert follows(following)
    assert following.begun == before + 1


@pytest.mark.parametrize(("seat", "reason"), [(ANA, Reason.OK), (BEN, Reason.NOT_HOLDER), (BOSS, Reason.OK)])
def test_a_seat_that_does_not_hold_the_robot_cannot_switch_following(seat: Caller, reason: Reason) -> None:
    access = finish_motion(Access(), ANA, 1)
    assert refusal(access, seat, 1 + LINGER_S / 2, Operation.FOLLOW) is reason


def test_following_begins_only_after_a_stopped_motion_has_come_to_rest() -> None:
    access = begin_motion(Access(), ANA, 1)
    access.stop_pressed(BEN, 2)
    assert refusal(access, ANA, 2.1, Operation.FOLLOW, resting=False) is Reason.STOPPED
    access.stop_sent(2.2)
    access.rested(2.3)
    assert refusal(access, ANA, 2.4, Operation.FOLLOW) is Reason.OK
