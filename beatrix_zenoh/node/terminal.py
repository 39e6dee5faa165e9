"""A pseudo-terminal that old programs open as if it were the board's serial port."""

from __future__ import annotations

import contextlib
import hashlib
import os
import select
import socket
import sys
import threading
from collections import deque
from pathlib import Path
from typing import Protocol

from beatrix_zenoh import threads
from beatrix_zenoh._generated import serial as wire
from beatrix_zenoh._generated.messages import Reason
from beatrix_zenoh.errors import Refused

try:
    import termios
    import tty
except ImportError:  # Windows has no pseudo-terminals
    POSSIBLE = False
else:
    POSSIBLE = True

LINE_END_S = wire.TEXT_LINE_TIMEOUT / 1000
"""A line that has begun is forgotten after this long without a byte."""
TURN_S = 0.02
"""Between two looks whether a program has opened the terminal, or reads again."""
KEPT = 2048
"""Lines kept for a program that does not read, besides what the system keeps; then the oldest goes."""
CHUNK = 4096


class Listener(Protocol):
    """What a terminal tells; called on its own thread, in order."""

    def opened(self) -> None:
        """A program has opened it."""

    def heard(self, line: bytes) -> None:
        """A whole line, without its end; never empty."""

    def closed(self) -> None:
        """The program has closed it, or ended."""


class Terminal:
    """Lines from and to the program that has opened `path`; never waits for a program that does not read.

    A program that opens it within milliseconds of another's end, while lines of that one still wait to be
    read, is taken for the same.

    Raises:
        Refused: BAD_VALUE, if there can be no terminal at `path`, and what to choose instead.
    """

    def __init__(self, path: Path) -> None:
        if not POSSIBLE:
            raise Refused(
                Reason.BAD_VALUE,
                "--legacy needs a pseudo-terminal, which Windows does not have: run this node on Linux or macOS.",
            )
        self.path = path
        self._claim = claim(path)
        self._master, slave = os.openpty()
        self._device = os.ttyname(slave)
        tty.setraw(slave)
        os.close(slave)
        os.set_blocking(self._master, False)
        try:
            link(path, self._device)
        except Refused:
            os.close(self._master)
            self._claim.close()
            raise
        self._lock = threading.Lock()
        self._begun = b""
        """What is left of a line that is half written: it must not be lost, or the next would be cut."""
        self._waiting: deque[bytes] = deque(maxlen=KEPT)
        self._closing = threading.Event()
        self._thread: threading.Thread | None = None

    def start(self, listener: Listener) -> None:
        """Begin to listen."""
        self._thread = threads.start(lambda: self._run(listener), "terminal")

    def write(self, line: bytes) -> None:
        """Give the program a line, with its end; what it does not read in time is lost, the oldest first."""
        with self._lock:
            self._waiting.append(line)
            self._flush()

    def _flush(self) -> None:
        while self._begun or self._waiting:
            line = self._begun or self._waiting.popleft()
            try:
                self._begun = line[os.write(self._master, line) :]
            except BlockingIOError:
                self._begun = line
            except OSError:  # nobody has it open
                self._clear()
            if self._begun:
                return

    def _clear(self) -> None:
        self._begun = b""
        self._waiting.clear()

    # -- the terminal's own thread --------------------------------------------------------------

    def _run(self, listener: Listener) -> None:
        poll = select.poll()
        poll.register(self._master, select.POLLIN)
        while not self._closing.wait(TURN_S):
            if self._is_open(poll.poll(0)):
                listener.opened()
                self._serve(poll, listener)
                listener.closed()

    @staticmethod
    def _is_open(events: list[tuple[int, int]]) -> bool:
        """Some program has it open, or has left something to read."""
        return not any(event & select.POLLHUP and not event & select.POLLIN for _, event in events)

    def _serve(self, poll: select.poll, listener: Listener) -> None:
        """Until the program has gone and all it wrote is read, or the next one has come."""
        begun = b""
        quiet_s, hung_up = 0.0, False
        while not self._closing.is_set():
            events = poll.poll(round(TURN_S * 1000))
            hangs_up = any(event & select.POLLHUP for _, event in events)
            if not self._is_open(events) or (hung_up and not hangs_up):
                return
            hung_up = hangs_up
            with self._lock:
                self._flush()
            data = self._read() if events else b""
            if data is None:
                return
            quiet_s = 0.0 if data else quiet_s + TURN_S
            *lines, rest = (begun + data).replace(b"\n", b"\r").split(b"\r")
            begun = b"" if quiet_s >= LINE_END_S else rest[: wire.TEXT_LINE_MAX + 1]
            for line in filter(None, lines):
                listener.heard(line)

    def _read(self) -> bytes | None:
        """What is there; None if the program has gone."""
        try:
            return os.read(self._master, CHUNK)
        except BlockingIOError:
            return b""
        except OSError:
            return None

    def forget(self) -> None:
        """What was written and not read is not for the program that comes next."""
        with self._lock, contextlib.suppress(OSError):
            self._clear()
            slave = os.open(self._device, os.O_RDWR | os.O_NOCTTY)
            try:
                termios.tcflush(slave, termios.TCIFLUSH)
            finally:
                os.close(slave)

    def close(self) -> None:
        """Hang up and take the link away."""
        self._closing.set()
        if self._thread is not None:
            self._thread.join(timeout=2.0)
        with contextlib.suppress(OSError):
            if str(self.path.readlink()) == self._device:
                self.path.unlink()
        os.close(self._master)
        self._claim.close()


def claim(path: Path) -> socket.socket:
    """Hold `path` against other nodes for as long as this process lives and the socket is open.

    Raises:
        Refused: BAD_VALUE: one holds it.
    """
    held = socket.socket(socket.AF_UNIX)
    where = str(path.parent.resolve() / path.name)
    try:
        if sys.platform == "linux":  # elsewhere there are no names that go with their process
            held.bind(b"\0beatrix-legacy-" + hashlib.sha256(where.encode()).hexdigest().encode())
    except OSError as error:
        held.close()
        raise Refused(
            Reason.BAD_VALUE,
            f"--legacy {path} belongs to another node that runs: choose another path for this robot.",
        ) from error
    return held


def link(path: Path, device: str) -> None:
    """Let `path` lead to `device`; a link of ours that was left behind is replaced.

    Raises:
        Refused: BAD_VALUE: something else is there, or nothing may be.
    """
    try:
        if path.is_symlink() and str(path.readlink()).startswith("/dev/pts/"):
            path.unlink()
        path.symlink_to(device)
    except FileExistsError as error:
        raise Refused(
            Reason.BAD_VALUE, f"--legacy {path} is there already and no link of ours: choose another path."
        ) from error
    except OSError as error:
        raise Refused(
            Reason.BAD_VALUE,
            f"--legacy {path}: {error.strerror}. Choose a path you may write, for example /tmp/beatrix; a link such as "
            "/dev/ttyACM9, which programs find by themselves, needs an administrator.",
        ) from error
