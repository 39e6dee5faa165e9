"""Plays and the program that follows a face: the newest one ends the one before, and begins when that has ended."""

from __future__ import annotations

import contextlib
import shutil
import threading
import time
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator
from dataclasses import replace
from importlib import resources
from pathlib import Path
from typing import ClassVar, Final

import msgspec

from beatrix_zenoh.client.robot import Robot
from beatrix_zenoh.client.twin import Twin
from beatrix_zenoh.contract._generated.messages import Detail, Reason, TargetReply
from beatrix_zenoh.contract.errors import BeatrixError, Refused
from beatrix_zenoh.processes import POLL_S, Child, Supervisor
from beatrix_zenoh.settings import Settings
from gui.console.link.jobs import Jobs
from gui.console.link.outcomes import WindowError, accepted, done, failed, replaced, written
from gui.console.state.actions import CopyProgram, FollowFace, Outcome, Play
from gui.console.state.world import FaceProgress

Report = Callable[[Outcome], None]
NAME: Final = "follow_the_face.py"
SHIPPED: Final = Path(str(resources.files("beatrix_zenoh"))) / "examples" / NAME
END_S = 1.0
"""Time (s) in which the program ends itself; after it the program is killed."""

STILL_S = 0.3
"""Time (s) after which a person at the same place stands still."""


class Program(ABC):
    """What moves robots until it ends or must end, from the request to its end."""

    QUEUE: ClassVar[str]
    """queue of the jobs of this class"""
    WAIT_S: ClassVar[float]
    """longest time (s) that a newer motion waits for the end"""

    def __init__(self, row: int, side: str) -> None:
        """Store row and side of the outcomes; without a side they are those of both robots."""
        self.row, self.side = row, side
        self.ends = False
        """whether it must end"""
        self.ending: BeatrixError | None = None
        """why it must end; None: it may go on, or the user has ended it"""
        self.over = threading.Event()
        """set at the end"""

    @abstractmethod
    def perform(self, report: Report) -> str:
        """Report the beginning, do the work until the end, and return the message; ends soon after `ends` is set."""

    def end(self, why: BeatrixError | None) -> None:
        """End it for a reason, unless it must end already; None: the user has ended it. Returns at once."""
        if not self.ends:
            self.ending, self.ends = why, True

    def check(self) -> None:
        """Raise `ending` if there is one."""
        if self.ending is not None:
            raise self.ending

    def wait_ended(self) -> None:
        """Wait for the end, at most WAIT_S."""
        self.over.wait(self.WAIT_S)


class Programs:
    """Runs the newest program."""

    def __init__(self, jobs: Jobs, report: Report, clear: Callable[[], None]) -> None:
        """Store the arguments; `clear` ends other motions before a program begins."""
        self._jobs, self._report, self._clear = jobs, report, clear
        self._lock = threading.Lock()
        self.newest: Program | None = None
        """the newest program, until its end"""

    def begin(self, program: Program) -> None:
        """Begin a program, which replaces the present one; returns at once."""
        with self._lock:
            before, self.newest = self.newest, program
        if before is not None:
            before.end(replaced())
        self._jobs.put(program.QUEUE, lambda: self._run(program, before))

    def end(self, why: BeatrixError) -> None:
        """End the present program; returns at once."""
        if (program := self.newest) is not None:
            program.end(why)

    def wait_ended(self) -> None:
        """Wait for the end of the present program, at most its WAIT_S."""
        if (program := self.newest) is not None:
            program.wait_ended()

    def _run(self, program: Program, before: Program | None) -> None:
        began_s = time.monotonic()
        try:
            if before is not None:
                before.wait_ended()
            program.check()
            self._clear()
            message = program.perform(self._report)
            outcome = done(program.row, program.side, message, time.monotonic() - began_s)
        except BeatrixError as error:
            outcome = failed(program.row, program.side, error)
        finally:
            with self._lock:
                if self.newest is program:
                    self.newest = None
            program.over.set()
        self._report(outcome)


class Playing(Program):
    """One play."""

    QUEUE, WAIT_S = "play", 1.0

    def __init__(self, action: Play, robots: Twin | Robot) -> None:
        """Store the arguments."""
        super().__init__(action.row, "" if isinstance(robots, Twin) else robots.side)
        self._action, self._robots, self.title = action, robots, action.title
        self.pose = -1
        """number of the pose of the window that began last, from 0; -1: none"""

    def perform(self, report: Report) -> str:
        """Check all of the play, then play it."""
        from gui.console.link.choreographies import prepared  # noqa: PLC0415  # numpy and the planner would delay the window

        def begun(rounds: int = 0) -> None:
            told = accepted(self.row, self.side, f"{self.title}: checked.", lasts_s)
            report(replace(told, rounds=rounds))

        def posed(number: int) -> None:
            if self._action.poses:
                self.pose = number

        lasts_s, play = prepared(self._action, self._robots, self.check, begun, posed)
        self.check()
        begun()
        play()
        return f"{self.title}: played."


