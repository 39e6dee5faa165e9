"""Subprocesses of a simulation: programs of this package that receive scenes and send bytes through pipes.

Subprocesses draw, because OpenGL drivers crash and hang, and because creating a context holds Python's global lock for
0.1 s, which would delay a STOP.
"""

from __future__ import annotations

import contextlib
import os
import pickle
import queue
import signal
import subprocess
import sys
from collections.abc import Iterator, Sequence
from typing import Final

import msgspec

from beatrix_zenoh import threads
from beatrix_zenoh.contract._generated.robot import RobotData
from sim_node.painter import SceneState

NICE: Final = 5
"""Added to the niceness of a drawing process (POSIX): on a busy computer physics has priority."""
READY: Final = b"ready"
"""What a process sends first, when it can do its work."""
OPENING_S: Final = 30.0
"""Longest time until then."""
ENDING_S: Final = 2.0
"""Longest wait for the end of a killed process; a process that hangs in a kernel driver does not end."""


def environment() -> dict[str, str]:
    """Return the environment for a subprocess, with the import path of this process."""
    found = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    found.pop("PYOPENGL_PLATFORM", None)
    return found


class PipedProcess:
    """A running program of this package. One thread asks and reads; any thread may call `close`."""

    def __init__(self, module: str, robot: RobotData, *words: str) -> None:
        """Start `python -m module ROBOT *words`, with the robot as JSON; `open` waits until it can do its work."""
        self._process = subprocess.Popen(
            [sys.executable, "-P", "-m", module, msgspec.json.encode(robot).decode(), *words],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            env=environment(),
        )
        assert self._process.stdin is not None
        self._in = self._process.stdin
        self._replies: queue.SimpleQueue[bytes] = queue.SimpleQueue()
        threads.start(self._read_output, "pipe")

    def _read_output(self) -> None:
        """Queue the replies, and an empty one at their end; only this thread waits for them without a time limit."""
        assert self._process.stdout is not None
        with self._process.stdout as out, contextlib.suppress(EOFError, pickle.UnpicklingError):
            while True:
                self._replies.put(pickle.load(out))  # noqa: S301 - of a program of this package
        self._replies.put(b"")

    def open(self) -> None:
        """Wait until the process is ready; raises OSError if it cannot do its work on this computer, or is closed."""
        try:
            self.read(OPENING_S)
        except OSError:
            self.close()
            raise

    def ask(self, views: Sequence[str], state: SceneState) -> None:
        """Send the scene, and the views to draw; raises OSError if the process has ended.

        Blocks while the process hangs, until `close`.
        """
        try:
            pickle.dump((views, state), self._in)
            self._in.flush()
        except ValueError as error:
            raise BrokenPipeError("the process was closed") from error

    def read(self, limit_s: float | None = None) -> bytes:
        """Return the next reply; raises OSError if the process ends, is closed, or takes longer than `limit_s`."""
        try:
            reply = self._replies.get(timeout=limit_s)
        except queue.Empty as error:
            raise TimeoutError("the process hangs") from error
        if not reply:
            self._replies.put(b"")  # the next call must find the end, too
            raise BrokenPipeError("the process has ended")
        return reply

    def close(self) -> None:
        """Kill the process, and end a waiting call of `read`; may be called twice."""
        self._process.kill()
        self._replies.put(b"")
        try:
            self._process.wait(ENDING_S)
        except subprocess.TimeoutExpired:
            return
        with contextlib.suppress(OSError):  # raised if the process has not read all data
            self._in.close()


def begin(words: Sequence[str]) -> RobotData:
    """Prepare this process, which a simulation has started and will end, and return the robot of its words."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the simulation handles Ctrl-C
    return msgspec.json.decode(words[0], type=RobotData)


def reply(data: bytes) -> None:
    """Send bytes to the simulation."""
    pickle.dump(data, sys.stdout.buffer)
    sys.stdout.buffer.flush()


def requests() -> Iterator[tuple[Sequence[str], SceneState]]:
    """Yield what the simulation asks, until it ends."""
    with contextlib.suppress(EOFError):
        yield pickle.load(sys.stdin.buffer)  # noqa: S301 - as below
        # Only when the first is done, because a client waits for the first picture.
        if sys.platform != "win32":
            with contextlib.suppress(OSError):
                os.nice(NICE)
        while True:
            yield pickle.load(sys.stdin.buffer)  # noqa: S301 - of the simulation
