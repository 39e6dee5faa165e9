"""A pupil's process under its guard (guard.py), which ends it and all that it has started."""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import sys
from collections.abc import Mapping
from typing import IO

from beatrix_zenoh import processes
from beatrix_zenoh.lessons.sandbox import Sandbox

SIGNALLED = 128
"""An exit code of the guard above this number is that of a signal."""
END_S = 5.0
"""Longest time (s) in which the guard ends; the program may have suspended it."""


class Guarded:
    """A process that runs Python in a sandbox; `requests` is the pipe to its standard input, None: it reads nothing."""

    def __init__(
        self,
        sandbox: Sandbox,
        words: list[str],
        environment: Mapping[str, str],
        *,
        requests: bool = False,
        stderr: int = subprocess.STDOUT,
    ) -> None:
        """Start it with these arguments and more variables; its output is the pipe `process.stdout`."""
        self.requests: IO[bytes] | None = None
        read = -1
        if requests and sys.platform != "win32":
            read, write = os.pipe()
            self.requests = os.fdopen(write, "wb")
        direct = requests and sys.platform == "win32"  # there a process inherits no other pipe
        self.process = subprocess.Popen(
            [sys.executable, *words] if direct else sandbox.guarded(words, read),
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=stderr,
            cwd=sandbox.working,
            env=sandbox.environment(environment),
            pass_fds=() if read < 0 else (read,),
            process_group=None if sys.platform == "win32" else 0,
            creationflags=processes.NEW_GROUP,
        )
        if read >= 0:
            os.close(read)
        if direct:
            self.requests = self.process.stdin

    def interrupt(self) -> None:
        """Interrupt the program as Ctrl-C does; not on Windows."""
        assert self.process.stdin is not None
        with contextlib.suppress(OSError):  # it has ended
            self.process.stdin.write(b"\n")
            self.process.stdin.flush()

    def end(self) -> None:
        """Kill the program and all that it has started."""
        for pipe in (self.requests, self.process.stdin):
            if pipe is not None:
                with contextlib.suppress(OSError):  # what was not yet written has no reader
                    pipe.close()
        with contextlib.suppress(subprocess.TimeoutExpired):
            self.process.wait(END_S)
        kill_group(self.process)  # if the program has killed or suspended its guard
        self.process.wait()


def kill_group(process: subprocess.Popen[bytes]) -> None:
    """Kill a process that leads a group, and the processes of the group."""
    if sys.platform == "win32":
        process.kill()
        return
    with contextlib.suppress(
        ProcessLookupError, PermissionError
    ):  # PermissionError: macOS, if all have ended
        os.killpg(process.pid, signal.SIGKILL)


def exit_code(process: subprocess.Popen[bytes]) -> int:
    """Wait for the end of a guard; return the exit code of its program, negative for a signal."""
    code = process.wait()
    return SIGNALLED - code if code > SIGNALLED else code
