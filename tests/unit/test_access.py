"""Access rules, one by one; the last ones are decisions of the teacher."""

from __future__ import annotations

import itertools
from collections.abc import Callable

import pytest
from access_callers import ANA, ANA_AGAIN, BEN, BOSS, NO_SESSION, OLD, begin_motion, refusal

from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.errors import Refused
from beatrix_zenoh.contract.names import TEACHER
from beatrix_zenoh.contract.refusals import LINGER_S
from beatrix_zenoh.node.access import Access, Operation
from beatrix_zenoh.node.callers import Caller
from beatrix_zenoh.node.lease_queries import end_turn, mute, take
from sim_node.following.arms import follows


@pytest.fixture
def access() -> Access:
    return Access()


def freeze(access: Access) -> None:
    access.teacher.frozen = True


def latch(access: Access) -> None:
    begin_motion(access, ANA, 0).stop_pressed(BEN, 1, emergency=True)
    access.stop_sent(1)


def follow(access: Access) -> None:
    access.following = True


SITUATIONS: dict[str, Callable[[Access], object]] = {
    "ana moves it": lambda access: begin_motion(access, ANA, 0),
    "ana has taken it": lambda access: take(access, ANA, 0),
    "latched": latch,
    "frozen": freeze,
    "follows": follow,
}
MOVE, ENABLE, DISABLE, CALIBRATE = Operation.MOVE, Operation.ENABLE, Operation.DISABLE, Operation.CALIBRATE
FOLLOW, LEASE, RESET = Operation.FOLLOW, Operation.LEASE, Operation.RESET
STOPS, EVERYONE = (Operation.STOP, Operation.EMERGENCY_STOP), (ANA, BEN, BOSS, OLD, NO_SESSION)