class Failure(msgspec.Struct, frozen=True):
    """The last line of a program that an error of the SDK has ended, as `beatrix` prints it."""

    reason: Reason
    message: str
    detail: Detail | None = None


class FaceProgram:
    """The files of the program, and the last line that it has printed."""

    def __init__(self, jobs: Jobs, report: Report) -> None:
        self._jobs, self._report = jobs, report
        self._own = Path.home() / "beatrix-programs" / NAME
        self.file = self.chosen()
        self.line = ""

    def progress(self, *, running: bool) -> FaceProgress:
        """Return whether the program runs, its files, and its last line."""
        return FaceProgress(running, self.file, self._own, self.line)

    def chosen(self) -> Path:
        """Return the user's copy if there is one, otherwise the shipped program."""
        return self._own if self._own.is_file() else SHIPPED

    def copy(self, action: CopyProgram) -> None:
        """Copy the shipped program to the file of the action, unless it exists; returns at once."""
        self._jobs.put("files", lambda: self._copy(action))

    def _copy(self, action: CopyProgram) -> None:
        def write() -> None:
            if not action.file.exists():
                action.file.parent.mkdir(parents=True, exist_ok=True)
                shutil.copyfile(SHIPPED, action.file)
            self.file = action.file

        self._report(written(action.row, action.file, write))


class Following(Program):
    """One run of the program."""

    QUEUE, WAIT_S = "face", 2.0

    def __init__(self, action: FollowFace, settings: Settings, face: FaceProgram) -> None:
        """Store the arguments; the program is run for the robot of the settings."""
        super().__init__(action.row, "")
        self._sides, self._settings, self._face = action.sides, settings, face

    def perform(self, report: Report) -> str:
        """Run the program until its end; raises the reason why it must end, or its failure."""
        face = self._face
        face.file, face.line = face.chosen(), ""
        with walking(self._settings) if self._sides[0] == "sim" else contextlib.nullcontext():
            try:
                self._follow(report)
            except OSError as error:
                face.line = str(error)
                raise program_failed() from error
        self.check()
        return "Ended."

    def _follow(self, report: Report) -> None:
        settings = self._settings
        environment = {
            "BEATRIX_ROBOT": settings.robot,
            "BEATRIX_CONNECT": settings.connect,
            "BEATRIX_WHO": settings.who,
            "PYTHONUNBUFFERED": "1",
            "PYTHONIOENCODING": "utf-8",
        }
        children = Supervisor(environment)
        try:
            if not self.ends:
                child = children.start("program", "--program", str(self._face.file), *self._sides)
                report(accepted(self.row, "", "Started.", 0.0))
                self._watch(child)
        finally:
            children.end()

    def _watch(self, child: Child) -> None:
        while child.code is None and not self.ends:
            time.sleep(POLL_S)
        if self.ends:
            child.end(END_S)
            return
        lines = [line for line in child.lines() if line.strip()]
        line = self._face.line = lines[-1] if lines else ""
        if child.code:
            error = failure(line)
            self._face.line = line if isinstance(error, WindowError) else error.message
            raise error


@contextlib.contextmanager
def walking(settings: Settings) -> Iterator[None]:
    """Let the simulated person sway during the block if it stands still, so that the head has something to follow."""
    with contextlib.ExitStack() as ends:
        with contextlib.suppress(BeatrixError):  # the program follows without it, too
            name, connect, who = settings.robot, settings.connect, settings.who
            # In a session of its own: that of the window closes before this program has ended.
            robot = ends.enter_context(Robot(name, side="sim", connect=connect, who=who))
            stood = robot.target()
            time.sleep(STILL_S)
            if robot.target() == stood:
                robot.walk_target("sway")
                ends.callback(put_back, robot, stood)
        yield


def put_back(robot: Robot, place: TargetReply) -> None:
    """Let the simulated person stand where it stood, unless the simulation has gone."""
    with contextlib.suppress(BeatrixError):
        robot.move_target(place.x, place.y, place.z)


def program_failed() -> WindowError:
    """Return the error of a program that has failed; its last line is in `FaceProgress.line`."""
    return WindowError(Reason.BAD_VALUE, "result.program_failed")


def failure(line: str) -> BeatrixError:
    """Return the error that the last line of a program contains, or one that says that it has failed."""
    try:
        found = msgspec.json.decode(line, type=Failure)
    except msgspec.DecodeError:
        return program_failed()
    return Refused(found.reason, found.message, found.detail)
