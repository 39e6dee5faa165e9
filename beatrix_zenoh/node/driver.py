"""What a robot does with requests: one thread, one running motion, a true reply for everybody."""

from __future__ import annotations

import secrets
import time
from collections import deque
from collections.abc import Callable

from beatrix_zenoh._generated.messages import (
    Command,
    CommandQuery,
    MotionQuery,
    Phase,
    PoseQuery,
    Reason,
    Vector3,
)
from beatrix_zenoh._generated.serial import FrameType, Outcome, State, Telemetry
from beatrix_zenoh.board.board import Board
from beatrix_zenoh.drive import Arms
from beatrix_zenoh.errors import BeatrixError, NoAnswer, Refused
from beatrix_zenoh.lease import Lease
from beatrix_zenoh.names import ARM_TOPICS, OLD_PROGRAMS
from beatrix_zenoh.node import outcome
from beatrix_zenoh.node.answers import (
    Asker,
    at_rest,
    command_reply,
    motion_reply,
    not_stopped,
    unknown_command,
)
from beatrix_zenoh.node.body import Body
from beatrix_zenoh.node.course import Course, Goal
from beatrix_zenoh.node.halt import Halt
from beatrix_zenoh.node.latch import Latch
from beatrix_zenoh.node.notices import Notices
from beatrix_zenoh.node.readiness import ready_telemetry
from beatrix_zenoh.node.running import NUMBERS, Running, next_number
from beatrix_zenoh.node.stopping import Stopping
from beatrix_zenoh.node.switching import calibrate, switch, unlatched

TEXT_SESSION = "text-port"
"""What stands for the session of old programs."""
LATE_S = 2.0
"""How much longer than planned a motion may take before the board has not made it."""
OF_VALUES = (Reason.OUT_OF_REACH, Reason.ARM_GAP, Reason.YAW_LIMIT, Reason.SPEED_LIMIT)
GONE = 256
"""Sessions that have ended and are remembered."""


