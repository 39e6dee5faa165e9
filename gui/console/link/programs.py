"""Plays, and the program that follows a face."""

from __future__ import annotations

import contextlib
import shutil
import time
from abc import abstractmethod
from collections.abc import Iterator
from dataclasses import replace
from importlib import resources
from pathlib import Path
from typing import Final

import msgspec

from beatrix_zenoh.client.robot import Robot
from beatrix_zenoh.client.twin import Twin
from beatrix_zenoh.contract._generated.messages import Detail, Reason, TargetReply
from beatrix_zenoh.contract.errors import BeatrixError, Refused
from beatrix_zenoh.processes import POLL_S, Child, Supervisor
from beatrix_zenoh.settings import Settings
from gui.console.link.jobs import Jobs
from gui.console.link.outcomes import WindowError, accepted, written
from gui.console.link.request import BOTH, Report, Request
from gui.console.state.actions import CopyProgram, FollowFace, Play
from gui.console.state.world import FaceProgress

NAME: Final = "follow_the_face.py"
SHIPPED: Final = Path(str(resources.files("beatrix_zenoh"))) / "examples" / NAME
END_S = 1.0
"""Time (s) in which the program ends itself; after it the program is killed."""

STILL_S = 0.3
"""Time (s) after which a person at the same place stands still."""


class Program(Request):
    """What moves robots until it ends or must end; its thread looks whether it must."""

    def __init__(self, row: int, sides: tuple[str, ...], side: str) -> None:
        """Store row and robots."""
        super().__init__(row, "programs", sides, side)

    def perform(self, report: Report) -> str:
        """Do the work until the end."""
        self.running = True
        self.check()
        return self.run(report)

    @abstractmethod
    def run(self, report: Report) -> str:
        """Report the beginning, do the work until the end, and return the message; ends soon after `ends` is set."""

    def check(self) -> None:
        """Raise `ending` if there is one."""
        if self.ending is not None:
            raise self.ending


class Playing(Program):
    """One play."""

    def __init__(self, action: Play, robots: Twin | Robot) -> None:
        """Store the arguments."""
        super().__init__(action.row, action.sides, BOTH if isinstance(robots, Twin) else robots.side)
        self._action, self._robots, self.title = action, robots, action.title
        self.pose = -1
        """number of the pose of the window that began last, from 0; -1: none"""

    def run(self, report: Report) -> str:
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

    def __init__(self, action: FollowFace, settings: Settings, face: FaceProgram) -> None:
        """Store the arguments; the program is run for the robot of the settings."""
        super().__init__(action.row, action.sides, BOTH)
        self._sides, self._settings, self._face = action.sides, settings, face

    def run(self, report: Report) -> str:
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
