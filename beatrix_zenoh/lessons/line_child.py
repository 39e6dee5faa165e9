"""A child process that answers each line of JSON with one line of JSON, within a time limit."""

from __future__ import annotations

import contextlib
import json
import os
import queue
import signal
import subprocess
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

from beatrix_zenoh import processes, threads

Reply = dict[str, object]


def kill_group(process: subprocess.Popen[bytes]) -> None:
    """Kill a process that leads a group, and all that it has started."""
    if sys.platform == "win32":
        process.kill()
        return
    with contextlib.suppress(
        ProcessLookupError, PermissionError
    ):  # PermissionError: macOS, if all have ended
        os.killpg(process.pid, signal.SIGKILL)


class NoReply(Exception):
    """The child has not answered within the time limit; or it has ended, with the exit code `code`."""

    def __init__(self, code: int | None = None) -> None:
        super().__init__(f"exit code {code}")
        self.code = code


class LineChild:
    """A child process, started at once and ended by `close`, or with its parent: its standard input is a pipe."""

    def __init__(
        self,
        arguments: Sequence[str],
        environment: Mapping[str, str] | None = None,
        folder: Path | None = None,
    ) -> None:
        """Start Python with these arguments, additions to the environment, and working folder."""
        self._process = subprocess.Popen(
            [sys.executable, "-P", *arguments],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            cwd=folder,
            env=os.environ | dict(environment or {}),
            process_group=None if sys.platform == "win32" else 0,
            creationflags=processes.NEW_GROUP,
        )
        self._lines: queue.SimpleQueue[bytes | None] = queue.SimpleQueue()
        self._reader = threads.start(self._read, "lines-of-child")

    def _read(self) -> None:
        output = self._process.stdout
        assert output is not None
        for line in output:
            self._lines.put(line)
        self._lines.put(None)

    def ask(self, request: Mapping[str, object], timeout_s: float) -> Reply:
        """Return the answer to a request; raises NoReply after `timeout_s` (s), and if the child has ended."""
        assert self._process.stdin is not None
        try:
            self._process.stdin.write(json.dumps(request).encode() + b"\n")
            self._process.stdin.flush()
        except OSError as error:
            raise NoReply(self._process.wait()) from error
        return self.reply(timeout_s)

    def reply(self, timeout_s: float) -> Reply:
        """Return the next line; raises the errors of `ask`."""
        try:
            line = self._lines.get(timeout=timeout_s)
        except queue.Empty:
            raise NoReply from None
        if line is None:
            raise NoReply(self._process.wait())
        found: Reply = json.loads(line)
        return found

    def close(self) -> None:
        """Kill the child, which holds nothing that it would have to save."""
        kill_group(self._process)
        self._process.wait()
        self._reader.join()
        for pipe in (self._process.stdin, self._process.stdout):
            if pipe is not None:
                with contextlib.suppress(OSError):  # what was not yet written has no reader
                    pipe.close()
