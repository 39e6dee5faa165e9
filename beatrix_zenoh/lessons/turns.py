"""A turn on the robot: take it, run the pupil's program, bring the head home, give the robot back."""

from __future__ import annotations

import contextlib
import math
import time
from typing import Final

from beatrix_zenoh.client.lease import Lease
from beatrix_zenoh.client.robot import Robot
from beatrix_zenoh.client.session import Client
from beatrix_zenoh.client.subscription import Subscription
from beatrix_zenoh.contract._generated.messages import Event, EventKind, Reason, Status
from beatrix_zenoh.contract.errors import BeatrixError, NoAnswer, Refused, bad_value
from beatrix_zenoh.lessons.guarded import Run
from beatrix_zenoh.lessons.phrases import Unmet, said
from beatrix_zenoh.lessons.program import Program
from beatrix_zenoh.lessons.sandbox import Sandbox, refuse_teacher, scratch
from beatrix_zenoh.output import note, say
from beatrix_zenoh.settings import Settings

LONGEST_S: Final = 90.0
HOME_S: Final = 15.0
"""Part of the turn that is kept for the way home (s)."""
FASTEST_DEG_S: Final = 40.0
POLL_S: Final = 0.1
TRACEBACK: Final = "Traceback (most recent call last):"


def take_turn(
    program: Program, settings: Settings, side: str, wait_s: float, *, endless: bool = False
) -> bool:
    """Run a program on a robot for at most LONGEST_S; the end of that time is no error of an `endless` program.

    Returns:
        Whether the head is home; if not, a note has said why.

    Raises:
        Refused: NOT_CALIBRATED, the robot is not ready; NOT_HOLDER, it was not free within `wait_s` (s), or the turn
            has ended early, and the head stays; STOPPED, a seat has pressed STOP, and the
            head stays where it is; BAD_VALUE, the program did not end in time or has ended with an error, and the head
            is home.
        NoAnswer: the robot was lost; it stops by itself.
    """
    refuse_teacher(settings.account)
    with Client(settings) as client:
        robot = Robot(settings.robot, side, client=client)
        status = robot.status()
        _require_calibrated(robot, status)
        _require_other_seat(robot, status, settings.who)
        say(f"Waiting for {robot}. Ctrl-C leaves the queue.")
        lease = Lease(
            robot,
            wait_s,
            longest_s=LONGEST_S,
            speed=math.radians(FASTEST_DEG_S),
            told=_Place(settings.who),
        )
        seconds = LONGEST_S - HOME_S
        say(f"It is your turn: your program may run for {seconds:.0f} s, at most {FASTEST_DEG_S:.0f}°/s.")
        wanted, home = True, False
        try:
            _require_calibrated(robot, robot.status())
            _require_unchanged(program)
            _run(program, robot, lease, endless=endless)
        except NoAnswer:
            wanted = False
            raise
        except Refused as error:
            wanted = error.reason not in (Reason.STOPPED, Reason.NOT_CALIBRATED)
            raise
        finally:
            home = _end(robot, lease, home=wanted)
        return home


def _require_calibrated(robot: Robot, status: Status) -> None:
    """Raise Refused (NOT_CALIBRATED) before a program calibrates a head that may lie on its side, and then moves it."""
    if not status.calibrated:
        raise Refused(
            Reason.NOT_CALIBRATED,
            f"{robot} is not calibrated, for example because it was restarted, and a turn does not do that. Set its head "
            f"upright, type `beatrix enable --name {robot.name}` and `beatrix calibrate --name {robot.name}`, or ask your "
            "teacher; then take your turn again.",
        )


def _require_other_seat(robot: Robot, status: Status, seat: str) -> None:
    """Raise Refused (NOT_HOLDER) if this seat has taken the robot: a second turn would end the first one."""
    if status.lease and status.holder == seat:
        raise Refused(
            Reason.NOT_HOLDER,
            f"Your seat, {seat}, has taken {robot} already: by another turn, or in a window. Let the turn end, or give the "
            f"robot back (`beatrix lease give-back --name {robot.name}`); then take your turn again.",
        )


def _require_unchanged(program: Program) -> None:
    """Raise Refused (BAD_VALUE) if the file of a program is no longer what has passed."""
    if program.changed():
        raise bad_value(
            f"{program.path.name} was saved meanwhile, so it is not the program that has passed. Check it again, then take "
            "another turn.",
        )


