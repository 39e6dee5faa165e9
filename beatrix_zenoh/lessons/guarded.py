"""A pupil's process: the whole program under its guard (guard.py), or a child process that calls its functions."""

from __future__ import annotations

import collections
import contextlib
import json
import os
import queue
import re
import signal
import subprocess
import sys
import time
from collections.abc import Mapping
from pathlib import Path
from typing import IO

import msgspec

from beatrix_zenoh import threads
from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.codec import UNREADABLE
from beatrix_zenoh.lessons.function_child import FunctionReply
from beatrix_zenoh.lessons.phrases import ErrorData, Phrase, Unmet, phrase
from beatrix_zenoh.lessons.sandbox import GUARD, Sandbox
from beatrix_zenoh.process_groups import kill_group

SIGNALLED = 128
"""An exit code of the guard above this number is that of a signal."""
GUARD_S = 5.0
"""Longest time (s) in which the guard ends; the program may have suspended it."""
LINES = 200
"""Number of last output lines that are kept: a program may print without end."""
END_S = 2.0
"""Time (s) in which a program may end itself after Ctrl-C."""
FRAME = re.compile(r'^  File "(?P<file>.+)", line (?P<line>\d+)')
LONGEST_LINE = 4000
"""Longest part of a line (bytes) that is kept at once: a program may print for ever without an end of line."""
LONGEST_ERROR = 500
"""Longest text of an error that is shown (characters)."""
REFUSED = "Refused:"
"""Beginning of the last line of a traceback, if the robot has refused a request."""
PREFIX = re.compile(r"^[\w.]+\.(?=\w+(:|$))")
"""The module of an exception's name, as in `beatrix_zenoh.contract.errors.Refused`."""


def close(pipe: IO[bytes] | None) -> None:
    """Close a pipe; what was not yet written has no reader."""
    if pipe is not None:
        with contextlib.suppress(OSError):
            pipe.close()


def exit_code(process: subprocess.Popen[bytes]) -> int:
    """Wait for the end of a process; return its exit code, or that of the program of a guard; negative for a signal."""
    code = process.wait()
    return SIGNALLED - code if code > SIGNALLED else code


class NoReply(Exception):
    """The child has not answered within the time limit; or it has ended, with the exit code `code`."""

    def __init__(self, code: int | None = None) -> None:
        super().__init__(f"exit code {code}")
        self.code = code


class LineChild:
    """A process that answers each line of JSON with another one; it ends with its standard input."""

    def __init__(self, sandbox: Sandbox, words: list[str], environment: Mapping[str, str]) -> None:
        """Start it with these arguments and more variables."""
        self._process = sandbox.start(words, environment, stderr=subprocess.DEVNULL)
        self._lines: queue.SimpleQueue[bytes | None] = queue.SimpleQueue()
        self._reader = threads.start(self._read, "lines-of-child")

    def _read(self) -> None:
        for line in self._process.stdout or ():
            self._lines.put(line)
        self._lines.put(None)

    def ask(self, request: Mapping[str, object], timeout_s: float) -> FunctionReply:
        """Return the answer to a request; raises NoReply after `timeout_s` (s), and if the child has ended."""
        requests = self._process.stdin
        assert requests is not None
        try:
            requests.write(json.dumps(request).encode() + b"\n")
            requests.flush()
        except OSError as error:
            raise NoReply(exit_code(self._process)) from error
        return self.reply(timeout_s)

    def reply(self, timeout_s: float) -> FunctionReply:
        """Return the next line; raises the errors of `ask`."""
        try:
            line = self._lines.get(timeout=timeout_s)
        except queue.Empty:
            raise NoReply from None
        if line is None:
            raise NoReply(exit_code(self._process))
        return msgspec.convert(
            json.loads(line), FunctionReply
        )  # JSON of Python has nan, and integers of any size

    def close(self) -> None:
        """Kill the child, which holds nothing that it would have to save."""
        kill_group(self._process)
        self._process.wait()
        self._reader.join()
        close(self._process.stdin)
        close(self._process.stdout)


