"""After EMERGENCY_STOP programs that were at work must look before they switch on again."""

from __future__ import annotations

import pytest

from beatrix_zenoh import Refused
from beatrix_zenoh._generated.messages import Reason
from beatrix_zenoh.node.latch import REMEMBERED, Latch


@pytest.fixture
def latch() -> Latch:
    made = Latch()
    made.works("loop")
    made.press("boss", 50.0)
    return made


def test_a_program_at_work_is_refused_once_and_may_after_a_pause(latch: Latch) -> None:
    with pytest.raises(Refused, match="EMERGENCY_STOP was pressed while this program was at work") as refusal:
        latch.check("loop", 100.0, 100.0)
    assert refusal.value.reason is Reason.STOPPED
    with pytest.raises(Refused):
        latch.check("loop", 100.9, 100.9)
    latch.check("loop", 101.9, 101.9)
    latch.check("loop", 101.9, 101.9)


def test_however_late_it_comes_it_is_told_first(latch: Latch) -> None:
    with pytest.raises(Refused):
        latch.check("loop", 5000.0, 5000.0)


def test_others_need_not_wait(latch: Latch) -> None:
    for session in ("boss", "began-after-it", ""):
        latch.check(session, 100.0, 100.0)


def test_who_pressed_it_knows(latch: Latch) -> None:
    latch.works("boss")
    latch.press("boss", 60.0)
    latch.check("boss", 100.0, 100.0)
    latch.press("loop", 70.0)
    latch.check("loop", 100.0, 100.0)
    with pytest.raises(Refused):
        latch.check("boss", 100.0, 100.0)


def test_each_emergency_is_told_anew(latch: Latch) -> None:
    with pytest.raises(Refused):
        latch.check("loop", 100.0, 100.0)
    latch.press("boss", 150.0)
    with pytest.raises(Refused):
        latch.check("loop", 200.0, 200.0)


def test_a_session_that_has_ended_is_forgotten(latch: Latch) -> None:
    latch.gone("loop")
    latch.check("loop", 100.0, 100.0)


def test_the_oldest_of_very_many_sessions_is_forgotten() -> None:
    latch = Latch()
    for number in range(REMEMBERED + 1):
        latch.works(f"s{number}")
    latch.press("boss", 60.0)
    latch.check("s0", 100.0, 100.0)
    with pytest.raises(Refused):
        latch.check("s1", 100.0, 100.0)
