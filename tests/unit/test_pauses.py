"""The pauses of stopped seats: which session of the seat may move after STOP."""

from __future__ import annotations

import pytest

from beatrix_zenoh.node.lease import QUIET_S, Caller
from beatrix_zenoh.node.pauses import Pauses

BEN = Caller("ben", "ben's")
FIRST, SECOND = Caller("ana", "first"), Caller("ana", "second")
BEGAN_S = {FIRST: 0.0, SECOND: 0.5}


class Robot:
    """Pauses, driven as by `Access`: a motion that begins is reported, and STOP is reported twice."""

    def __init__(self) -> None:
        self.pauses = Pauses()
        self.now_s = 1.0
        self.mover: Caller | None = None

    def moves(self, caller: Caller) -> bool:
        """Request a motion; return whether it begins."""
        self.now_s += 0.1
        began_s = BEGAN_S.setdefault(caller, self.now_s)
        if self.pauses.restart(caller, self.now_s, began_s) is not None:
            return False
        self.pauses.moved(caller.seat)
        self.mover = caller
        return True

    def stop(self, presser: Caller) -> None:
        """Press STOP; the last mover has moved less than QUIET_S ago."""
        self.now_s += 0.1
        self.pauses.begin(self.mover, presser, self.now_s)
        self.pauses.begin(self.mover, presser, self.now_s)


@pytest.fixture
def robot() -> Robot:
    return Robot()


def test_a_session_that_stops_itself_need_not_pause_however_often(robot: Robot) -> None:
    for session in (FIRST, Caller("ana", "next run"), Caller("ana", "last run")):
        assert robot.moves(session)
        robot.stop(session)
        assert robot.moves(session)


def test_a_second_session_of_a_stopped_seat_does_not_free_it_with_a_stop_of_its_own(robot: Robot) -> None:
    assert robot.moves(FIRST)
    robot.stop(BEN)
    robot.stop(SECOND)
    assert not robot.moves(SECOND)
    assert not robot.moves(FIRST)
    robot.now_s += QUIET_S
    assert robot.moves(FIRST)


def test_a_stopped_session_does_not_free_itself_with_a_stop_of_its_own(robot: Robot) -> None:
    assert robot.moves(FIRST)
    robot.stop(BEN)
    robot.stop(FIRST)
    assert not robot.moves(FIRST)


def test_a_program_that_starts_after_stop_may_press_stop_before_it_moves(robot: Robot) -> None:
    assert robot.moves(FIRST)
    robot.stop(BEN)
    started = Caller("ana", "started later")
    BEGAN_S[started] = robot.now_s + 0.05
    robot.stop(started)
    assert robot.moves(started)


def test_a_session_that_stopped_itself_must_pause_after_the_stop_of_another_seat(robot: Robot) -> None:
    assert robot.moves(FIRST)
    robot.stop(FIRST)
    robot.stop(BEN)
    assert not robot.moves(FIRST)
