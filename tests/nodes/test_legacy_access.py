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
        until(lambda: place.robot.status().holder in ("", "ana"), "free", 5.0)
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


def wait_calibrations(place: Place, count: int) -> None:
    """Wait until the status reports this number of calibrations."""
    wait_status(place.robot, lambda status: status.calibrations == count, f"calibrations are {count}")


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


def test_a_teacher_who_takes_the_robot_stops_a_running_motion(place: Place) -> None:
    teacher = place.stage.robot("bea", "hw", "teacher")
    with place.program() as program:
        program.begin()
        program.port.write(place.turn(600))
        until(place.far, "moving")
        with teacher.lease():
            until(lambda: not place.robot.status().moving, "stopped", 1.5)
            assert abs(place.robot.positions().commanded.short - place.start) < 40, "600 steps are 52 deg"
    until(lambda: place.robot.status().holder in ("", "ana"), "free", 5.0)


def test_a_motion_that_is_stopped_or_not_accepted_is_in_the_event_log(place: Place) -> None:
    with place.program() as program:
        program.begin()
        since = place.newest_event()
        program.port.write(place.turn(600) + b"@MOVAX 5\r")
        until(place.far, "moving")
        place.robot.stop()
        assert program.read(4) == ["ACK\n", "NACK\n"] * 2
        assert outcome(place, since, "@MOVRALL", Phase.DONE).reason is Reason.STOPPED
        refused = outcome(place, since, "@MOVAX")
        assert (refused.phase, refused.reason) == (Phase.ACCEPTED, Reason.STOPPED)


# -- the program closes its port ------------------------------------------------------------------


def test_a_waiting_enmotors_off_is_carried_out_after_the_program_has_closed_its_port(place: Place) -> None:
    until(lambda: place.robot.status().holder == "", "free", 5.0)
    with motors_on_again(place):
        with contextlib.closing(Program(place.path).port) as port:
            port.write(b"@ENMOTORS ON\r@CALNOW\r@MOVRALL 100 100 100\r@MOVRALL 100 100 100\r@ENMOTORS OFF\r")
            until(lambda: place.robot.status().moving, "moving")
            at = place.robot.positions().commanded.short
        wait_status(place.robot, lambda status: not status.enabled, "the motors are off")
        moved = place.robot.positions().commanded.short - at
        assert 0 < moved < 9.0, (
            "100 steps are 8.6 degrees: the first motion was finished, the second never begun"
        )


def test_a_waiting_enmotors_off_is_carried_out_before_the_next_program_begins(place: Place) -> None:
    until(lambda: place.robot.status().holder == "", "free", 5.0)
    with motors_on_again(place):
        since = place.newest_event()
        with contextlib.closing(Program(place.path).port) as port:
            port.write(b"@ENMOTORS ON\r@CALNOW\r" + place.turn(900) + b"@MOVRX 5\r@ENMOTORS OFF\r")
            until(place.far, "moving")
        outcome(place, since, "@MOVRX")  # dropped: the node has detected the end of the program
        with contextlib.closing(Program(place.path).port) as port:
            port.timeout = 5.0
            port.write(b"@COMSTATUS\r")
            assert [port.readline(), port.readline()] == [b"ACK\n", b"ACK\n"]
            wait_status(place.robot, lambda status: not status.enabled, "the motors are off", 1.0)


def test_a_stop_is_carried_out_after_the_program_has_closed_its_port(place: Place) -> None:
    until(lambda: place.robot.status().holder == "", "free", 5.0)
    with contextlib.closing(Program(place.path).port) as port:
        port.write(b"@ENMOTORS ON\r@CALNOW\r" + place.turn(2000) + b"@MOVRX 5\r")
        until(place.far, "moving")
        port.write(b"@GETXPOS\r@STOPALL\r")
    wait_status(place.robot, lambda status: not status.moving, "stopped", 1.5)


