"""The lease that a seat takes: one decision in each test."""

from __future__ import annotations

import pytest
from access_callers import ANA, ANA_AGAIN, BEN, BOSS, CLEO, refusal

from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.errors import Refused
from beatrix_zenoh.contract.names import TEACHER
from beatrix_zenoh.node.access import Access, Operation
from beatrix_zenoh.node.callers import Caller
from beatrix_zenoh.node.known_sessions import SETTLE_S
from beatrix_zenoh.node.lease_queries import standing, take
from beatrix_zenoh.node.leases import IDLE_S, TURN_S, WAITING_MAX, Terms


@pytest.fixture
def access() -> Access:
    return Access()


def test_only_a_free_robot_can_be_taken(access: Access) -> None:
    assert take(access, ANA, 0) == 1
    with pytest.raises(Refused) as refused:
        take(access, BEN, 1)
    assert refused.value.detail is not None
    assert (refused.value.reason, refused.value.detail.holder) == (Reason.NOT_HOLDER, "ana")


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
    access.session_changed(BEN, 4, alive=False)
    access.session_changed(ANA, 4, alive=False)
    assert not access.give_up_sessions(4 + SETTLE_S / 2)
    assert standing(access, 4 + SETTLE_S / 2)[:3] == ("ana", 1, ["ben", "cleo"])
    access.give_up_sessions(4 + SETTLE_S)
    assert standing(access, 4 + SETTLE_S)[:3] == ("cleo", 2, [])


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


def test_a_seat_gives_back_its_own_place_only_and_the_teacher_that_of_the_holder(access: Access) -> None:
    take(access, ANA, 0)
    take(access, BEN, 0, wait=True)
    assert access.lease.give_back(BEN)
    assert not access.lease.give_back(BEN)
    assert standing(access, 0)[:3] == ("ana", 1, [])
    assert access.lease.give_back(BOSS)
    assert standing(access, 0).holder == ""


def test_the_queue_is_bounded(access: Access) -> None:
    take(access, ANA, 0)
    for number in range(WAITING_MAX):
        take(access, Caller(f"s{number}", ""), 0, wait=True)
    take(access, Caller("s0", ""), 0, wait=True)
    with pytest.raises(Refused) as refused:
        take(access, BEN, 0, wait=True)
    assert refused.value.reason is Reason.BUSY


# -- the time limit of a turn: which turns end, when, and who gets the robot then ------------------


NUDGE_S = 20.0
"""Shorter than the idle time, so that the holder is never idle."""


def nudge(access: Access, caller: Caller, begin_s: float, end_s: float) -> float:
    """Let a seat move the robot again and again; return the time (s) at which it was refused first, or `end_s`."""
    now_s = begin_s
    while now_s < end_s:
        if refusal(access, caller, now_s) is not Reason.OK:
            return now_s
        now_s += NUDGE_S
    return end_s


def test_nudging_does_not_keep_the_robot_from_a_waiting_seat(access: Access) -> None:
    take(access, ANA, 0)
    nudge(access, ANA, 0, 500)
    take(access, BEN, 500, wait=True)
    assert standing(access, 500).turn_s == TURN_S, "the time counts from the moment another seat waits"
    assert nudge(access, ANA, 500, 900) == 500 + TURN_S
    assert standing(access, 500 + TURN_S).holder == "ben"
    assert access.lease.turn.over == "ana"


def test_a_seat_that_only_moves_the_robot_has_a_turn_too(access: Access) -> None:
    access.take(ANA)
    assert take(access, BEN, 10, wait=True) == 0
    assert standing(access, 10 + TURN_S - 1).holder == "ana"
    assert standing(access, 10 + TURN_S).holder == "ben"
    assert access.lease.turn.over == "ana"


def test_the_next_turn_has_its_full_time(access: Access) -> None:
    take(access, ANA, 0)
    take(access, BEN, 1, wait=True)
    take(access, CLEO, 2, wait=True)
    assert standing(access, 1 + TURN_S).turn_s == TURN_S
    nudge(access, BEN, 1 + TURN_S, 1 + 2 * TURN_S)
    assert standing(access, 1 + 2 * TURN_S).holder == "cleo"


