"""Access rules of a simulation that follows the hardware."""

from __future__ import annotations

import pytest
from access_callers import ANA, BEN, BOSS, OLD, begin_motion, finish_motion, refusal, stop

from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.refusals import LINGER_S
from beatrix_zenoh.node.access import Access, Operation
from beatrix_zenoh.node.callers import Caller
from sim_node.following.robots import follows


@pytest.fixture
def access() -> Access:
    """A simulation that follows."""
    made = Access()
    made.following = True
    return made


@pytest.mark.parametrize("caller", [ANA, BOSS, OLD])
@pytest.mark.parametrize(
    ("action", "reason"),
    [
        (Operation.MOVE, Reason.FOLLOWING),
        (Operation.CALIBRATE, Reason.FOLLOWING),
        (Operation.ENABLE, Reason.OK),
        (Operation.DISABLE, Reason.OK),
        (Operation.FOLLOW, Reason.OK),
        (Operation.LEASE, Reason.OK),
        (Operation.STOP, Reason.OK),
        (Operation.EMERGENCY_STOP, Reason.OK),
    ],
)
def test_only_motions_and_calibrate_are_refused_while_it_follows(
    access: Access, caller: Caller, action: Operation, reason: Reason
) -> None:
    assert refusal(access, caller, 1, action) is reason


def test_stop_of_any_seat_ends_following_at_once(access: Access) -> None:
    access.stop_pressed(BEN, 1)
    assert not access.following
    assert not follows(access)


def test_freeze_ends_following(access: Access) -> None:
    access.teacher.frozen = True
    assert not follows(access)
    access.teacher.frozen = False
    assert not follows(access), "it does not begin again by itself"


def test_each_motion_that_follows_counts_so_that_a_stop_is_not_taken_for_a_repetition(access: Access) -> None:
    before = access.begun
    assert follows(access)
    assert access.begun == before + 1


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


def test_a_frozen_latched_or_muted_seat_cannot_switch_following() -> None:
    frozen, latched, muted = Access(), Access(), Access()
    frozen.teacher.frozen = True
    latched.latch(1)
    muted.teacher.muted = frozenset({"ana"})
    reasons = [refusal(one, ANA, 2, Operation.FOLLOW) for one in (frozen, latched, muted)]
    assert reasons == [Reason.FROZEN, Reason.EMERGENCY, Reason.MUTED]


def test_stop_then_motions_are_accepted_again(access: Access) -> None:
    stop(access, BOSS, 1)
    assert refusal(access, ANA, 5) is Reason.OK
