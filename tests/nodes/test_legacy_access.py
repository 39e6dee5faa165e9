"""Access of programs of 2023: motors off at the end, @CALNOW, the emergency latch, and their events."""

from __future__ import annotations

import contextlib
import math
from collections.abc import Iterator

import pytest
from old_programs import Place, Program
from robots import until, wait_status

from beatrix_zenoh.contract._generated.messages import Command, Event, EventKind, Phase, Reason, Source
from beatrix_zenoh.motion.gear import Gear

pytestmark = pytest.mark.bodies("hw")

OUTCOME_S = 5.0


@contextlib.contextmanager
def motors_on_again(place: Place) -> Iterator[None]:
    """Leave the robot enabled and calibrated, as the other tests of this file expect it."""
    try:
        yield
    finally:
        place.until_free()
        place.robot.command(Command.RESET)
        place.robot.enable()
        place.robot.calibrate()


def outcome(place: Place, since: int, action: str, phase: Phase | None = None) -> Event:
    """Wait for the first event of an action with a number above `since`, and return it."""

    def found() -> list[Event]:
        return [
            event for event in place.events(since) if event.action == action and phase in (None, event.phase)
        ]

    until(lambda: bool(found()), f"an event of {action}", OUTCOME_S)
    return found()[0]


# -- events: first in this file, because a node counts equal events of a flood instead of storing each


def test_the_event_log_has_actions_of_a_program_and_not_its_queries(place: Place) -> None:
    with place.program() as program:
        since = place.newest_event()
        program.begin()
        for _ in range(30):
            program.say("@GETXPOS", 3)
            program.say("@COMSTATUS")
        assert program.say("@MOVRALL 50 50 50") == ["ACK\n", "ACK\n"]
        assert program.say("@STOPALL") == ["ACK\n", "ACK\n"]
        outcome(place, since, "@STOPALL")
        events = [event for event in place.events(since) if event.seat == "legacy" and event.action]
        assert [(event.kind, event.action, event.phase, event.reason) for event in events] == [
            (EventKind.COMMAND, "@ENMOTORS", None, Reason.OK),
            (EventKind.COMMAND, "@CALNOW", None, Reason.OK),
            (EventKind.MOTION, "@MOVRALL", Phase.ACCEPTED, Reason.OK),
            (EventKind.MOTION, "@MOVRALL", Phase.DONE, Reason.OK),
            (EventKind.STOP, "@STOPALL", None, Reason.OK),
        ]
        assert 0.3 < events[3].duration < 3.0
        assert [event.source for event in events[:3]] == [Source.OLD_PROGRAM] * 3
        assert events[2].message == "@MOVRALL 50 50 50"
        assert events[3].position is not None
        moved = math.degrees(events[3].position.x) - place.start
        assert moved == pytest.approx(50 * 360 / Gear().steps_per_turn, abs=0.01)


# -- the program closes its port ------------------------------------------------------------------


def test_a_stop_is_carried_out_after_the_program_has_closed_its_port(place: Place) -> None:
    place.until_free()
    with contextlib.closing(Program(place.path).port) as port:
        port.write(b"@ENMOTORS ON\r@CALNOW\r" + place.turn(2000) + b"@MOVRX 5\r")
        until(place.far, "moving")
        port.write(b"@GETXPOS\r@STOPALL\r")
    wait_status(place.robot, lambda status: not status.moving, "stopped", 5.0)


# -- @CALNOW ----------------------------------------------------------------------------------------


def test_a_program_does_not_set_the_home_of_a_robot_that_another_seat_holds(place: Place) -> None:
    with place.program() as program, motors_on_again(place):
        program.begin()
        place.until_free()
        place.robot.look(yaw=3)
        place.robot.disable()
        place.robot.enable()
        since = place.newest_event()
        assert program.say("@CALNOW") == ["ACK\n", "NACK\n"]
        assert outcome(place, since, "@CALNOW").reason is Reason.NOT_HOLDER
        assert not place.robot.status().calibrated


# -- the emergency latch ----------------------------------------------------------------------------


def test_motors_stay_off_under_the_emergency_latch_and_the_warning_names_reset(place: Place) -> None:
    with place.program() as program, motors_on_again(place):
        program.begin()
        place.robot.emergency_stop()
        since = place.newest_event()
        assert program.say("@ENMOTORS ON") == ["ACK\n", "NACK\n"]
        assert outcome(place, since, "@ENMOTORS").reason is Reason.EMERGENCY
        wait_status(place.robot, lambda status: "`beatrix reset`" in " ".join(status.warnings), "the warning")
        place.robot.command(Command.RESET)
        assert program.say("@ENMOTORS ON") == ["ACK\n", "ACK\n"]


# -- reasons of refusals --------------------------------------------------------------------------------


def test_a_refused_line_is_explained(place: Place) -> None:
    with place.program() as program:
        program.begin()
        since = place.newest_event()
        assert program.say("@MOVRX 40000") == ["ACK\n", "NACK\n"]
        event = outcome(place, since, "@MOVRX", Phase.DONE)
        assert event.reason is Reason.BAD_VALUE
        assert "old-programs.md" in event.message
        wait_status(place.robot, lambda status: "old-programs.md" in " ".join(status.warnings), "the warning")
