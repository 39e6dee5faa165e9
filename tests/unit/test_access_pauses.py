"""Access rules: STOP, the pause of the stopped seat, and programs that start after STOP."""

from __future__ import annotations

import pytest
from access_callers import ANA, ANA_AGAIN, BEN, BOSS, NO_SESSION, OLD, begin_motion, refusal, stop

from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.errors import Refused
from beatrix_zenoh.node.access import Access, Operation
from beatrix_zenoh.node.callers import NO_CALLER, Caller
from beatrix_zenoh.node.pauses import LOOP_S, QUIET_OLD_PROGRAM_S, QUIET_S


@pytest.fixture
def access() -> Access:
    return Access()


# -- STOP ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("action", [Operation.MOVE, Operation.FOLLOW])
def test_no_motion_begins_before_stop_was_sent_and_the_arms_rest(access: Access, action: Operation) -> None:
    begin_motion(access, ANA, 0).stop_pressed(BEN, 1)
    assert refusal(access, BOSS, 1, action, resting=True) is Reason.STOPPED
    access.stop_sent(1.1)
    assert refusal(access, BOSS, 1.2, action, resting=False) is Reason.STOPPED
    assert refusal(access, BOSS, 1.3, action, resting=True) is Reason.OK


def test_a_motion_that_ends_after_stop_names_the_seat_until_the_next_motion(access: Access) -> None:
    begin_motion(access, ANA, 0)
    assert access.last_stop.seat == ""
    access.stop_pressed(BEN, 1)
    access.stop_sent(1.1)
    assert access.last_stop.seat == "ben"
    access.rested(1.5)
    with pytest.raises(Refused, match="STOP was pressed by ben while ana was driving"):
        access.authorize(Operation.MOVE, ANA, 1.6)
    begin_motion(access, BOSS, 1.7)
    assert access.last_stop.seat == ""


def test_each_request_restarts_the_pause_of_a_stopped_seat(access: Access) -> None:
    stop(begin_motion(access, ANA, 0), BEN, 1)
    for now_s in (1.5, 2.5, 3.5, 4.5):
        assert refusal(access, ANA, now_s) is Reason.STOPPED
    assert refusal(access, ANA, 4.5 + QUIET_S - 0.01) is Reason.STOPPED
    assert refusal(access, ANA, 4.5 + 2 * QUIET_S) is Reason.OK


def test_a_request_that_is_refused_for_another_reason_restarts_the_pause(access: Access) -> None:
    stop(begin_motion(access, ANA, 0), BEN, 1)
    begin_motion(access, BEN, 3)
    assert refusal(access, ANA, 3.5) is Reason.NOT_HOLDER
    access.release(4)
    assert refusal(access, ANA, 4.5) is Reason.STOPPED


PRESSES = {
    "own": (ANA, [ANA], Reason.OK),
    "own, without a seat": (ANA, [Caller("", "a1")], Reason.OK),
    "of ben, with ana's session": (ANA, [Caller("ben", "a1")], Reason.STOPPED),
    "of ana, without a session": (ANA, [Caller("ana", "")], Reason.STOPPED),
    "of ben, and then the own": (ANA, [BEN, ANA], Reason.STOPPED),
    "of ben, and then a forged one": (ANA, [BEN, Caller("cem", "a1")], Reason.STOPPED),
    "own, and then that of ben": (ANA, [ANA, BEN], Reason.STOPPED),
    "without a session, of a caller without one": (NO_SESSION, [NO_CALLER], Reason.STOPPED),
    "of ben, of a caller without a session": (Caller("ana", ""), [BEN], Reason.STOPPED),
}
"""Whose motion STOP has ended, who has pressed it, and whether the stopped program may move 0.1 s later.

A client can forge the session of its STOP, but in a class not the seat.
"""


@pytest.mark.parametrize("case", PRESSES)
def test_a_stopped_session_must_pause_unless_only_itself_has_pressed_stop(access: Access, case: str) -> None:
    moved, pressers, reason = PRESSES[case]
    begin_motion(access, moved, 0)
    for number, presser in enumerate(pressers):
        stop(access, presser, 1 + number / 10)
    assert refusal(access, moved, 1.1 + len(pressers) / 10) is reason


def test_if_another_session_of_the_seat_pressed_stop_only_the_stopped_session_must_pause(
    access: Access,
) -> None:
    stop(begin_motion(access, ANA, 0), ANA_AGAIN, 1)
    assert refusal(access, ANA, 1.1) is Reason.STOPPED
    begin_motion(access, ANA_AGAIN, 1.2)
    assert refusal(access, ANA, 1.3) is Reason.STOPPED


def test_a_seat_whose_session_ended_just_before_stop_must_pause(access: Access) -> None:
    """Another process of that seat could continue the stream of motions."""
    access.session_changed(ANA_AGAIN, 0, alive=True)
    begin_motion(access, ANA, 0)
    assert access.session_changed(ANA, 0, alive=False)
    access.release(10)
    access.stop_pressed(BEN, 10.1)
    access.stop_sent(10.1)
    assert refusal(access, ANA_AGAIN, 10.3) is Reason.STOPPED


