"""A child process that answers each line of JSON with one line of JSON, within a time limit."""

from __future__ import annotations

import contextlib
import json
import queue
import subprocess
from collections.abc import Callable, Mapping
from typing import IO

from beatrix_zenoh import threads
from beatrix_zenoh.lessons.guarded import exit_code

Reply = dict[str, object]


class NoReply(Exception):
    """The child has not answered within the time limit; or it has ended, with the exit code `code`."""

    def __init__(self, code: int | None = None) -> None:
        super().__init__(f"exit code {code}")
        self.code = code


class LineChild:
    """A child process that runs, ended by `close`."""

    def __init__(
        self, process: subprocess.Popen[bytes], requests: IO[bytes] | None, end: Callable[[], None]
    ) -> None:
        """Talk to a process through a pipe to its standard input; `end` ends it."""
        assert requests is not None
        self._process, self._requests, self._end = process, requests, end
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
        try:
            self._requests.write(json.dumps(request).encode() + b"\n")
            self._requests.flush()
        except OSError as error:
            raise NoReply(exit_code(self._process)) from error
        return self.reply(timeout_s)

    def reply(self, timeout_s: float) -> Reply:
        """Return the next line; raises the errors of `ask`."""
        try:
            line = self._lines.get(timeout=timeout_s)
        except queue.Empty:
            raise NoReply from None
        if line is None:
            raise NoReply(exit_code(self._process))
        found: Reply = json.loads(line)
        return found

    def close(self) -> None:
        """End the child, which holds nothing that it would have to save."""
        self._end()
        self._reader.join()
        for pipe in (self._requests, self._process.stdout):
            if pipe is not None:
                with contextlib.suppress(OSError):  # what was not yet written has no reader
                    pipe.close()
