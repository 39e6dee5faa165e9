"""Child processes that serve: started, waited for, watched, ended in order, never left behind."""

from __future__ import annotations

import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from types import FrameType
from typing import Self

from beatrix_zenoh._generated.messages import Reason
from beatrix_zenoh.cli import logs
from beatrix_zenoh.ending import SIGNALS
from beatrix_zenoh.errors import BeatrixError, NoAnswer, Refused

READY_S = 20.0
"""A busy computer that imports MuJoCo for the first time may need this long."""
END_S = 4.0
"""A node stops its robot first; then it is killed."""
TURN_S = 0.02
LAST_WORDS = 5
"""Lines of a child's output that are shown when it has failed."""
NEW_GROUP = getattr(subprocess, "CREATE_NEW_PROCESS_GROUP", 0)
"""Windows has a flag where other systems have `process_group`."""


class Child:
    """One `beatrix …` process whose output goes to a file.

    It has a process group of its own, so Ctrl-C reaches the parent alone, and the other end of its
    standard input, so it ends when the parent has gone, however that came about (see child.py).
    """

    def __init__(self, title: str, arguments: Sequence[str], log: Path) -> None:
        self.title, self.log = title, log
        self._told = 0
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
        """It has said that it serves."""
        return any(line.startswith("ready ") for line in self.lines())

    @property
    def code(self) -> int | None:
        """Exit code, None while it runs."""
        return self._process.poll()

    def lines(self) -> list[str]:
        """What it has written; nothing if somebody has cleared away the folder."""
        return self._written().decode("utf-8", "replace").splitlines()

    def news(self) -> list[str]:
        """The whole lines it has written since this was asked last."""
        written = self._written(self._told)
        whole = written[: written.rfind(b"\n") + 1]
        self._told += len(whole)
        return whole.decode("utf-8", "replace").splitlines()

    def _written(self, since: int = 0) -> bytes:
        try:
            with self.log.open("rb") as log:
                log.seek(since)
                return log.read()
        except FileNotFoundError:
            return b""

    def end(self) -> None:
        """Ask it to end; kill it if it does not."""
        self._process.terminate()
        try:
            self._process.wait(END_S)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
        if self._process.stdin is not None:
            self._process.stdin.close()


class Fleet:
    """Children that live as long as a `with` block; the last one started ends first.

    What they write goes to a folder that is deleted with them, unless one has failed and written more than is shown.
    """

    def __init__(self) -> None:
        logs.sweep()
        self.folder = logs.make()
        self._kept = False
        self.children: list[Child] = []

    def start(self, title: str, *arguments: str) -> Child:
        """Start `beatrix …`; wait for it with `wait_ready`."""
        child = Child(title, arguments, self.folder / f"{title}.log")
        self.children.append(child)
        return child

    def wait_ready(self, timeout_s: float = READY_S) -> None:
        """Return when all children serve.

        Raises:
            Refused: one has ended.
            NoAnswer: TIMED_OUT.
        """
        deadline = time.monotonic() + timeout_s
        while waiting := [child for child in self.children if not child.ready]:
            self.check()
            if time.monotonic() > deadline:
                child = waiting[0]
                raise NoAnswer(
                    Reason.TIMED_OUT,
                    f"The {child.title} did not become ready within {timeout_s:.0f} s. {self._words_of(child)}",
                )
            time.sleep(TURN_S)

    def check(self) -> None:
        """Raise Refused if a child has ended."""
        for child in self.children:
            if child.code is not None:
                raise Refused(
                    Reason.SHUTDOWN,
                    f"The {child.title} has ended (exit code {child.code}). {self._words_of(child)}",
                )

    def news(self) -> list[str]:
        """What the children have written since this was asked last, each line with its child's title."""
        return [f"{child.title}: {line}" for child in self.children for line in child.news()]

    def _words_of(self, child: Child) -> str:
        """What a child that failed wrote last, and where the rest is from now on, if there is more."""
        lines = child.lines()
        shown = "\n".join(f"  {line}" for line in lines[-LAST_WORDS:])
        if len(lines) <= LAST_WORDS:
            return f"It says:\n{shown}" if lines else "It has said nothing."
        self._kept = True
        return f"Its last words:\n{shown}\nAll it wrote is in {child.log}."

    def end(self) -> None:
        """End all, the last one started first."""
        while self.children:
            self.children.pop().end()
        if self._kept:
            logs.keep(self.folder)
        else:
            logs.remove(self.folder)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, _kind: object, error: BaseException | None, _traceback: object) -> None:
        with deaf():
            try:
                if isinstance(error, BeatrixError):
                    self.check()  # a child that has ended explains it better than who misses it
            finally:
                self.end()


@contextmanager
def heard() -> Iterator[None]:
    """In here every signal that asks to end raises KeyboardInterrupt, also in a background job."""

    def interrupt(_signal: int, _frame: FrameType | None) -> None:
        raise KeyboardInterrupt

    with _handled(interrupt):
        yield


@contextmanager
def deaf() -> Iterator[None]:
    """In here nobody can interrupt: ending takes bounded time, and half of it would leave orphans."""
    with _handled(signal.SIG_IGN):
        yield


@contextmanager
def _handled(handler: Callable[[int, FrameType | None], None] | signal.Handlers) -> Iterator[None]:
    # Who was started by nohup wants to outlive a window; Ctrl-C is for us also where a shell has made us deaf to it.
    numbers = [n for n in SIGNALS if n == signal.SIGINT or signal.getsignal(n) is not signal.SIG_IGN]
    before = [(number, signal.signal(number, handler)) for number in numbers]
    try:
        yield
    finally:
        for number, previous in before:
            signal.signal(number, previous)
