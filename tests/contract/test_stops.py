"""STOP and EMERGENCY_STOP against programs that do not think of them."""

from __future__ import annotations

import pytest
from body import Body
from stage import ready, until

from beatrix_zenoh import Refused, Robot, codec
from beatrix_zenoh._generated import keys
from beatrix_zenoh._generated.messages import Command, CommandQuery, Fault, Reason
from beatrix_zenoh.bus import Question


def test_an_emergency_is_not_undone_by_a_program_that_begins_with_enable(body: Body, robot: Robot) -> None:
    boss = body.robot("boss")
    boss.emergency_stop()
    with pytest.raises(Refused, match="EMERGENCY_STOP was pressed while this program was at work") as refusal:
        robot.enable()
    assert refusal.value.reason is Reason.STOPPED
    status = boss.status()
    assert (status.enabled, status.fault) == (False, Fault.EMERGENCY)
    later = body.robot("ana")  # a person who looked and types
    ready(later)
    assert later.status().calibrated
    boss.client.close()
    later.client.close()


def test_stop_between_two_motions_of_a_loop_holds(body: Body, robot: Robot) -> None:
    boss = body.robot("boss")
    robot.move(3, 3, 3, speed=60)
    until(lambda: not boss.status().moving, "at rest")
    assert boss.status().holder == "ana"
    boss.stop()
    with pytest.raises(Refused, match="STOP was pressed while ana was driving"):
        robot.move(0, 0, 0, speed=60)
    boss.client.close()


def test_stop_is_answered_at_once_beside_a_queue_of_commands(body: Body, robot: Robot) -> None:
    """Each of them waits for telemetry; one after the other they take most of a second."""
    boss = body.robot("boss")
    key = keys.command(robot.name, robot.twin, "ana")
    enable = codec.encode(CommandQuery(command=Command.ENABLE.value))
    questions = [robot.client.bus.question(key, enable, codec.MSGPACK, "interactive_high") for _ in range(60)]
    boss.stop()
    waiting = sum(map(unanswered, questions))
    for question in questions:
        question.close()
    boss.client.close()
    assert waiting > 10


def unanswered(question: Question) -> bool:
    """Its first reply has not come."""
    try:
        question.next(0)
    except TimeoutError:
        return True
    return False
