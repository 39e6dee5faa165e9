"""`beatrix lesson watch`: check a program at each save, on a stage that stays up."""

from __future__ import annotations

import _thread
import os
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, closing, contextmanager
from pathlib import Path
from types import FrameType
from typing import Final, Self

from beatrix_zenoh import threads
from beatrix_zenoh.contract.errors import BeatrixError
from beatrix_zenoh.files import Stamp, stamp
from beatrix_zenoh.lessons.checking import Result, Verdict
from beatrix_zenoh.lessons.phrases import Tell
from beatrix_zenoh.lessons.stage import PUPIL, Stage, open_stage
from beatrix_zenoh.processes import end_on_interrupt
from beatrix_zenoh.shutdown import handled

POLL_S: Final = 0.2
"""Period in which the files are looked at; a file that was not written for as long is complete."""
WAIT_S: Final = 0.5
"""Longest single wait of the main thread (s): on Windows Ctrl-C is handled between two waits."""
GRACE_S: Final = 0.7
"""Time (s) after Ctrl-C after which this process ends at once; its children end with it."""
LEASE_S: Final = 5.0
"""Longest wait (s) for a robot that something of the last program still holds."""
Place = tuple[float, float, float]
"""x, y, z (m) as of `Robot.target`"""
Signature = tuple[tuple[Path, Stamp | None], ...]
Check = Callable[[Path, "KeptStage"], Verdict]
"""Checks a program on the kept stage, shows the verdict and returns it."""


class Saves:
    """Notices when one of some files is saved, and interrupts the check of the main thread. Used in a `with` block."""

    def __init__(self, found: Callable[[], list[Path]]) -> None:
        """Prepare to watch the files that `found` returns, the newest first."""
        self._found, self._lock, self._over = found, threading.Lock(), threading.Event()
        self._complete = self._signature()
        """of the program that is checked now, or will be next"""
        self._saved = threading.Event()
        self._saved.set()  # the first check needs no save
        self._checks = False
        self.interrupted = False
        """whether a save, and not Ctrl-C, has interrupted the newest check"""
        self._ended_s = 0.0

    def __enter__(self) -> Self:
        self._thread = threads.start(self._watch, "saves")
        return self

    def __exit__(self, *_error: object) -> None:
        self._over.set()
        self._thread.join()

    def wait(self) -> Path:
        """Return the program to check now: at first at once, later when it was saved."""
        while True:
            if self._saved.wait(WAIT_S):
                self._saved.clear()
                if paths := self._found():
                    return paths[0]

    @contextmanager
    def interrupting(self) -> Iterator[None]:
        """Raise KeyboardInterrupt in this block if a file is saved."""
        with self._lock:
            self.interrupted, self._checks = False, not self._saved.is_set()
        yield
        with self._lock:
            self._checks = False

    def interrupt(self, _signal: int, _frame: FrameType | None) -> None:
        """Handle a signal: Ctrl-C, or that of a save."""
        if not self.interrupted:
            self._ended_s = time.monotonic()
        raise KeyboardInterrupt

    def _watch(self) -> None:
        before = self._complete
        while not self._over.wait(POLL_S):
            if self._ended_s and time.monotonic() - self._ended_s > GRACE_S:
                sys.stdout.flush()
                os._exit(0)
            now = self._signature()
            if now == before != self._complete and now:
                self._complete = now
                self._report()
            before = now

    def _report(self) -> None:
        with self._lock:
            self._saved.set()
            if not self._checks:
                return
            self._checks, self.interrupted = False, True
            if hasattr(signal, "pthread_kill"):  # it also ends a wait of the main thread
                signal.pthread_kill(threading.main_thread().ident or 0, signal.SIGINT)
            else:
                _thread.interrupt_main()

    def _signature(self) -> Signature:
        return tuple((path, stamp(path)) for path in self._found())


class KeptStage:
    """The newest stage of all checks in a `with` block; call it like `open_stage`.

    A stage that cannot be tidied, for example because the program has frozen the robot, is replaced by a new one.
    """

    def __init__(self) -> None:
        self._open = ExitStack()
        self._stage: Stage | None = None
        self._key: tuple[object, ...] = ()
        self._path = "still"
        self._places: dict[str, Place] = {}
        """where the person of each robot was at the beginning"""
        self._used = False

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_error: object) -> None:
        self.close()

    @contextmanager
    def __call__(
        self, names: Sequence[str], path: str, robot_file: Path | None, tell: Tell
    ) -> Iterator[Stage]:
        """Yield a stage whose robots are ready and at home."""
        key = (tuple(names), path, robot_file)
        if key != self._key:
            self.close()
        self.tidy()
        if self._stage is None:
            self._stage = self._open.enter_context(open_stage(names, path, robot_file, tell))
            self._key, self._path = key, path
            people = {name: watch.robot.target() for name, watch in self._stage.watches.items()}
            self._places = {name: (person.x, person.y, person.z) for name, person in people.items()}
        self._used = True
        yield self._stage

    def close(self) -> None:
        """End the stage; the next call opens another one."""
        self._stage, self._key, self._used = None, (), False
        self._open.close()

    def tidy(self) -> None:
        """Undo what a program has left behind, or end the stage if that is not possible."""
        stage = self._stage
        if stage is None or not self._used:
            return
        try:
            tidied = all(tidy(stage, name, place, self._path) for name, place in self._places.items())
        except BeatrixError:
            tidied = False
        if tidied:
            self._used = False
        else:
            self.close()


def tidy(stage: Stage, name: str, place: Place, path: str = "still") -> bool:
    """Bring a robot home, and the person back to their place or path; return whether the robot is as at the beginning.

    It is asked as the pupil: what hinders the pupil now, such as a lease, a freeze or a pause, would hinder the program.
    Raises BeatrixError if the robot refuses.
    """
    robot = stage.robot(name, PUPIL)
    with closing(robot.client), robot.lease(wait_s=LEASE_S):
        robot.make_ready()
        robot.home()
        if path == "still":
            robot.move_target(*place)
        else:
            robot.walk_target(path)
        robot.play_sound("silence")
        return robot.status().speed_limit == 0


def watch(found: Callable[[], list[Path]], check: Check) -> bool:
    """Check the newest program at once and at each save, until it passes or Ctrl-C; return whether it has passed."""
    with Saves(found) as saves, handled(saves.interrupt), end_on_interrupt(), KeptStage() as stage:
        while True:
            path = saves.wait()
            try:
                with saves.interrupting():
                    verdict = check(path, stage)
            except KeyboardInterrupt:
                if not saves.interrupted:
                    raise
                continue
            if verdict.result is Result.PASSED:
                return True
            if verdict.result is Result.NOT_MEASURABLE:
                stage.close()
            stage.tidy()
    return False
