"""Who drives, and for how long; who was stopped must pause."""

from __future__ import annotations

import pytest

from beatrix_zenoh import Refused
from beatrix_zenoh._generated.messages import Reason
from beatrix_zenoh.lease import LINGER_S, Lease
from beatrix_zenoh.node.halt import PAUSE_S, Halt


def test_a_free_robot_is_taken_by_the_first() -> None:
    lease = Lease()
    assert lease.holder(0) == ""
    lease.take("ana", 0)
    assert lease.holder(0) == "ana"


def test_others_are_refused_by_name() -> None:
    lease = Lease()
    lease.take("ana", 0)
    with pytest.raises(Refused, match="ana drives") as refusal:
        lease.take("ben", 100)
    assert refusal.value.reason is Reason.NOT_HOLDER


def test_the_lease_lingers_exactly_so_long_after_rest() -> None:
    lease = Lease()
    lease.take("ana", 0)
    lease.rest(10)
    with pytest.raises(Refused, match=r"1\.0 s more"):
        lease.check("ben", 10 + LINGER_S - 1)
    assert lease.holder(10 + LINGER_S - 0.001) == "ana"
    assert lease.holder(10 + LINGER_S) == ""
    lease.take("ben", 10 + LINGER_S)


def test_moving_again_keeps_the_lease() -> None:
    lease = Lease()
    lease.take("ana", 0)
    lease.rest(1)
    lease.take("ana", 2)
    assert lease.holder(100) == "ana"


def test_the_teacher_outranks_and_then_holds() -> None:
    lease = Lease()
    lease.take("ana", 0)
    lease.take("teacher", 1)
    with pytest.raises(Refused, match="teacher drives"):
        lease.check("ana", 1)


def test_a_freed_robot_is_free_at_once() -> None:
    lease = Lease()
    lease.take("ana", 0)
    lease.free()
    lease.take("ben", 0)


def stopped(driving: str, presser: str) -> Halt:
    """STOP was pressed at 0 s and the board has been told."""
    halt = Halt()
    halt.press(driving, "mine", presser, 0)
    halt.sent()
    return halt


def test_nobody_moves_while_the_arms_come_to_rest() -> None:
    halt = stopped("ana", "session")
    for who, session in (("ana", "session"), ("ben", "")):
        with pytest.raises(Refused, match="coming to rest"):
            halt.check(who, session, 5, resting=False)


def test_nobody_moves_before_the_board_has_been_told() -> None:
    halt = Halt()
    halt.press("ana", "mine", "session", 0)
    with pytest.raises(Refused, match="coming to rest"):
        halt.check("ben", "his", 0.1, resting=True)


def test_the_stopped_seat_must_be_quiet_for_the_whole_pause() -> None:
    halt = stopped("ana", "other")
    for now in (0.5, 1.4, 2.3):
        with pytest.raises(Refused, match="send no motion"):
            halt.check("ana", "mine", now, resting=True)
    halt.check("ana", "mine", 2.3 + PAUSE_S, resting=True)


def test_stop_pressed_again_sets_nobody_free() -> None:
    halt = stopped("ana", "other")
    for now in (0.3, 0.6, 0.9, 1.2):
        with pytest.raises(Refused, match="send no motion"):
            halt.check("ana", "mine", now, resting=True)
        halt.press("", "", "other", now)
        halt.sent()
    with pytest.raises(Refused, match="send no motion"):
        halt.check("ana", "mine", 1.3, resting=True)


@pytest.mark.parametrize(
    ("first", "again"),
    [("other", ("ana", "mine", "mine")), ("mine", ("", "", "other"))],
    ids=["own", "other"],
)
def test_somebody_elses_stop_holds_before_and_after_own(first: str, again: tuple[str, str, str]) -> None:
    halt = stopped("ana", first)
    halt.press(*again, 0.1)
    halt.sent()
    with pytest.raises(Refused, match="send no motion"):
        halt.check("ana", "mine", 0.2, resting=True)


def test_others_need_not_pause() -> None:
    stopped("ana", "other").check("ben", "his", 0.1, resting=True)


def test_who_pressed_stop_himself_need_not_pause() -> None:
    stopped("ana", "mine").check("ana", "mine", 0.1, resting=True)


def test_an_unknown_stopper_is_not_taken_for_an_unknown_driver() -> None:
    with pytest.raises(Refused):
        stopped("ana", "").check("ana", "", 0.1, resting=True)


def test_what_came_to_nothing_gives_the_robot_back_as_it_was() -> None:
    lease = Lease()
    lease.take("ana", 0)
    lease.give_back(1)
    assert lease.holder(1) == "", "it was free"
    lease.take("ana", 2)
    lease.rest(3)
    for now_s in (3.5, 4.5):
        lease.take("ana", now_s)
        lease.give_back(now_s)
    assert lease.holder(3 + LINGER_S - 0.1) == "ana"
    assert lease.holder(3 + LINGER_S) == "", "what came to nothing prolongs nothing"


def test_who_still_drove_before_rests_from_then_on() -> None:
    lease = Lease()
    lease.take("ana", 0)
    lease.take("ana", 1)
    lease.give_back(2)
    assert lease.holder(2 + LINGER_S - 0.1) == "ana"
    assert lease.holder(2 + LINGER_S) == ""


def test_a_try_that_is_refused_anyway_prolongs_the_pause() -> None:
    halt = Halt()
    halt.press("ana", "her-session", "another", 0.0)
    halt.sent()
    halt.tried("ana", 0.9)
    with pytest.raises(Refused, match="STOP was pressed while ana was driving"):
        halt.check("ana", "her-session", 1.5, resting=True)
    halt.tried("ben", 2.4)
    halt.check("ana", "her-session", 2.6, resting=True)


def test_a_try_after_the_pause_begins_no_new_one() -> None:
    """An old program sends forty lines at once, minutes after somebody's STOP."""
    halt = Halt()
    halt.press("ana", "her-session", "another", 0.0)
    halt.sent()
    halt.tried("ana", 60.0)
    halt.check("ana", "her-session", 60.1, resting=True)