@pytest.mark.parametrize(
    ("situation", "callers", "actions", "reason"),
    [
        ("ana moves it", (ANA, ANA_AGAIN, BOSS), (MOVE, FOLLOW), Reason.OK),
        ("ana moves it", (BEN,), (MOVE, ENABLE, DISABLE, CALIBRATE, FOLLOW, LEASE), Reason.NOT_HOLDER),
        ("ana moves it", (OLD,), (MOVE,), Reason.NOT_HOLDER),
        ("ana moves it", (BEN,), (*STOPS, RESET), Reason.OK),
        ("ana has taken it", (ANA, ANA_AGAIN, BOSS), (MOVE,), Reason.OK),
        ("ana has taken it", (BEN,), (MOVE, ENABLE, CALIBRATE, LEASE), Reason.NOT_HOLDER),
        ("ana has taken it", (BEN,), STOPS, Reason.OK),
        ("latched", EVERYONE, (MOVE, ENABLE, CALIBRATE, FOLLOW), Reason.EMERGENCY),
        ("latched", EVERYONE, (DISABLE, *STOPS, RESET), Reason.OK),
        ("frozen", (ANA,), (MOVE, ENABLE, CALIBRATE, DISABLE, FOLLOW), Reason.FROZEN),
        ("frozen", (ANA,), STOPS, Reason.OK),
        ("frozen", (ANA,), (Operation.GOVERN,), Reason.TEACHER_ONLY),
        ("frozen", (BOSS,), (MOVE, Operation.GOVERN), Reason.OK),
        ("follows", (ANA, BOSS, OLD), (MOVE, CALIBRATE), Reason.FOLLOWING),
        ("follows", (ANA, BOSS, OLD), (ENABLE, DISABLE, FOLLOW, LEASE, *STOPS), Reason.OK),
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
    begin_motion(access, ANA, 10).rested(10)
    assert access.lease.holder(10 + LINGER_S - 0.001) == "ana"
    assert refusal(access, BEN, 10 + LINGER_S - 0.001) is Reason.NOT_HOLDER
    assert access.lease.holder(10 + LINGER_S) == ""
    assert refusal(access, BEN, 10 + LINGER_S) is Reason.OK


def test_undo_take_restores_the_previous_lease(access: Access) -> None:
    begin_motion(access, ANA, 0)
    access.undo_take()
    assert access.lease.holder(1) == ""
    begin_motion(access, ANA, 2).rested(2)
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
    assert refusal(access, ANA, 3, ENABLE) is Reason.OK


def test_a_reset_received_before_the_emergency_stop_does_not_clear_it(access: Access) -> None:
    access.stop_pressed(BEN, 5, emergency=True)
    with pytest.raises(Refused) as refused:
        access.reset(4.9)
    assert refused.value.reason is Reason.EMERGENCY
    assert access.latched


@pytest.mark.parametrize(
    ("meanwhile", "reason"),
    [
        (lambda access: access.stop_pressed(BEN, 0), Reason.STOPPED),
        (lambda access: access.stop_pressed(BEN, 0, emergency=True), Reason.EMERGENCY),
        (lambda access: mute(access, "ana", 0), Reason.MUTED),
        (freeze, Reason.FROZEN),
    ],
)
def test_take_is_refused_for_what_has_happened_since_authorize(
    access: Access, meanwhile: Callable[[Access], object], reason: Reason
) -> None:
    access.authorize(MOVE, ANA, 0)
    meanwhile(access)
    with pytest.raises(Refused) as refused:
        access.take(ANA)
    assert refused.value.reason is reason


# -- sessions -----------------------------------------------------------------------------------


def test_requests_of_an_ended_session_are_refused_until_it_is_back(access: Access) -> None:
    assert not access.session_changed(ANA, 0, alive=False)
    assert refusal(access, ANA, 0) is Reason.CLIENT_LOST
    assert refusal(access, ANA, 0, ENABLE) is Reason.CLIENT_LOST
    assert refusal(access, ANA, 0, Operation.STOP) is Reason.OK
    access.session_changed(ANA, 0, alive=True)
    assert refusal(access, ANA, 0) is Reason.OK


def test_only_the_end_of_the_moving_session_is_a_lost_client(access: Access) -> None:
    begin_motion(access, ANA, 0)
    assert not access.session_changed(BEN, 0, alive=False)
    assert not access.session_changed(Caller("ben", ANA.session), 0, alive=False), "a token of another seat"
    assert refusal(access, ANA, 0) is Reason.OK
    assert not access.session_changed(ANA, 0, alive=True)
    assert access.session_changed(ANA, 0, alive=False)


# -- a simulation that follows ----------------------------------------------------------------------


def test_stop_of_any_seat_ends_following_at_once(access: Access) -> None:
    follow(access)
    access.stop_pressed(BEN, 1)
    assert not follows(access)


def test_freeze_ends_following(access: Access) -> None:
    follow(access)
    access.teacher.frozen = True
    assert not follows(access)
    access.teacher.frozen = False
    assert not follows(access), "it does not begin again by itself"


def test_each_motion_that_follows_counts_so_that_a_stop_is_not_taken_for_a_repetition(access: Access) -> None:
    follow(access)
    before = access.begun
    assert follows(access)
    assert access.begun == before + 1


# -- decisions of the teacher -----------------------------------------------------------------------


@pytest.mark.parametrize("pressers", [(BOSS,), (BEN, BOSS), (BOSS, BEN)], ids=str)
def test_only_the_teacher_resets_an_emergency_stop_of_the_teacher(
    access: Access, pressers: tuple[Caller, ...]
) -> None:
    for presser in pressers:
        access.stop_pressed(presser, 1, emergency=True)
    assert refusal(access, ANA, 2, RESET) is Reason.TEACHER_ONLY
    with pytest.raises(Refused, match="Wait until the teacher resets"):
        access.authorize(ENABLE, ANA, 2)
    assert refusal(access, BOSS, 2, RESET) is Reason.OK
    access.reset(2)
    access.stop_pressed(BEN, 3, emergency=True)
    assert refusal(access, ANA, 3, RESET) is Reason.OK, "the emergency stop of a student"


def test_while_the_robot_is_frozen_only_the_teacher_resets_and_every_seat_may_press_emergency_stop(
    access: Access,
) -> None:
    access.teacher.frozen = True
    access.stop_pressed(BEN, 1, emergency=True)
    assert access.latched
    assert refusal(access, ANA, 2, RESET) is Reason.FROZEN
    assert refusal(access, BOSS, 2, RESET) is Reason.OK


@pytest.mark.parametrize("action", [action for action in Operation if action is not Operation.GOVERN])
def test_requests_of_a_muted_seat_are_refused(access: Access, action: Operation) -> None:
    mute(access, "ana", 0)
    for session in (ANA, ANA_AGAIN):
        assert refusal(access, session, 1, action) is (Reason.OK if action in STOPS else Reason.MUTED)
    access.teacher.muted -= {"ana"}
    assert refusal(access, ANA, 1, action) is Reason.OK


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
    ("end", "presser"),
    [
        (lambda access: end_turn(access, 1), TEACHER),
        (lambda access: access.lease.take(BOSS, 1), TEACHER),
        (lambda access: access.lease.give_back(ANA), ""),
        (lambda access: access.lease.give_back(ANA) and access.lease.take(BOSS, 1), ""),
    ],
)
def test_a_refusal_says_whether_the_teacher_has_ended_a_lease(
    access: Access, end: Callable[[Access], object], presser: str
) -> None:
    number = access.lease.take(ANA, 0)
    end(access)
    with pytest.raises(Refused) as refused:
        access.authorize(MOVE, ANA, 2, lease=number)
    assert refused.value.reason is Reason.NOT_HOLDER
    assert refused.value.detail is not None
    assert (refused.value.detail.value, refused.value.detail.presser) == (number, presser)
