"""May a seat move a robot; the begin of a motion; what is reported if both robots fail."""

from __future__ import annotations

from unittest.mock import Mock

import msgspec
import pytest
from statuses import READY

from beatrix_zenoh import NoAnswer, Robot
from beatrix_zenoh.client import twin_motion
from beatrix_zenoh.client.degrees import ArmAngles, HeadAngles, Reading
from beatrix_zenoh.client.robot_base import Offset
from beatrix_zenoh.client.twin_motion import MotionBegin, stopped
from beatrix_zenoh.client.twin_state import may_move
from beatrix_zenoh.contract._generated.messages import Fault, Reason
from beatrix_zenoh.contract.errors import BeatrixError

LOST = msgspec.structs.replace(READY.board, connected=False)


@pytest.mark.parametrize(("holder", "who"), [("", "ana"), ("ana", "ana"), ("ben", "teacher")])
def test_the_holder_or_the_teacher_may_move_a_ready_robot(holder: str, who: str) -> None:
    may_move(msgspec.structs.replace(READY, holder=holder), who)


@pytest.mark.parametrize(
    ("change", "reason", "text"),
    [
        ({"holder": "ben"}, Reason.NOT_HOLDER, "ben drives this robot"),
        ({"holder": "ben", "lease": 3}, Reason.NOT_HOLDER, "ben has taken this robot"),
        ({"enabled": False}, Reason.NOT_ENABLED, "The motors are off"),
        ({"calibrated": False}, Reason.NOT_CALIBRATED, "Home is not known"),
        ({"enabled": False, "fault": Fault.EMERGENCY}, Reason.EMERGENCY, "EMERGENCY_STOP is latched"),
        ({"board": LOST, "fault": Fault.BOARD_LOST}, Reason.BOARD_LOST, "does not answer"),
        ({"board": LOST, "fault": Fault.CONTRACT_MISMATCH}, Reason.CONTRACT_MISMATCH, "of another version"),
        (
            {"board": LOST, "fault": Fault.BOARD_LOST, "warnings": ["The board is gone: plug it in."]},
            Reason.BOARD_LOST,
            "plug it in",
        ),
    ],
)
def test_the_first_missing_condition_is_raised(change: dict[str, object], reason: Reason, text: str) -> None:
    with pytest.raises(BeatrixError, match=text) as refusal:
        may_move(msgspec.structs.replace(READY, **change), "ana")
    assert refusal.value.reason is reason


@pytest.mark.parametrize("clock_s", [0.0, 7000.0, -12.0])
def test_the_begin_of_a_motion_does_not_depend_on_the_clock_of_the_robot(
    monkeypatch: pytest.MonkeyPatch, clock_s: float
) -> None:
    monkeypatch.setattr(twin_motion, "offset_of", lambda _robot: Offset(clock_s, 0.001))
    robot = Mock()
    begin = MotionBegin(robot, ArmAngles(0.0, 0.0, 0.0))
    assert begin.begin_s() is None
    turned = [ArmAngles(max(0.0, 50 * (index * 0.02 - 0.111)), 0.0, 0.0) for index in range(100)]
    robot.stream().take.return_value = [
        Reading(clock_s + index * 0.02, arms, arms, arms, HeadAngles(0.0, 0.0, 0.0))
        for index, arms in enumerate(turned)
    ]
    begin.read()
    assert begin.begin_s() == pytest.approx(0.14, abs=0.001)


def test_a_cause_that_stop_meets_again_is_reported_once(monkeypatch: pytest.MonkeyPatch) -> None:
    lost = NoAnswer(Reason.NO_ROUTER, "The router is lost.")
    pair: list[Robot] = [Mock(spec=Robot, place=("bea", side)) for side in ("sim", "hw")]
    for robot in pair:
        robot.client = Mock(**{"bus.closed": False})
    monkeypatch.setattr(twin_motion, "stop_robots", lambda robots: [(robot, lost) for robot in robots])
    named = NoAnswer(Reason.NO_ROUTER, "bea (hw): The router is lost.")
    assert str(stopped(named, pair)) == "bea (hw): The router is lost."
    other = NoAnswer(Reason.NODE_LOST, "bea (hw) is not online.")
    assert str(stopped(other, pair)) == "bea (hw) is not online.\nbea (hw): The router is lost."
    assert str(stopped(KeyboardInterrupt(), pair)) == "bea (hw): The router is lost."