def test_an_old_program_must_pause_until_it_is_quiet_or_opens_the_port_again(access: Access) -> None:
    stop(begin_motion(access, OLD, 0), BEN, 1)
    for now_s in (2, 5, 9):
        assert refusal(access, OLD, now_s) is Reason.STOPPED
    access.old_program_began()
    assert refusal(access, OLD, 9.1) is Reason.OK
    stop(begin_motion(access, OLD, 10), BEN, 11)
    assert refusal(access, OLD, 11 + QUIET_OLD_PROGRAM_S - 0.1) is Reason.STOPPED
    assert refusal(access, OLD, 11 + 2 * QUIET_OLD_PROGRAM_S) is Reason.OK


def test_an_old_program_may_move_at_once_after_its_own_stop(access: Access) -> None:
    begin_motion(access, OLD, 0).stop_pressed(OLD, 1)
    assert refusal(access, OLD, 1, resting=False) is Reason.OK
    assert refusal(access, BOSS, 1, resting=False) is Reason.STOPPED


# -- programs that start after STOP ----------------------------------------------------------------


def test_a_program_that_was_started_after_stop_need_not_pause_and_the_stopped_one_must(
    access: Access,
) -> None:
    stop(begin_motion(access, ANA, 0), BEN, 1)
    access.session_changed(ANA_AGAIN, 1.1, alive=True)
    assert refusal(access, ANA, 1.2) is Reason.STOPPED
    begin_motion(access, ANA_AGAIN, 1.3)
    assert refusal(access, ANA, 1.4) is Reason.STOPPED


def test_the_first_motion_of_a_new_program_may_arrive_before_its_token(access: Access) -> None:
    stop(begin_motion(access, ANA, 0), ANA, 1)
    begin_motion(access, ANA_AGAIN, 1.1)
    access.session_changed(ANA_AGAIN, 1.2, alive=True)
    assert refusal(stop(access, BEN, 1.3), ANA_AGAIN, 1.4) is Reason.STOPPED


def test_a_second_program_that_already_ran_must_pause_although_its_token_is_new(access: Access) -> None:
    """The router may be restarted, and a program may declare its token late."""
    access.session_changed(ANA_AGAIN, 0, alive=True)
    stop(begin_motion(access, ANA, 0), BEN, 1)
    for program in (ANA, ANA_AGAIN):
        assert refusal(access, program, 1.05) is Reason.STOPPED
        access.session_changed(program, 1.1, alive=False)
        access.session_changed(program, 1.2, alive=True)
        assert refusal(access, program, 1.3) is Reason.STOPPED


def test_a_second_stop_by_another_seat_ends_a_loop_of_programs(access: Access) -> None:
    """As of `while true; do beatrix look; done`."""
    stop(begin_motion(access, Caller("ana", "p0"), 0), BEN, 1)
    stop(begin_motion(access, Caller("ana", "p1"), 2), BEN, 3)
    for number in range(2, 9):
        with pytest.raises(Refused, match="also of a new program") as refused:
            access.authorize(Operation.MOVE, Caller("ana", f"p{number}"), 2.0 + number)
        assert refused.value.detail is not None
        assert refused.value.detail.wait_s == QUIET_S
    assert refusal(access, Caller("ana", "p9"), 10 + QUIET_S) is Reason.OK


def test_programs_that_another_seat_stops_now_and_then_need_not_pause(access: Access) -> None:
    for number in range(5):
        begin_motion(access, Caller("ana", f"p{number}"), 2 * number * LOOP_S)
        stop(access, BEN, (2 * number + 1) * LOOP_S)


# -- a STOP of the own seat ----------------------------------------------------------------------


def test_programs_that_stop_themselves_need_not_pause_however_often(access: Access) -> None:
    for run in range(4):
        session = Caller("ana", f"run {run}")
        stop(begin_motion(access, session, run), session, run + 0.2)
        assert refusal(access, session, run + 0.3) is Reason.OK
    stop(begin_motion(access, Caller("ana", "another run"), 4), BEN, 4.2)
    new = Caller("ana", "new run")
    stop(begin_motion(access, new, 4.3), new, 4.4)
    assert refusal(access, Caller("ana", "newest run"), 4.5) is Reason.OK, "no loop for others, either"


def test_a_second_session_of_a_stopped_seat_does_not_free_itself_with_a_stop_of_its_own(
    access: Access,
) -> None:
    access.session_changed(ANA, 0, alive=True)
    access.session_changed(ANA_AGAIN, 0, alive=True)
    stop(stop(begin_motion(access, ANA, 0), BEN, 1), ANA_AGAIN, 1.1)
    assert refusal(access, ANA_AGAIN, 1.2) is Reason.STOPPED
    assert refusal(access, ANA, 1.2) is Reason.STOPPED


@pytest.mark.parametrize("other", [BEN, NO_SESSION], ids=["another seat", "unknown"])
def test_a_program_that_starts_in_a_loop_of_programs_frees_itself_with_a_stop(
    access: Access, other: Caller
) -> None:
    """Tests and lessons begin with a STOP; that is not the loop which another seat wanted to end."""
    for run in range(2):
        stop(begin_motion(access, Caller("ana", f"run {run}"), run), other, run + 0.2)
    last, silent = Caller("ana", "run 2"), Caller("ana", "run 3")
    stop(access, last, 2)
    assert refusal(access, silent, 2.1) is Reason.STOPPED
    assert refusal(access, last, 2.2) is Reason.OK