class _Place:
    """Tells the pupil each new place in the queue."""

    def __init__(self, seat: str) -> None:
        self._seat, self._told = seat, ""

    def __call__(self, status: Status | None) -> None:
        if status is None:
            text = (
                "The robot is lost, or hangs: tell your teacher. You wait until it is back; Ctrl-C ends that."
            )
        elif self._seat in status.waiting:
            place = status.waiting.index(self._seat) + 1
            text = f"{status.holder} has the robot; you are number {place} of {len(status.waiting)}."
        else:
            return
        if text != self._told:
            self._told = text
            note(text)


def _run(program: Program, robot: Robot, lease: Lease, *, endless: bool) -> None:
    settings = robot.client.settings
    with contextlib.ExitStack() as ending:
        events = ending.enter_context(robot.events())
        statuses = ending.enter_context(robot.status_stream())
        folder = ending.enter_context(scratch())
        connect = settings.connect
        if settings.account is not None:
            from beatrix_zenoh.bus.tunnel import Tunnel  # noqa: PLC0415 - asyncio would delay every verb

            connect = ending.enter_context(Tunnel(connect, settings.account)).endpoint
        environment = {
            "BEATRIX_ROBOT": robot.name,
            "BEATRIX_CONNECT": connect,
            "BEATRIX_WHO": settings.who,
            "BEATRIX_SIDE": robot.side,
            "BEATRIX_LEASE": str(lease.number),
        }
        running = Run(Sandbox(program, folder), environment)
        try:
            ended = _watch(running, events, statuses, lease.number)
        finally:
            running.close()
            for line in _printed(running.output):
                say(f"  {line}")
    if not ended and not endless:
        raise bad_value(
            f"Your program did not end within {LONGEST_S - HOME_S:.0f} s, so it was ended: is there a `while True`?",
        )
    if ended:
        _check(running)


def _watch(running: Run, events: Subscription[Event], statuses: Subscription[Status], number: int) -> bool:
    """Return True when the program has ended, False when its time is over; raise the other errors of `take_turn`."""
    heard_s = time.monotonic()
    end_s = heard_s + LONGEST_S - HOME_S
    ended = False
    while not ended and time.monotonic() < end_s:
        ended = not running.running
        time.sleep(POLL_S)  # the event of a STOP that has ended the program may still arrive
        stop = next((event for event in events.take() if event.kind is EventKind.STOP), None)
        if stop is not None:
            raise Refused(
                Reason.STOPPED,
                f"{stop.seat or 'A seat'} has pressed STOP: your turn is over, and the head stays where it is. Look at "
                "the robot before you take another turn.",
            )
        for status in statuses.take():
            heard_s = time.monotonic()
            if status.lease != number:
                raise Refused(
                    Reason.NOT_HOLDER,
                    f"Your turn has ended early; driver now: {status.holder or 'none'}. The teacher has ended it, or your "
                    "program or another window of yours has given the robot back. Take another turn when it suits the class.",
                )
        if time.monotonic() - heard_s > LOST_S:
            raise NoAnswer(
                Reason.TIMED_OUT,
                f"The robot has said nothing for {LOST_S:.0f} s: it is lost, and stops by itself.",
            )
    return ended


LOST_S: Final = 4.0
"""Silence of the status (s), which is published every second, after which a robot counts as lost."""


def _printed(lines: list[str]) -> list[str]:
    """Return what a program has printed, without the traceback of its end by Ctrl-C."""
    if lines and lines[-1].startswith("KeyboardInterrupt") and TRACEBACK in lines:
        return lines[: lines.index(TRACEBACK)]
    return lines


def _check(running: Run) -> None:
    try:
        running.check()
    except Unmet as unmet:
        error = str(said(unmet.values.get("error", unmet.figure))).removesuffix(".")
        where = said(unmet.values.get("where", ""))
        raise bad_value(f"Your program has ended with an error: {error}{where}.") from unmet


def _end(robot: Robot, lease: Lease, *, home: bool) -> bool:
    """Bring the head home, if that is wanted, and give the robot back; return whether the head is home."""
    try:
        if home and robot.status().lease == lease.number:
            _go_home(robot)
            return True
        if home:
            note("The head is not home, because the robot is no longer yours.")
    except BeatrixError as error:
        note(f"The head is not home: {error.message}")
    finally:
        with contextlib.suppress(BeatrixError):  # the lease ends with this session
            lease.close()
    return False


def _go_home(robot: Robot) -> None:
    """Go home; a program that was ended has stopped the robot as Ctrl-C does, and then its seat must pause."""
    try:
        robot.home()
    except Refused as error:
        detail = error.detail
        own = detail is not None and detail.presser == detail.holder
        if error.reason is not Reason.STOPPED or detail is None or not own or not detail.wait_s:
            raise
        time.sleep(detail.wait_s + POLL_S)
        robot.home()
