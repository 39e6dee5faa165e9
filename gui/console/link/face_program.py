"""The program that follows a face, as a child process: it ends with a newer motion, STOP, or the window."""

from __future__ import annotations

import contextlib
import shutil
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from importlib import resources
from pathlib import Path
from typing import Final

import msgspec

from beatrix_zenoh.client.robot import Robot
from beatrix_zenoh.contract._generated.messages import Detail, Reason, TargetReply
from beatrix_zenoh.contract.errors import BeatrixError, Refused
from beatrix_zenoh.processes import POLL_S, Child, Supervisor
from beatrix_zenoh.settings import Settings
from gui.console.link.jobs import Jobs
from gui.console.link.newest import Newest
from gui.console.link.outcomes import WindowError, accepted, done, failed
from gui.console.state.actions import CopyProgram, FollowFace, Outcome
from gui.console.state.world import FaceProgress

NAME: Final = "follow_the_face.py"
SHIPPED: Final = Path(str(resources.files("beatrix_zenoh"))) / "examples" / NAME
END_S = 1.0
"""Time (s) in which the program ends itself; after it the program is killed."""
WAIT_S = 2.0
"""Longest time (s) that a newer motion waits for the end of the program."""

STILL_S = 0.3
"""Time (s) after which a person at the same place stands still."""


class Failure(msgspec.Struct, frozen=True):
    """The last line of a program that an error of the SDK has ended, as `beatrix` prints it."""

    reason: Reason
    message: str
    detail: Detail | None = None


@dataclass(eq=False)
class FaceJob:
    """One run of the program, from the request to its end."""

    action: FollowFace
    settings: Settings
    ending: BeatrixError | None = None
    """why the program must end; None: it may go on"""
    unwanted: bool = False
    """whether the user has ended it with the button"""

    @property
    def ends(self) -> bool:
        """Whether the program must end."""
        return self.unwanted or self.ending is not None


class FaceProgram:
    """Runs the program; methods except `wait_ended` return at once."""

    def __init__(self, jobs: Jobs, report: Callable[[Outcome], None]) -> None:
        self._jobs, self._report = jobs, report
        self._newest: Newest[FaceJob] = Newest()
        self._own = Path.home() / "beatrix-programs" / NAME
        self._file = self._chosen()
        self._line = ""

    def progress(self) -> FaceProgress:
        """Return whether the program runs, its files, and its last line."""
        return FaceProgress(self._newest.job is not None, self._file, self._own, self._line)

    def begin(self, action: FollowFace, settings: Settings, clear: Callable[[], None]) -> None:
        """Start the program for the robot of the settings; `clear` ends other motions, on the program's thread."""
        job = FaceJob(action, settings)
        self._newest.begin(job)
        self._jobs.put("face", lambda: self._run(job, clear))

    def end(self, why: BeatrixError | None) -> None:
        """End the program for a reason; None: the user has ended it."""
        job = self._newest.job
        if job is not None and not job.ends:
            job.ending, job.unwanted = why, why is None

    def wait_ended(self) -> bool:
        """Wait for the end of the program; return False after `WAIT_S`."""
        return self._newest.wait_ended(WAIT_S)

    def copy(self, action: CopyProgram) -> None:
        """Copy the shipped program to the file of the action, unless it exists."""
        self._jobs.put("files", lambda: self._copy(action))

    def _chosen(self) -> Path:
        """Return the user's copy if there is one, otherwise the shipped program."""
        return self._own if self._own.is_file() else SHIPPED

    # -- the program's thread -----------------------------------------------------------------------

    def _copy(self, action: CopyProgram) -> None:
        try:
            if not action.file.exists():
                action.file.parent.mkdir(parents=True, exist_ok=True)
                shutil.copyfile(SHIPPED, action.file)
        except OSError:
            error = WindowError(Reason.BAD_VALUE, "result.no_write", file=str(action.file))
            self._report(failed(action.row, "", error))
        else:
            self._file = action.file
            self._report(done(action.row, "", f"{action.file}: copied."))

    def _run(self, job: FaceJob, clear: Callable[[], None]) -> None:
        row, began_s, self._line = job.action.row, time.monotonic(), ""
        self._file = self._chosen()
        try:
            clear()
            self._perform(job)
            outcome = done(row, "", "Ended.", time.monotonic() - began_s)
        except BeatrixError as error:
            outcome = failed(row, "", error)
        except OSError as error:
            self._line = str(error)
            outcome = failed(row, "", program_failed())
        finally:
            self._newest.finish(job)
        self._report(outcome)

    def _perform(self, job: FaceJob) -> None:
        """Run the program until its end; raises the reason why it must end, or its failure."""
        settings = job.settings
        environment = {
            "BEATRIX_ROBOT": settings.robot,
            "BEATRIX_CONNECT": settings.connect,
            "BEATRIX_WHO": settings.who,
            "PYTHONUNBUFFERED": "1",
            "PYTHONIOENCODING": "utf-8",
        }
        children = Supervisor(environment)
        with walking(settings) if job.action.sides[0] == "sim" else contextlib.nullcontext():
            try:
                if not job.ends:
                    child = children.start("program", "--program", str(self._file), *job.action.sides)
                    self._report(accepted(job.action.row, "", "Started.", 0.0))
                    self._watch(job, child)
            finally:
                children.end()
        if job.ending is not None:
            raise job.ending

    def _watch(self, job: FaceJob, child: Child) -> None:
        while child.code is None and not job.ends:
            time.sleep(POLL_S)
        if job.ends:
            child.end(END_S)
            return
        lines = [line for line in child.lines() if line.strip()]
        self._line = lines[-1] if lines else ""
        if child.code:
            error = failure(self._line)
            self._line = self._line if isinstance(error, WindowError) else error.message
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
