"""Python programs of the user, and shipped ones, as child processes."""

from __future__ import annotations

import codecs
import collections
import contextlib
import os
import re
import subprocess
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Final

import msgspec

from beatrix_zenoh import processes, threads
from beatrix_zenoh.client import Client
from beatrix_zenoh.client.robot import Robot
from beatrix_zenoh.contract import tracebacks
from beatrix_zenoh.contract._generated.messages import Detail, Reason, TargetReply
from beatrix_zenoh.contract.errors import BeatrixError, Refused
from beatrix_zenoh.contract.names import SIDES
from beatrix_zenoh.settings import Settings
from gui.console.link.outcomes import WindowError, accepted
from gui.console.link.person import SimulatedPerson
from gui.console.link.request import BOTH, Program, Report
from gui.console.state.actions import FOLLOW, TURN, RunProgram
from gui.console.state.world import ProgramProgress

END_S: Final = 0.4
"""Time in which a program ends; then it is killed."""
LINES: Final = 500
"""Number of last output lines that are kept."""
LONGEST: Final = 4000
"""Longest part of a line that is kept (characters)."""
CHUNK: Final = 1 << 14
"""Bytes of output that are read every `processes.POLL_S`: a program that prints without end waits, not the window."""
SHOW_S: Final = 0.1
"""Least time between two states of the output: each is drawn."""
FRAME: Final = re.compile(r'  File "(?P<file>.+)", line (?P<line>\d+)')
STILL_S = 0.3
"""Time (s) after which a person at the same place stands still."""


class Failure(msgspec.Struct, frozen=True):
    """The last line of a program that an error of the SDK has ended, as `tracebacks` prints it."""

    reason: Reason
    message: str
    detail: Detail | None = None


class ProgramRun(Program):
    """One run of a program."""

    def __init__(self, action: RunProgram, settings: Settings, person: SimulatedPerson) -> None:
        """Store the arguments; the program gets robot, router and seat of the settings, and the sides as arguments."""
        super().__init__(action.row, action.sides or SIDES, BOTH)
        self._action, self._settings, self._person = action, settings, person
        self._written = collections.deque([""], maxlen=LINES)
        """output; the last line is not complete yet"""
        self._shown = ProgramProgress(action.file, running=True, sides=action.sides)
        self._shown_s, self._line = 0.0, 0

    def progress(self, now_s: float) -> ProgramProgress:
        """Return its newest output at a time (monotonic clock, s)."""
        if self._shown.running and (self.over.is_set() or now_s - self._shown_s > SHOW_S):
            self._shown_s, running, lines = now_s, not self.over.is_set(), tuple(self._written)
            if not running or lines != self._shown.output:
                action = self._action
                self._shown = ProgramProgress(action.file, running, lines, self._line, action.sides)
        return self._shown

    def run(self, report: Report) -> str:
        """Run the program until its end; raises the reason why it must end, or its failure."""
        settings, sides = self._settings, self._action.sides
        environment = {
            "BEATRIX_ROBOT": settings.robot,
            "BEATRIX_CONNECT": settings.connect,
            "BEATRIX_WHO": settings.who,
            "PYTHONUNBUFFERED": "1",
            tracebacks.VARIABLE: tracebacks.DATA,
        }
        with contextlib.ExitStack() as scene:
            if settings.account is not None:
                # A server of pages has one for each seat, and another one itself. Only its owner may read the folder.
                made = Path(scene.enter_context(tempfile.TemporaryDirectory(prefix="beatrix-")))
                (made / "account.toml").write_text(settings.account.text(), encoding="utf-8")
                environment["BEATRIX_ACCOUNT"] = str(made / "account.toml")
            self._prepare(scene)
            self.check()
            words = ("--program", str(self._action.file), *sides)
            try:
                child = processes.start_child(words, subprocess.PIPE, environment)
            except OSError as error:
                raise WindowError(Reason.BAD_VALUE, "result.program_failed", text=str(error)) from error
            with child, contextlib.ExitStack() as ends:
                ends.callback(processes.end_with_children, child, END_S)
                reader = threads.start(lambda: self._read(child), "output-of-program")
                report(accepted(self.row, self.side, "Started.", 0.0))
                while child.poll() is None and not self.ends:
                    time.sleep(processes.POLL_S)
                ends.close()
                reader.join(END_S)
        failure = self._failure(child.returncode) if child.returncode else None
        if failure is not None and not self.ends:
            raise failure
        self.check()
        return "Ended."

    def _prepare(self, scene: contextlib.ExitStack) -> None:
        """Let the simulated person do what a simulated robot can see or hear, until the end of the scene."""
        person, file = self._person, self._action.file
        if self._action.sides[:1] != ("sim",):
            return
        if file == TURN:
            person.speak(on=True)
            scene.callback(person.speak, on=False)
        elif file == FOLLOW:
            scene.enter_context(walking(self._settings, person))

    def _read(self, child: subprocess.Popen[bytes]) -> None:
        """Keep the output of a program, piece by piece."""
        text = codecs.getincrementaldecoder("utf-8")("replace")
        while child.stdout is not None and (piece := os.read(child.stdout.fileno(), CHUNK)):
            first, *more = text.decode(piece).replace("\r", "").split("\n")
            self._written[-1] = (self._written[-1] + first)[:LONGEST]
            self._written.extend(line[:LONGEST] for line in more)
            time.sleep(processes.POLL_S)

    def _failure(self, code: int) -> BeatrixError:
        """Return the error that has ended the program, and keep its line; that of the SDK is no output."""
        places = filter(None, map(FRAME.match, self._written))
        lines = [int(place["line"]) for place in places if place["file"] == str(self._action.file)]
        self._line = lines[-1] if lines else 0
        line = next((line for line in reversed(self._written) if line.strip()), "")
        try:
            found = msgspec.json.decode(line, type=Failure)
        except msgspec.DecodeError:
            key = "result.no_keyboard" if line.startswith("EOFError") else "result.program_failed"
            return WindowError(Reason.BAD_VALUE, key, text=line or processes.in_words(code))
        while self._written and not self._written.pop().startswith("Traceback"):
            pass  # the sentence of the error is shown in the language of the user
        return Refused(found.reason, found.message, found.detail)


@contextlib.contextmanager
def walking(settings: Settings, person: SimulatedPerson) -> Iterator[None]:
    """Let the simulated person sway during the block if it stands still, until the user drags it."""
    with contextlib.ExitStack() as ends:
        with contextlib.suppress(BeatrixError):  # the program follows without it, too
            # In a session of its own: that of the window closes before this program has ended.
            client = ends.enter_context(contextlib.closing(Client(settings)))
            robot = ends.enter_context(Robot(settings.robot, side="sim", client=client))
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