def test_a_waiting_motion_that_is_dropped_is_an_event(place: Place) -> None:
    until(lambda: place.robot.status().holder == "", "free", 5.0)
    since = place.newest_event()
    with contextlib.closing(Program(place.path).port) as port:
        port.write(b"@ENMOTORS ON\r@CALNOW\r@MOVRALL 60 60 60\r@MOVAX 5\r")
        until(lambda: place.robot.status().moving, "moving")
    assert outcome(place, since, "@MOVAX").reason is Reason.CLIENT_LOST
    until(lambda: not place.robot.status().moving, "it rests")


# -- @CALNOW ----------------------------------------------------------------------------------------


def test_a_program_sets_its_own_zero_while_another_seat_drives(place: Place) -> None:
    with place.program() as program:
        program.begin()
        calibrations = place.robot.status().calibrations
        motion = place.robot.look(yaw=3, speed=2, wait=False)
        assert program.say("@CALNOW") == ["ACK\n", "ACK\n"]
        motion.wait()
        assert place.robot.status().calibrations == calibrations, "the robot's home stays"
        until(lambda: place.robot.status().holder == "", "free", 4.0)
        assert program.say("@MOVRX 20 200") == ["ACK\n", "ACK\n"], "its later motions are accepted"


def test_a_program_does_not_set_the_home_of_a_robot_that_another_seat_holds(place: Place) -> None:
    with place.program() as program, motors_on_again(place):
        program.begin()
        place.robot.look(yaw=3)
        place.robot.disable()
        place.robot.enable()
        since = place.newest_event()
        assert program.say("@CALNOW") == ["ACK\n", "NACK\n"]
        assert outcome(place, since, "@CALNOW").reason is Reason.NOT_HOLDER
        assert not place.robot.status().calibrated


def test_lines_sent_together_set_home_like_single_lines(place: Place) -> None:
    """@CALNOW must not overtake the telemetry that shows the effect of @ENMOTORS."""
    with place.program() as program:
        for _ in range(5):
            calibrations = place.robot.status().calibrations
            program.port.write(b"@ENMOTORS OFF\r@ENMOTORS ON\r@CALNOW\r")
            assert program.read(6) == ["ACK\n"] * 6
            wait_calibrations(place, calibrations + 1)


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


@pytest.mark.parametrize(
    ("line", "answers", "reason", "word"),
    [
        ("@MOVRX", 1, Reason.BAD_VALUE, "old-programs.md"),
        ("@MOVRALL", 1, Reason.BAD_VALUE, "old-programs.md"),
        ("@MOVHOME 1", 1, Reason.BAD_VALUE, "old-programs.md"),
        ("@MOVRT 1", 1, Reason.BAD_VALUE, "old-programs.md"),
        ("@MOVRX 40000", 2, Reason.BAD_VALUE, "32767"),
        ("@ENMOTORS", 1, Reason.BAD_VALUE, "ON or OFF"),
        ("@ENMOTORS on", 2, Reason.BAD_VALUE, "ON or OFF"),
    ],
)
def test_a_refused_line_is_explained_by_its_reason(
    place: Place, line: str, answers: int, reason: Reason, word: str
) -> None:
    with place.program() as program:
        program.begin()
        since = place.newest_event()
        assert program.say(line, answers)[-1] == "NACK\n"
        event = outcome(place, since, line.partition(" ")[0], Phase.DONE if line.startswith("@MOV") else None)
        assert event.reason is reason
        assert word in event.message
        wait_status(place.robot, lambda status: word in " ".join(status.warnings), "the warning")


def test_the_refusal_of_a_motion_before_calnow_names_calnow(place: Place) -> None:
    with place.program() as program:
        since = place.newest_event()
        assert program.say("@MOVRX 5") == ["ACK\n", "NACK\n"]
        event = outcome(place, since, "@MOVRX", Phase.DONE)
        assert event.reason is Reason.NOT_CALIBRATED
        assert "send @CALNOW first" in event.message
