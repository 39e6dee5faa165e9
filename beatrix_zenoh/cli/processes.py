"""A supervisor of child processes: it starts, watches and ends them."""

from __future__ import annotations

import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from types import FrameType
from typing import Self

from beatrix_zenoh._generated.messages import Reason
from beatrix_zenoh.errors import BeatrixError, NoAnswer, Refused
from beatrix_zenoh.shutdown import SIGNALS

READY_S = 20.0
"""Time to start (s); a busy computer that imports MuJoCo for the first time may need all of it."""
END_S = 4.0
"""Time to end (s), in which a node also stops its robot; after this time the child is killed."""
POLL_S = 0.02
LAST_LINES = 5
"""Number of output lines of a failed child that are shown."""
NEW_GROUP = getattr(subprocess, "CREATE_NEW_PROCESS_GROUP", 0)
"""Flag of Windows that corresponds to `process_group` on other systems."""


class Child:
    """A `beatrix …` process whose output goes to a file.

    It has its own process group, so that Ctrl-C reaches only the parent. Its standard input is a pipe from the parent,
    so that it ends with the parent even if the parent is killed (see child.py).
    """

    def __init__(self, title: str, arguments: Sequence[str], log: Path, *, may_end: bool = False) -> None:
        self.title, self.log, self.may_end = title, log, may_end
        self._reported = 0
        with log.open("wb") as output:
            self._process = subprocess.Popen(
                [sys.executable, "-m", "beatrix_zenoh.cli.child", *arguments],
                stdin=subprocess.PIPE,
                stdout=output,
                stderr=subprocess.STDOUT,
                process_group=None if sys.platform == "win32" else 0,
                creationflags=NEW_GROUP,
            )

    @property
    def ready(self) -> bool:
        """Whether the process has printed `ready`."""
        return any(line.startswith("ready ") for line in self.lines())

    @property
    def code(self) -> int | None:
        """Exit code; None while it runs."""
        return self._process.poll()

    def lines(self) -> list[str]:
        """Return the lines of the process's output; empty if the log file has been deleted."""
        return self._written().decode("utf-8", "replace").splitlines()

    def new_lines(self) -> list[str]:
        """Return the complete lines that the process has written since the last call."""
        written = self._written(self._reported)
        complete = written[: written.rfind(b"\n") + 1]
        self._reported += len(complete)
        return complete.decode("utf-8", "replace").splitlines()

    def _written(self, since: int = 0) -> bytes:
        try:
            with self.log.open("rb") as log:
                log.seek(since)
                return log.read()
        except FileNotFoundError:
            return b""

    def end(self, grace_s: float = END_S) -> None:
        """Send SIGTERM to the process and wait; kill the process after `grace_s` (s)."""
        self._process.terminate()
        try:
            self._process.wait(grace_s)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
        if self._process.stdin is not None:
            self._process.stdin.close()


class Supervisor:
    """Child processes that run during a `with` block; the last one started ends first.

    Their output goes to a temporary folder. The folder is deleted at the end, unless a child has failed and the error
    message does not show all of its output.
    """

    def __init__(self) -> None:
        self.folder = Path(tempfile.mkdtemp(prefix="beatrix-"))
        self._kept = False
        self.children: list[Child] = []

    def start(self, title: str, *arguments: str, may_end: bool = False) -> Child:
        """Start `beatrix …`; wait for it with `wait_ready`. With `may_end` the child may end after it was ready."""
        child = Child(title, arguments, self.folder / f"{title}.log", may_end=may_end)
        self.children.append(child)
        return child

    def wait_ready(self, timeout_s: float = READY_S) -> None:
        """Wait until all children are ready.

        Raises:
            Refused: a child has ended.
            NoAnswer: TIMED_OUT.
        """
        deadline = time.monotonic() + timeout_s
        while waiting := [child for child in self.children if not child.ready]:
            self.check()
            if time.monotonic() > deadline:
                child = waiting[0]
                raise NoAnswer(
                    Reason.TIMED_OUT,
                    f"The {child.title} did not become ready within {timeout_s:.0f} s. {self.output_of(child)}",
                )
            time.sleep(POLL_S)

    def finish(self, child: Child) -> None:
        """End one child."""
        self.children.remove(child)
        child.end()

    def check(self) -> None:
        """Raise Refused if a child that must run has ended."""
        for child in self.children:
            if child.code is not None and not (child.may_end and child.ready):
                raise Refused(
                    Reason.SHUTDOWN,
                    f"The {child.title} has ended (exit code {child.code}). {self.output_of(child)}",
                )

    def remove_ended(self) -> list[Child]:
        """Remove the children that may end and have ended, and return them."""
        ended = [child for child in self.children if child.may_end and child.code is not None]
        for child in ended:
            self.finish(child)
        return ended

    def new_lines(self) -> list[str]:
        """Return the lines that the children have written since the last call, each with the title of its child."""
        return [f"{child.title}: {line}" for child in self.children for line in child.new_lines()]

    def output_of(self, child: Child) -> str:
        """Return the last lines of the output of a child, and the path of its log if there are more."""
        lines = child.lines()
        shown = "\n".join(f"  {line}" for line in lines[-LAST_LINES:])
        if len(lines) <= LAST_LINES:
            return f"Its output:\n{shown}" if lines else "It printed nothing."
        self._kept = True
        return f"Its last lines:\n{shown}\nIts complete output is in {child.log}."

    def end(self) -> None:
        """End all children, the last one started first."""
        while self.children:
            self.children.pop().end()
        if not self._kept:
            shutil.rmtree(self.folder, ignore_errors=True)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, _kind: object, error: BaseException | None, _traceback: object) -> None:
        with signals_ignored():
            try:
                if isinstance(error, BeatrixError):
                    self.check()  # if a child has ended, that is the cause of the error
            finally:
                self.end()


@contextmanager
def signals_interrupt() -> Iterator[None]:
    """Raise KeyboardInterrupt in this block for every signal that requests a shutdown, also in a background job."""

    def interrupt(_signal: int, _frame: FrameType | None) -> None:
        raise KeyboardInterrupt

    with _handled(interrupt):
        yield


@contextmanager
def signals_ignored() -> Iterator[None]:
    """Ignore shutdown signals in this block, in which all children are ended within a bounded time."""
    with _handled(signal.SIG_IGN):
        yield


@contextmanager
def _handled(handler: Callable[[int, FrameType | None], None] | signal.Handlers) -> Iterator[None]:
    # SIGHUP stays ignored under nohup. SIGINT is handled even where a shell ignores it for background jobs.
    numbers = [n for n in SIGNALS if n == signal.SIGINT or signal.getsignal(n) is not signal.SIG_IGN]
    before = [(number, signal.signal(number, handler)) for number in numbers]
    try:
        yield
    finally:
        for number, previous in before:
            signal.signal(number, previous)
