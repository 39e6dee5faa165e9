"""The programs that follow a face and turn to a sound."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Iterator
from importlib import resources
from pathlib import Path
from typing import Final

import msgspec

from beatrix_zenoh.client.robot import Robot
from beatrix_zenoh.contract import tracebacks
from beatrix_zenoh.contract._generated.messages import Detail, Reason, TargetReply
from beatrix_zenoh.contract.errors import BeatrixError, Refused
from beatrix_zenoh.processes import POLL_S, Child, Supervisor
from beatrix_zenoh.settings import Settings
from gui.console.link.outcomes import WindowError, accepted
from gui.console.link.person import SimulatedPerson
from gui.console.link.request import BOTH, Program, Report
from gui.console.state.actions import FOLLOW, TURN, FollowFace
from gui.console.state.world import FaceProgress

SHIPPED: Final = Path(str(resources.files("beatrix_zenoh"))) / "examples"
END_S = 1.4
"""Time (s) in which the program ends; 0.4 s before, it is killed."""

STILL_S = 0.3
"""Time (s) after which a person at the same place stands still."""


class Failure(msgspec.Struct, frozen=True):
    """The last line of a program that an error of the SDK has ended, as `tracebacks` prints it."""

    reason: Reason
    message: str
    detail: Detail | None = None


class FaceProgram:
    """The files of the program that runs or ran last, and the last line that it has printed."""

    def __init__(self) -> None:
        self.name, self.line = FOLLOW, ""

    @property
    def _own(self) -> Path:
        return Path.home() / "beatrix-programs" / self.name

    @property
    def file(self) -> Path:
        """The user's copy if there is one, otherwise the shipped program."""
        return self._own if self._own.is_file() else SHIPPED / self.name

    def progress(self, program: Program | None) -> FaceProgress:
        """Return whether the program runs, its files, and its last line."""
        running = isinstance(program, Following)
        sides = program.sides if running and program is not None else ()
        return FaceProgress(running, self.file, self._own, self.line, sides)


class Following(Program):
    """One run of the program."""

    def __init__(
        self, action: FollowFace, settings: Settings, face: FaceProgram, person: SimulatedPerson
    ) -> None:
        """Store the arguments; the program is run for the robot of the settings."""
        super().__init__(action.row, action.sides, BOTH)
        self._settings, self._face, self._person = settings, face, person
        face.name, face.line = action.program, ""

    def run(self, report: Report) -> str:
        """Run the program until its end; raises the reason why it must end, or its failure."""
        face, settings = self._face, self._settings
        environment = {
            "BEATRIX_ROBOT": settings.robot,
            "BEATRIX_CONNECT": settings.connect,
            "BEATRIX_WHO": settings.who,
            "PYTHONUNBUFFERED": "1",
            "PYTHONIOENCODING": "utf-8",
            tracebacks.VARIABLE: tracebacks.DATA,
        }
        children = Supervisor(environment)
        with contextlib.ExitStack() as scene:
            self._prepare(scene)
            try:
                self.check()
                child = children.start("program", "--program", str(face.file), *self.sides)
                report(accepted(self.row, self.side, "Started.", 0.0))
                while child.code is None and not self.ends:
                    time.sleep(POLL_S)
                if not self.ends:
                    self._read_end(child)
            except OSError as error:
                face.line = str(error)
                raise program_failed() from error
            finally:
                children.end_all(time.monotonic() + END_S)
        self.check()
        return "Ended."

    def _prepare(self, scene: contextlib.ExitStack) -> None:
        """Let the simulated person do what a simulated robot can see or hear, until the end of the scene."""
        person = self._person
        if self.sides[0] == "sim" and self._face.name == TURN:
            person.speak(on=True)
            scene.callback(person.speak, on=False)
        elif self.sides[0] == "sim":
            scene.enter_context(walking(self._settings, person))

    def _read_end(self, child: Child) -> None:
        """Store the last line of a program that has ended by itself; raise its failure."""
        lines = [line for line in child.lines() if line.strip()]
        line = self._face.line = lines[-1] if lines else ""
        if child.code:
            error = failure(line)
            self._face.line = line if isinstance(error, WindowError) else error.message
            raise error


@contextlib.contextmanager
def walking(settings: Settings, person: SimulatedPerson) -> Iterator[None]:
    """Let the simulated person sway during the block if it stands still, until the user drags it."""
    with contextlib.ExitStack() as ends:
        with contextlib.suppress(BeatrixError):  # the program follows without it, too
            name, connect, who = settings.robot, settings.connect, settings.who
            # In a session of its own: that of the window closes before this program has ended.
            robot = ends.enter_context(Robot(name, side="sim", connect=connect, who=who))
            stood = robot.target()
            time.sleep(STILL_S)
            if robot.target() == stood:
                moves = person.moves
                robot.walk_target("sway")
                ends.callback(lambda: put_back(robot, stood) if person.moves == moves else None)
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