def test_another_program_of_the_seat_begins_no_new_turn(access: Access) -> None:
    take(access, ANA, 0)
    take(access, BEN, 0, wait=True)
    take(access, ANA_AGAIN, 50)
    assert standing(access, 50).turn_s == TURN_S - 50


def test_the_turn_of_the_teacher_has_no_end(access: Access) -> None:
    take(access, BOSS, 0)
    take(access, ANA, 0, wait=True)
    assert nudge(access, BOSS, 0, 5 * TURN_S) == 5 * TURN_S
    assert standing(access, 5 * TURN_S)[:1] == (TEACHER,)


def test_a_seat_alone_keeps_the_robot_and_an_empty_queue_ends_the_limit(access: Access) -> None:
    take(access, ANA, 0)
    assert nudge(access, ANA, 0, 3 * TURN_S) == 3 * TURN_S
    take(access, BEN, 3 * TURN_S, wait=True)
    access.lease.give_back(BEN)
    assert nudge(access, ANA, 3 * TURN_S, 6 * TURN_S) == 6 * TURN_S
    assert standing(access, 6 * TURN_S).turn_s == 0


def test_a_lease_with_a_time_of_its_own_ends_although_no_seat_waits(access: Access) -> None:
    take(access, ANA, 0, terms=Terms(longest_s=30))
    assert nudge(access, ANA, 0, 90) == 90, "free afterwards"
    assert standing(access, 90).lease == 0
    assert take(access, ANA, 91, terms=Terms(longest_s=30)) == 2
    assert standing(access, 91).turn_s == 30, "a new turn"


def test_a_waiting_seat_gets_the_terms_that_it_has_asked_for(access: Access) -> None:
    take(access, ANA, 0)
    take(access, BEN, 0, wait=True, terms=Terms(longest_s=30, speed=0.5))
    access.lease.give_back(ANA)
    assert standing(access, 10).turn_s == 30
    assert [access.lease.terms.speed(seat) for seat in ("ben", "ana", "")] == [0.5, 0, 0]
    assert standing(access, 40).lease == 0
    access.lease.give_back(BEN)
    assert access.lease.terms.speed("ben") == 0


def test_the_speed_of_a_turn_outlives_the_lease_that_another_program_of_the_seat_gives_back(
    access: Access,
) -> None:
    terms = Terms(longest_s=90, speed=0.7)
    take(access, ANA, 0, terms=terms)
    access.lease.give_back(ANA_AGAIN)
    assert (standing(access, 1).lease, access.lease.terms.speed("ana")) == (0, 0.7)
    take(access, ANA_AGAIN, 2, terms=Terms(longest_s=3600, speed=1.5))
    assert (standing(access, 2).turn_s, access.lease.terms.speed("ana")) == (90, 0.7), "the stricter of both"
    access.lease.give_back(ANA_AGAIN)
    access.lease.give_back(ANA)
    assert access.lease.terms.speed("ana") == 0


def test_the_speed_of_a_turn_ends_with_its_session_and_with_the_turn_of_another_seat(access: Access) -> None:
    take(access, ANA, 0, terms=Terms(speed=0.7))
    access.session_changed(ANA, 1, alive=False)
    access.give_up_sessions(2)
    assert access.lease.terms.speed("ana") == 0
    take(access, ANA_AGAIN, 3, terms=Terms(speed=0.7))
    access.lease.give_back(ANA)
    take(access, BEN, 4)
    assert access.lease.terms.speed("ana") == 0


def test_a_lost_router_stops_the_clock(access: Access) -> None:
    take(access, ANA, 0)
    take(access, BEN, 0, wait=True)
    access.router_changed(50, connected=False)
    assert standing(access, 500).holder == "ana"
    access.router_changed(500, connected=True)
    assert standing(access, 501).turn_s == TURN_S - 1