class Driver:
    """The state machine between requests and the board.

    All methods are called on one thread (the node's mailbox reader), except `halt`; `holder`,
    `warnings`, `calibrations` and `arms` may be read from others.
    """

    def __init__(self, body: Body, board: Board, course: Course) -> None:
        self._body = body
        self._board = board
        self._course = course
        self._lease = Lease()
        self._halt = Halt()
        self._latch = Latch()
        self._running: Running | None = None
        self._stopping = Stopping(board)
        self._texting = self._text_moved = False
        self._pressed_by = self._moved_by = ""
        self._lost = True
        self._cause = Reason.STOPPED
        self._number = secrets.randbelow(NUMBERS)  # not again those of the node before
        self.calibrations = 0
        """How often home was set."""
        self._gone: deque[str] = deque(maxlen=GONE)
        self._notices = Notices()

    # -- read by the reporter -------------------------------------------------------------------

    @property
    def holder(self) -> str:
        """Seat that drives, empty if free."""
        return self._lease.holder(time.monotonic())

    @property
    def warnings(self) -> list[str]:
        """What went wrong lately without anybody to tell."""
        return self._notices.recent()

    def arms(self) -> Arms:
        """The firmware's set points, rad."""
        telemetry = self._board.telemetry
        return (0.0, 0.0, 0.0) if telemetry is None else self._course.gear.to_rad(telemetry.position)

    # -- motions --------------------------------------------------------------------------------

    def motion(self, query: MotionQuery | PoseQuery, asker: Asker, hint: str = "") -> None:
        """Begin a motion: replies accepted now, done when it ends; `hint` follows a refusal of its values."""

        def end(reason: Reason, text: str) -> None:
            took_s = time.monotonic() - started
            asker.answer(motion_reply(Phase.DONE, reason, text, number, took_s, self.arms()))
            asker.finish()

        def accept(number: int, goal: Goal) -> None:
            text = f"On the way, {goal.duration:.1f} s."
            asker.answer(motion_reply(Phase.ACCEPTED, Reason.OK, text, number, goal.duration, goal.target))

        self._latch.works(asker.session)
        try:
            goal = self._goal(query, asker)
            number, started = self._begin(goal, asker, end, accept)
        except BeatrixError as error:
            told = error.message + (hint if error.reason in OF_VALUES else "")
            self.decline_motion(asker, BeatrixError(error.reason, told))

    def decline_motion(self, asker: Asker, error: BeatrixError) -> None:
        """Tell the asker why nothing moves."""
        asker.answer(motion_reply(Phase.ACCEPTED, error.reason, error.message, 0, 0.0, self.arms()))
        asker.finish()

    def _goal(self, query: MotionQuery | PoseQuery, asker: Asker) -> Goal:
        now = time.monotonic()
        if asker.session in self._gone:  # its motions may still be on their way when it has gone
            raise Refused(Reason.CLIENT_LOST, "The session that asked for this motion has ended.")
        self._lease.check(asker.who, now)
        goal = self._course.goal(query, ready_telemetry(self._board))
        self._halt.check(asker.who, asker.session, now, resting=not self._moving() and not self._stopping)
        return goal

    def _begin(
        self,
        goal: Goal,
        asker: Asker,
        end: Callable[[Reason, str], None],
        accept: Callable[[int, Goal], None] = lambda *_: None,
    ) -> tuple[int, float]:
        """Give the board a goal, `accept` its motion, and only then tell the one it replaces; number and begin (monotonic, s)."""
        now = time.monotonic()
        # A new number even if the board will not answer: it may have heard, and ignores one that it knows.
        telemetry = self._board.telemetry
        self._number = number = next_number(self._number, 0 if telemetry is None else telemetry.motion)
        try:
            self._board.move(goal.frame(number))
        except NoAnswer:
            self.stop_motion()  # the board may have heard it, and nobody is told that it moves
            raise
        self._lease.take(asker.who, now)
        replaced = self._running
        boot = 0 if telemetry is None else telemetry.boot
        self._running = Running(number, asker, goal, boot, now + goal.duration + LATE_S, end)
        self._cause, self._moved_by = Reason.STOPPED, asker.session
        accept(number, goal)
        if replaced is not None:
            replaced.end(Reason.REPLACED, f"A newer motion ({number}, from {asker.who}) took over.")
        return number, now

    def arm_target(self, arm: int, angle: float) -> None:
        """Turn one arm (0, 1, 2) to `angle` rad, as the per-arm topics of 2023 do."""
        asker = Asker(ARM_TOPICS, "", lambda _: None, lambda: None)
        running = self._running
        target = list(running.goal.target if running and running.asker.who == ARM_TOPICS else self.arms())
        target[arm] = angle
        query = MotionQuery(position=Vector3(*target))
        try:
            self._begin(self._goal(query, asker), asker, self._end_arm_target)
        except BeatrixError as error:
            self.warn(f"{ARM_TOPICS}: {error.message}")

    def text_check(self, *, moves: bool) -> None:
        """Let an old program act on the robot, and drive it if it `moves`.

        Raises:
            Refused: somebody else drives, or STOP was pressed.
        """
        now = time.monotonic()
        self._lease.check(OLD_PROGRAMS, now)
        if not moves:
            return
        if self._running is not None:
            raise Refused(
                Reason.BUSY, f"A motion of {self._running.asker.who} is under way: wait for its end."
            )
        # Its own STOP is sorted out by the firmware, which knows when the arms rest.
        resting = self._pressed_by == TEXT_SESSION or (not self._moving() and not self._stopping)
        self._halt.check(OLD_PROGRAMS, TEXT_SESSION, now, resting=resting)
        self._lease.take(OLD_PROGRAMS, now)
        self._texting, self._text_moved, self._moved_by = True, False, TEXT_SESSION

    def text_tried(self) -> None:
        """An old program asks for motions faster than they can wait."""
        self._halt.tried(OLD_PROGRAMS, time.monotonic())

    def text_refused(self) -> bool:
        """The firmware has said no to a line of an old program: if nothing moved (true), it does not drive for it."""
        now = time.monotonic()
        if self._texting and not self._text_moved and self._lease.holder(now) == OLD_PROGRAMS:
            self._texting = False
            self._lease.give_back(now)
        return not self._text_moved

    def text_rests(self) -> None:
        """No motion of an old program is under way or waits."""
        if self._texting:
            self._texting, now = False, time.monotonic()
            if self._lease.holder(now) == OLD_PROGRAMS:
                self._lease.rest(now)

    def _end_arm_target(self, reason: Reason, text: str) -> None:
        if reason not in (Reason.OK, Reason.REPLACED):
            self.warn(f"{ARM_TOPICS}: {text}")

    def warn(self, text: str) -> None:
        """Show something in status for a while."""
        self._notices.add(text)

    # -- commands -------------------------------------------------------------------------------

    def command(self, query: CommandQuery, asker: Asker, asked_s: float) -> None:
        """Carry out a command other than STOP and EMERGENCY_STOP that came at `asked_s` (monotonic)."""
        self._latch.works(asker.session)
        try:
            if query.command == Command.ENABLE:
                if query.value:
                    self._latch.check(asker.session, asked_s, time.monotonic())
                self._lease.check(asker.who, time.monotonic())
                text = switch(self._board, on=query.value)
            elif query.command == Command.CALIBRATE:
                text = self._calibrate(asker.who)
            elif query.command == Command.HOME:
                self._home(asker)
                return
            else:
                raise unknown_command(query.command)
        except BeatrixError as error:
            self.answer_command(asker, error)
            return
        self._answer(asker, Reason.OK, text)

    def answer_command(self, asker: Asker, error: BeatrixError) -> None:
        """Tell the asker why nothing was done."""
        self._answer(asker, error.reason, error.message)

    def _answer(self, asker: Asker, reason: Reason, text: str) -> None:
        asker.answer(command_reply(reason, text, self.arms()))
        asker.finish()

    def _calibrate(self, who: str) -> str:
        self._lease.check(who, time.monotonic())
        text = calibrate(self._board, self._body, self.arms())
        self.calibrations += 1
        return text

    def _home(self, asker: Asker) -> None:
        def end(reason: Reason, text: str) -> None:
            self._answer(asker, reason, text)

        query = MotionQuery(position=Vector3(0.0, 0.0, 0.0))
        self._begin(self._goal(query, asker), asker, end)

    # -- ends -----------------------------------------------------------------------------------

    def halt(self, session: str, *, emergency: bool = False) -> None:
        """STOP was pressed by `session` (empty: unknown): begin no motion. Called on Zenoh's thread."""
        now = time.monotonic()
        self._pressed_by = session
        if emergency:
            self._latch.press(session, now)
        # Who holds the robot between two motions has a program that goes on, too.
        self._halt.press(self._lease.holder(now), self._moved_by, session, now)

    def stopped(self, asker: Asker | None, error: BeatrixError | None, *, emergency: bool) -> None:
        """STOP was sent to the board on its own road; `asker` is told when the arms rest."""
        if asker is None:
            if self._driven:  # maybe begun behind STOP's back: its seat pauses, too
                now = time.monotonic()
                self._halt.press(self._lease.holder(now), self._moved_by, self._pressed_by, now)
            self._halt.sent()
            if error is None and emergency and unlatched(self._board):
                self.stop_motion(FrameType.EMERGENCY_STOP)  # an ENABLE may have been on its way
            elif error is None and self._driven:
                self.stop_motion()  # it may have been on its way when STOP passed it
            return
        if error is None and emergency and unlatched(self._board):
            error = NoAnswer(
                Reason.BOARD_LOST, "The board acknowledged but does not show the latch: press again."
            )
        if error is not None:
            self.answer_command(asker, not_stopped(error))
        elif self._moving() or self._running is not None:  # telemetry may lag behind what runs
            self._stopping.add(asker)
        else:
            self._answer(asker, Reason.OK, at_rest(self._board, "Nothing moves", self.arms()))

    def client_gone(self, session: str) -> None:
        """A client's session has ended: stop what it asked for, free the robot."""
        self._gone.append(session)
        self._latch.gone(session)
        if self._running is not None and self._running.asker.session == session:
            self._let_go()

    def router_gone(self) -> None:
        """Nobody can be heard any more, not even STOP: end what runs, whoever asked for it."""
        if self._driven:
            self._let_go()

    def _let_go(self) -> None:
        self._cause = Reason.CLIENT_LOST
        self.stop_motion()
        self._lease.free()

    def client_there(self, session: str) -> None:
        """A client's session has begun, or is back with its router."""
        while session in self._gone:
            self._gone.remove(session)

    def stop_motion(self, road: FrameType = FrameType.STOP) -> None:
        """Decelerate; a board that does not answer stops by itself for want of a heartbeat."""
        try:
            self._board.request(road)
        except BeatrixError as error:
            self.warn(error.message)

    def overdue(self) -> bool:
        """There is a reason to `observe` though telemetry does not change; may be called on any thread."""
        running = self._running
        return self._stopping.overdue() or (running is not None and running.overdue())

    def observe(self) -> None:
        """Telemetry or link have changed: end what has ended."""
        telemetry = self._board.telemetry
        lost = not self._board.connected
        self._text_moved |= self._texting and self._moving()
        if telemetry is not None:
            self._notices.started(telemetry.boot, home_known=bool(telemetry.state & State.CALIBRATED))
        known = (
            telemetry is not None and self._running is not None and telemetry.motion == self._running.number
        )
        if self._lost and not lost and self._moving() and not known:
            self.stop_motion()  # whoever asked for it was told that it has ended
        self._lost = lost
        if self._running is not None and telemetry is not None:
            self._end_running(self._running, telemetry, lost=lost)
        moving = self._running is not None or self._moving()
        if self._stopping and (not moving or self._stopping.overdue()):
            self._stopping.tell(self.arms(), moving=moving)

    def _end_running(self, running: Running, telemetry: Telemetry, *, lost: bool) -> None:
        moving = telemetry.state & State.MOVING
        if lost or telemetry.boot != running.boot:
            told = outcome.lost(reset=self._board.link.reset or not lost)
            self._finish(running, Reason.BOARD_LOST, told)
        elif moving:
            return
        elif telemetry.motion == self._number != running.number:
            self._finish(running, Reason.BOARD_LOST, outcome.UNTOLD)
        elif telemetry.motion == running.number and telemetry.outcome != Outcome.NONE:
            self._finish(running, *outcome.ended(telemetry.outcome, self._cause, self.arms()))
        elif running.overdue():
            self._finish(running, Reason.BOARD_LOST, outcome.NEVER_MADE)

    def _finish(self, running: Running, reason: Reason, text: str) -> None:
        self._running = None
        self._lease.rest(time.monotonic())
        running.end(reason, text)

    @property
    def _driven(self) -> bool:
        """A motion is under way, somebody's or an old program's."""
        return self._running is not None or self._texting

    def _moving(self) -> bool:
        return self._board.connected and bool(self._board.state & State.MOVING)

    def close(self) -> None:
        """Stop what runs, wait until it rests, tell everybody who waits."""
        if self._driven:
            self._cause = Reason.SHUTDOWN
            self.stop_motion()
            self._board.wait_for(lambda telemetry: not telemetry.state & State.MOVING, 0.8)
            self.observe()
        if self._running is not None:
            self._finish(self._running, Reason.SHUTDOWN, "The node is closing.")
        self._stopping.close(self.arms())
