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
from itertools import islice
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

OURS = "/dev/.."
"""Begins where our links lead to, in front of the device's own name: nobody else writes it so."""
LINE_END_S = wire.TEXT_LINE_TIMEOUT / 1000
"""A line that has begun is forgotten after this long without a byte."""
TURN_S = 0.02
"""Between two looks whether a program has opened the terminal, or reads again."""
KEPT = 8192
"""Lines kept for a program that does not read, besides what the system keeps; then the oldest goes."""
CHUNK = 4096
LEFT_BEHIND = 16 * CHUNK
"""The most that a system keeps of what a program has written; whatever is beyond is the next one's."""
LOCAL = 3
"""Where termios keeps the settings of which echo is one."""


class Listener(Protocol):
    """What a terminal tells; called on its own thread, in order."""

    def opened(self) -> None:
        """A program has opened it. It gets no line before `forget` has been called once for this."""

    def room(self) -> bool:
        """It takes a line now; while it does not, a program that is there waits."""

    def heard(self, line: bytes) -> None:
        """A whole line, without its end; never empty. Of a program that has gone also while there is no room."""

    def closed(self) -> None:
        """The program has closed it, or ended."""


class Terminal:
    """Lines from and to the program that has opened `path`; never waits for a program that does not read.

    Programs that follow each other faster than it looks (TURN_S, longer while nobody takes its lines) are
    taken for one.

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
        self._there = False
        self._greetings_due = 0
        """Openings that the listener has not heeded yet: what it writes is for a program that has gone."""
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
            if self._there and not self._greetings_due:
                self._waiting.append(line)
                self._flush()

    def forget(self) -> None:
        """What is written from now on is for the program that was told of last."""
        with self._lock:
            self._greetings_due -= 1

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
            events = poll.poll(0)
            if not hung_up(events) or events[0][1] & select.POLLIN:
                self._greet()
                listener.opened()
                self._serve(poll, listener)
                listener.closed()

    def _serve(self, poll: select.poll, listener: Listener) -> None:
        """Until the program has gone and all its lines are handed over.

        It looks for its end between any two lines: the sooner it is seen, the sooner the next one is told apart.
        """
        cutter = Cutter()
        lines: deque[bytes] = deque()
        gone = False
        while not self._closing.is_set() and (lines or not gone):
            if not gone:
                gone = self._listen(poll, cutter, lines)
            if lines and not (gone or listener.room()):
                self._closing.wait(TURN_S)
            elif lines:
                listener.heard(lines.popleft())

    def _listen(self, poll: select.poll, cutter: Cutter, lines: deque[bytes]) -> bool:
        """Read if no line waits; read all that is left, and return True, if the program has gone."""
        events = poll.poll(0 if lines else round(TURN_S * 1000))
        if hung_up(events):
            lines += cutter.cut(b"".join(islice(iter(self._read, b""), LEFT_BEHIND // CHUNK)))
            self._wipe()
            return True
        if not lines:
            lines += cutter.cut(self._read())
        with self._lock:
            self._flush()
        return False

    def _read(self) -> bytes:
        """What is there; nothing if the program has gone."""
        try:
            return os.read(self._master, CHUNK)
        except OSError:
            return b""

    def _greet(self) -> None:
        """A program has come. Of its settings only an echo is touched: the robot would hear its own answers."""
        with self._lock, contextlib.suppress(OSError, termios.error):
            self._there = True
            self._greetings_due += 1
            settings = termios.tcgetattr(self._master)
            if settings[LOCAL] & termios.ECHO:
                settings[LOCAL] &= ~termios.ECHO
                termios.tcsetattr(self._master, termios.TCSANOW, settings)

    def _wipe(self) -> None:
        """The program has gone: its settings and the answers it has not read are not for the next one.

        Linux keeps 4 kB for the program, which only setting it up empties from here, and four times as much on their
        way there; elsewhere it is one queue.
        """
        with self._lock, contextlib.suppress(OSError, termios.error):
            self._there = False
            self._clear()
            if sys.platform == "linux":
                termios.tcflush(self._master, termios.TCOFLUSH)
                tty.setraw(self._master, termios.TCSAFLUSH)
            else:
                termios.tcflush(self._master, termios.TCIFLUSH)
                tty.setraw(self._master, termios.TCSANOW)

    def close(self) -> None:
        """Hang up and take the link away."""
        self._closing.set()
        if self._thread is not None:
            self._thread.join(timeout=2.0)
        with contextlib.suppress(OSError):
            if str(self.path.readlink()) == OURS + self._device:
                self.path.unlink()
        with self._lock:
            self._there = False
            self._clear()
            os.close(self._master)
        self._claim.close()


def hung_up(events: list[tuple[int, int]]) -> bool:
    """No program has the terminal open."""
    return any(event & select.POLLHUP for _, event in events)


class Cutter:
    """Cuts what a program writes into lines."""

    def __init__(self) -> None:
        self._begun = b""
        self._quiet = 0

    def cut(self, data: bytes) -> list[bytes]:
        """Lines that end here, without their ends; called once every TURN_S if there is nothing."""
        self._quiet = 0 if data else self._quiet + 1
        *lines, rest = (self._begun + data).replace(b"\n", b"\r").split(b"\r")
        self._begun = b"" if self._quiet * TURN_S >= LINE_END_S else rest[: wire.TEXT_LINE_MAX + 1]
        return [line for line in lines if line]


def claim(path: Path) -> socket.socket:
    """Hold `path` against other nodes for as long as this process lives and the socket is open.

    Raises:
        Refused: BAD_VALUE: one holds it.
    """
    held = socket.socket(socket.AF_UNIX)
    where = str(path.parent.resolve() / path.name)
    try:
        if sys.platform == "linux":  # elsewhere there are no names that go with their process
            held.bind(b"\0beatrix-legacy-" + hashlib.sha256(os.fsencode(where)).hexdigest().encode())
    except OSError as error:
        held.close()
        raise Refused(
            Reason.BAD_VALUE,
            f"--legacy {path} belongs to another node that runs: choose another path for this robot.",
        ) from error
    return held


def link(path: Path, device: str) -> None:
    """Let `path`, which is claimed, lead to `device`; a link of ours that was left behind is replaced.

    Raises:
        Refused: BAD_VALUE: something else is there, or nothing may be.
    """
    try:
        if sys.platform == "linux" and path.is_symlink() and str(path.readlink()).startswith(OURS):
            path.unlink()
        path.symlink_to(OURS + device)
    except FileExistsError as error:
        raise Refused(
            Reason.BAD_VALUE,
            f"--legacy {path} is there already: choose another path, or remove it if nobody needs it.",
        ) from error
    except OSError as error:
        raise Refused(
            Reason.BAD_VALUE,
            f"--legacy {path}: {error.strerror}. Choose a path you may write, for example /tmp/beatrix; a link such as "
            "/dev/ttyACM9, which programs find by themselves, needs an administrator.",
        ) from error
