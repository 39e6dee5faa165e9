"""Subprocesses of a simulation: programs of this package that communicate through pipes.

Subprocesses draw, because OpenGL drivers crash and hang, and because creating a context holds Python's global lock for
0.1 s, which would delay a STOP.
"""

from __future__ import annotations

import contextlib
import os
import queue
import subprocess
import sys
import time
from typing import Final

import msgspec

from beatrix_zenoh import threads
from beatrix_zenoh.contract._generated.robot import RobotData

NICE: Final = 5
"""Added to the niceness of a drawing process (POSIX): on a busy computer physics has priority."""
READY: Final = b"ready\n"
"""What a process writes first, when it can do its work."""
OPENING_S: Final = 30.0
"""Longest time until then."""
ENDING_S: Final = 2.0
"""Longest wait for the end of a killed process; a process that hangs in a kernel driver does not end."""
_CHUNK: Final = 65536


def environment() -> dict[str, str]:
    """Return the environment for a subprocess, with the import path of this process."""
    found = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    found.pop("PYOPENGL_PLATFORM", None)
    return found


class PipedProcess:
    """A running program of this package. One thread writes and reads; any thread may call `close`."""

    def __init__(self, module: str, robot: RobotData, *words: str) -> None:
        """Start `python -m module ROBOT *words`, with the robot as JSON; `ready` waits until it can do its work."""
        self._process = subprocess.Popen(
            [sys.executable, "-P", "-m", module, msgspec.json.encode(robot).decode(), *words],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            env=environment(),
        )
        assert self._process.stdin is not None
        self._in = self._process.stdin
        self._chunks: queue.SimpleQueue[bytes] = queue.SimpleQueue()
        self._received = b""
        threads.start(self._read_output, "pipe")

    def _read_output(self) -> None:
        """Queue the output, and an empty chunk at its end; only this thread waits for output without a time limit."""
        assert self._process.stdout is not None
        with self._process.stdout as out:
            while chunk := os.read(out.fileno(), _CHUNK):
                self._chunks.put(chunk)
        self._chunks.put(b"")

    def ready(self) -> bool:
        """Wait until the process has written READY; return False if it ends before, or takes too long."""
        try:
            return self.read(len(READY), OPENING_S) == READY
        except OSError:
            return False

    def write(self, data: bytes) -> None:
        """Write to the process; raises OSError if it has ended. Blocks while the process hangs, until `close`."""
        try:
            self._in.write(data)
            self._in.flush()
        except ValueError as error:
            raise BrokenPipeError("the process was closed") from error

    def read(self, count: int, limit_s: float) -> bytes:
        """Read `count` bytes from the process; raises OSError if it ends, is closed, or takes longer than `limit_s`."""
        deadline_s = time.monotonic() + limit_s
        while len(self._received) < count:
            self._receive(deadline_s)
        data, self._received = self._received[:count], self._received[count:]
        return data

    def _receive(self, deadline_s: float) -> None:
        try:
            chunk = self._chunks.get(timeout=max(0.0, deadline_s - time.monotonic()))
        except queue.Empty as error:
            raise TimeoutError("the process hangs") from error
        if not chunk:
            self._chunks.put(b"")  # the next call must find the end, too
            raise BrokenPipeError("the process has ended")
        self._received += chunk

    def close(self) -> None:
        """Kill the process, and end a waiting call of `read`; may be called twice."""
        self._process.kill()
        self._chunks.put(b"")
        try:
            self._process.wait(ENDING_S)
        except subprocess.TimeoutExpired:
            return
        with contextlib.suppress(OSError):  # raised if the process has not read all data
            self._in.close()
