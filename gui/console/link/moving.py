"""What moves the robots of the shown name. A newer motion ends what it replaces, and begins when that has ended."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Final

from beatrix_zenoh.client import lease
from beatrix_zenoh.client.motion import Motion
from beatrix_zenoh.client.robot import Robot
from beatrix_zenoh.client.twin import Twin
from beatrix_zenoh.client.twin_motion import TwinMotion, TwinReplies
from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.errors import BeatrixError, Refused
from beatrix_zenoh.settings import Settings
from gui.console.link.block_run import BlockRun
from gui.console.link.choreographies import Playing
from gui.console.link.jobs import Jobs
from gui.console.link.jogging import Held
from gui.console.link.outcomes import WindowError, done, failed, replaced
from gui.console.link.person import SimulatedPerson
from gui.console.link.programs import ProgramRun
from gui.console.link.request import OneMotion, Program, Question, Report, RobotRequest, TwinMotionRequest
from gui.console.link.sounds import Sounds
from gui.console.state import actions
from gui.console.state.actions import Outcome
from gui.console.state.world import PlanProgress, ProgramProgress

PROGRAM_S: Final = 2.0
"""Longest time that a motion waits for the end of a program that it replaces."""
RobotAction = (
    actions.Send
    | actions.Play
    | actions.RunBlocks
    | actions.SendCommand
    | actions.AskLease
    | actions.MakeReady
)
"""Actions that robots of the shown name answer."""


class Moving:
    """Carries out requests for one robot or both; no method waits for a robot. Any thread may call them."""

    def __init__(self, jobs: Jobs, report: Report, own: tuple[Path, ...] = ()) -> None:
        """Store the arguments; `report` is called with outcomes; `own`: folders of gestures besides that of the user."""
        self._jobs, self._report, self._own = jobs, report, own
        self.person, self.sounds = SimulatedPerson(jobs), Sounds(jobs)
        self._python: ProgramRun | None = None
        """the program of Python that was started last"""
        self._lock = threading.Lock()
        self._requests: list[RobotRequest] = []
        """those that wait or are under way, the oldest first"""
        self._held: Held | None = None
        """the newest press of a held button"""

    @property
    def busy(self) -> bool:
        """Whether robots move, or are about to move, for the link."""
        return any(request.moves for request in self._requests.copy())

    @property
    def plan(self) -> PlanProgress | None:
        """How far the newest motion of both robots is; None: there is none."""
        plans = self._plans()
        return plans[-1].progress() if plans else None

    def _plans(self) -> list[TwinMotionRequest]:
        return [request for request in self._requests.copy() if isinstance(request, TwinMotionRequest)]

    @property
    def program(self) -> Program | None:
        """The newest play, program of blocks, or program of Python."""
        programs = [request for request in self._requests.copy() if isinstance(request, Program)]
        return programs[-1] if programs else None

    def python(self, now_s: float) -> ProgramProgress:
        """Return how far the newest program of Python is, at a time (monotonic clock, s)."""
        return ProgramProgress() if self._python is None else self._python.progress(now_s)

    # -- actions ------------------------------------------------------------------------------------

    def request(self, action: RobotAction, twin: Twin) -> None:
        """Carry out an action."""
        sides = (action.side,) if isinstance(action, actions.MakeReady | actions.AskLease) else action.sides
        robots = robots_of(twin, sides)
        if not robots:
            self._report(failed(action.row, "", WindowError(Reason.BAD_VALUE, "off.unchecked")))
            return
        match action:
            case actions.Send(row=row, query=query, lead_s=lead_s) if len(robots) > 1:
                self._put(TwinMotionRequest(row, twin, query, lead_s))
            case actions.Send(row=row, query=query):
                self._put(OneMotion(row, robots[0], query))
            case actions.Play():
                self._put(Playing(action, twin if len(robots) > 1 else robots[0], self.sounds, self._own))
            case actions.RunBlocks():
                self._put(BlockRun(action, twin if len(robots) > 1 else robots[0], self._own))
            case actions.SendCommand(row=row, command=command, value=value):
                self._ask(row, robots, lambda robot: robot.command(command, value=value).message)
            case actions.AskLease(row=row, action=asked):
                self._ask(row, robots, lambda robot: lease.ask(robot, asked).message)
            case actions.MakeReady(row=row):
                self._ask(row, robots, _make_ready)

    def run_program(self, action: actions.RunProgram, settings: Settings) -> None:
        """Run a program, which gets the robot, the router and the seat of the settings; it may need no robot."""
        self._python = ProgramRun(action, settings, self.person)
        self._put(self._python)

    def _ask(self, row: int, robots: tuple[Robot, ...], ask: Callable[[Robot], str]) -> None:
        for robot in robots:
            self._put(Question(row, robot, ask))

    def hold(self, action: actions.Hold, twin: Twin) -> None:
        """Begin or continue the motion of a held button; late heartbeats of earlier presses are ignored."""
        if self._held is None or action.row > self._held.row:
            self._held = Held(action, robots_of(twin, action.sides))
            self._put(self._held)
        if action.row == self._held.row:
            self._held.beat(action.shares)

    def release(self, row: int) -> None:
        """End the press of this row, unless it has ended."""
        if self._held is not None and self._held.row == row:
            self._held.release()

    def send_now(self) -> None:
        """Send the waiting motion of both robots to the hardware now."""
        for plan in self._plans():
            if plan.motion is not None:
                plan.motion.send_now()

    def abort(self) -> None:
        """Stop the simulation and keep the hardware unmoved; if the motion was sent to the hardware, stop both."""
        for plan in self._plans():
            self._end(plan, WindowError(Reason.STOPPED, "result.aborted"))

    def end_program(self) -> None:
        """End the program of Python, because the user wants it."""
        if self._python is not None:
            self._python.end(None)

    def end_blocks(self) -> None:
        """End the program of blocks, and stop the robots, because the user wants it."""
        if isinstance(program := self.program, BlockRun):
            self._end(program, WindowError(Reason.STOPPED, "result.aborted"))

    # -- the end of requests ------------------------------------------------------------------------

    def drop(self, why: BeatrixError) -> None:
        """End all requests; the caller stops robots that move already."""
        for request in self._requests.copy():
            self._end(request, why)

    def deselect(self) -> None:
        """End all requests and stop the robots, because later STOPs of the user go to another robot."""
        moving = self._requests.copy()
        self.drop(WindowError(Reason.STOPPED, "result.deselected"))
        for request in moving:
            if isinstance(request, OneMotion):
                request.halt()

    def _end(self, request: RobotRequest, why: BeatrixError) -> None:
        """End a request; one that still waits is over at once."""
        request.end(why)
        if not request.running:
            self._finish(request, failed(request.row, request.side, why))

    def _finish(self, request: RobotRequest, outcome: Outcome) -> None:
        """Report the last outcome, unless that was done before."""
        if self._remove(request):
            self._report(outcome)

    def _remove(self, request: RobotRequest) -> bool:
        """Forget a request; return False if that was done before."""
        request.over.set()
        with self._lock:
            known = request in self._requests
            if known:
                self._requests.remove(request)
        return known

    # -- one after the other in each queue ----------------------------------------------------------

    def _put(self, request: RobotRequest) -> None:
        """Queue a request, which ends what it replaces."""
        programs = self._make_way(request) if request.moves else []
        with self._lock:
            self._requests.append(request)
        self._jobs.put(request.queue, lambda: self._run(request, programs))

    def _make_way(self, new: RobotRequest) -> list[Program]:
        """End what a new motion replaces, and return the programs that it must wait for.

        A robot replaces the motion that it makes by itself.
        """
        present = self._requests.copy()
        programs = [request for request in present if isinstance(request, Program)]
        for request in present:
            waits = request.moves and not request.running and {*new.sides} & {*request.sides}
            leads = request.leading and isinstance(new, Program)
            if request in programs or waits or leads:
                self._end(request, replaced())
        return programs

    def _run(self, request: RobotRequest, programs: list[Program]) -> None:
        for program in programs:
            program.over.wait(PROGRAM_S)
        if request.over.is_set():
            return
        began_s = time.monotonic()
        try:
            motion = request.perform(partial(self._tell, request))
        except BeatrixError as error:
            outcome = failed(request.row, request.side, _explained(error))
            self._finish(request, replace(outcome, block=request.block))
            return
        except Exception:
            self._remove(request)
            raise
        if isinstance(motion, str):
            took_s = time.monotonic() - began_s
            self._finish(request, done(request.row, request.side, motion, took_s))
            return
        if isinstance(request, OneMotion):
            self._end_leading()
        motion.add_done_callback(lambda motion: self._ended(request, motion, began_s))

    def _tell(self, request: RobotRequest, outcome: Outcome) -> None:
        """Report an outcome that is not the last one."""
        if not request.over.is_set():
            self._report(outcome)

    def _end_leading(self) -> None:
        for request in self._requests.copy():
            if request.leading:
                self._end(request, replaced())

    def _ended(self, request: RobotRequest, motion: Motion | TwinMotion, began_s: float) -> None:
        error = motion.exception(0.0)
        if isinstance(error, BeatrixError):
            self._finish(request, failed(request.row, request.side, _explained(error)))
        elif error is not None:
            raise error
        else:
            reply = motion.result(0.0)
            message = reply.hw.message if isinstance(reply, TwinReplies) else reply.message
            self._finish(request, done(request.row, request.side, message, time.monotonic() - began_s))


def _explained(error: BeatrixError) -> BeatrixError:
    """Return the error to report: no newer motion has replaced one whose preview is obsolete."""
    obsolete = isinstance(error, Refused) and error.reason is Reason.REPLACED
    return WindowError(Reason.NOT_AT_REST, "result.moved") if obsolete else error


def _make_ready(robot: Robot) -> str:
    robot.make_ready()
    return "Motors on, home declared."


def robots_of(twin: Twin, sides: tuple[str, ...]) -> tuple[Robot, ...]:
    """Return the robots of these sides, the simulation first."""
    return tuple(robot for robot in (twin.sim, twin.hw) if robot.side in sides)