class Run:
    """A program that runs under its guard; its output is read all the time, so that it never waits for a reader."""

    def __init__(self, sandbox: Sandbox, environment: Mapping[str, str]) -> None:
        """Start the program of a sandbox, with more variables."""
        self._sandbox = sandbox
        self._output: collections.deque[str] = collections.deque(maxlen=LINES)
        paths = (str(sandbox.program.path.parent), os.environ.get("PYTHONPATH"))
        # The program of a notebook is in another folder.
        more = {"PYTHONPATH": os.pathsep.join(filter(None, paths))}
        self._process = sandbox.start([str(sandbox.file)], more | dict(environment), GUARD)
        self.cores = 0.0
        """Part of a core that the program has used, known after `close`; 0 on Windows, which does not tell."""
        self._reader = threads.start(self._read, "output-of-program")
        self.began_ns = time.monotonic_ns()

    def _read(self) -> None:
        output = self._process.stdout
        assert output is not None
        for line in iter(lambda: output.readline(LONGEST_LINE), b""):
            self._output.append(line.decode("utf-8", "replace").rstrip("\r\n"))

    @property
    def output(self) -> list[str]:
        """The last lines that the program has printed."""
        return list(self._output)

    @property
    def running(self) -> bool:
        """Whether the program has not ended yet."""
        return self._process.poll() is None

    @property
    def seconds(self) -> float:
        """Time since the start (s)."""
        return (time.monotonic_ns() - self.began_ns) / 1e9

    def check(self) -> None:
        """Raise Unmet (`runs`, `uncaught`, `other_robot` or `keyboard`) if the program has ended with an error."""
        if self._process.poll() == 0:
            return
        self._reader.join(END_S)
        lines = [line for line in self._output if line.strip()]
        if lines and lines[-1].startswith("EOFError"):
            raise Unmet("keyboard", where=self._where())
        error = self._error(lines)
        figure = "uncaught" if str(error).startswith(REFUSED) else "runs"
        if isinstance(error, ErrorData) and error.reason in (Reason.NO_ANSWER, Reason.NO_SUCH_ROBOT):
            absent = error.detail is not None and error.detail.field not in ("", *error.detail.known)
            figure = "other_robot" if absent else figure
        raise Unmet(figure, error=error, where=self._where())

    def _error(self, lines: list[str]) -> ErrorData | Phrase:
        """Return the error of the traceback, or how the program has ended without one."""
        code = exit_code(self._process)
        if code < 0:
            return phrase("signal", name=signal.Signals(-code).name)
        if not lines:
            return ErrorData(f"exit code {code}")
        with contextlib.suppress(*UNREADABLE):  # an error of BEATRIX, if Attempt has asked for data
            found = msgspec.json.decode(lines[-1], type=ErrorData)
            if found.kind:
                return found
        return ErrorData(PREFIX.sub("", lines[-1])[:LONGEST_ERROR])

    def _where(self) -> Phrase | str:
        """Return the place in the pupil's program that the last traceback names."""
        frames = [match for line in self._output if (match := FRAME.match(line))]
        own = [int(match["line"]) for match in frames if Path(match["file"]) == self._sandbox.file]
        return self._sandbox.program.where(own[-1] if own else None)

    def close(self) -> None:
        """End the program, first as Ctrl-C does, so that it can bring its robot to rest."""
        guard = self._process.stdin
        if self.running and guard is not None and sys.platform != "win32":
            with contextlib.suppress(OSError, subprocess.TimeoutExpired):  # it has ended, or does not end
                guard.write(b"\n")
                guard.flush()
                self._process.wait(END_S)
        close(guard)
        with contextlib.suppress(subprocess.TimeoutExpired):
            self._process.wait(GUARD_S)
        kill_group(self._process)  # if the program has killed or suspended its guard
        self._process.wait()
        if not self.cores:
            self.cores = self._sandbox.used_s() / self.seconds
        self._reader.join(END_S)
        if not self._reader.is_alive():  # else closing would wait for it
            close(self._process.stdout)
