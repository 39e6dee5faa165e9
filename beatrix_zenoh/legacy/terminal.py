"""A pseudo-terminal that programs of 2023 open as if it were the board's serial port."""

from __future__ import annotations

import contextlib
import grp
import os
import select
import sys
import termios
import threading
import tty
from itertools import islice
from pathlib import Path
from typing import Final

from beatrix_zenoh import threads
from beatrix_zenoh.contract.errors import Refused, bad_value
from beatrix_zenoh.legacy.lines import LineSplitter, TerminalListener

assert sys.platform != "win32"  # there `beatrix_zenoh.legacy` has another class of this name


TURN_S = 0.02
"""Period of the checks whether a program has opened the terminal, or reads again (s)."""
CHUNK = 512
"""Largest number of bytes that are read in one period: 25 kB/s, as fast as the board's serial line."""
UNREAD_MAX = 1 << 16
"""Largest number of bytes that the system keeps from a program, and that the node keeps of answers that the program has
not read; further answers are dropped as whole lines."""
LOCAL = 3
"""Index of the local modes, which include echo, in the settings of termios."""


class Terminal:
    """Reads lines of the program that has opened `path` and writes lines to it, without waiting for the program.

    Programs that follow each other within TURN_S count as one program.

    Raises:
        Refused: BAD_VALUE: there can be no terminal at `path`; the message says what to choose instead.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        remove_leftover(path)
        self._master, slave = os.openpty()
        self._device = os.ttyname(slave)
        tty.setraw(slave)
        share(self._device)
        os.close(slave)
        os.set_blocking(self._master, False)
        try:
            link(path, self._device)
        except Refused:
            os.close(self._master)
            raise
        self._lock = threading.Lock()
        self._open = False
        self._pending_openings = 0
        """Calls of `opened` minus calls of `begin_answers`; above 0, answers belong to the previous program."""
        self._unread = b""
        """Answers that the system does not take yet."""
        self._closing = threading.Event()
        self._thread: threading.Thread | None = None

    def start(self, listener: TerminalListener) -> None:
        """Begin to receive lines."""
        self._thread = threads.start(lambda: self._run(listener), "terminal")

    def write(self, lines: bytes) -> None:
        """Write whole lines to the program; drop them while it leaves UNREAD_MAX bytes unread."""
        with self._lock:
            if self._open and not self._pending_openings and len(self._unread) < UNREAD_MAX:
                self._unread += lines
                self._flush()

    def begin_answers(self) -> None:
        """Begin to pass on answers to the program that opened the terminal; call this once for each `opened`."""
        with self._lock:
            self._pending_openings -= 1

    def _flush(self) -> None:
        try:
            self._unread = self._unread[os.write(self._master, self._unread) :]
        except BlockingIOError:
            return
        except OSError:  # no program has the terminal open
            self._unread = b""

    # -- the terminal's own thread --------------------------------------------------------------

    def _run(self, listener: TerminalListener) -> None:
        poll = select.poll()
        poll.register(self._master, select.POLLIN)
        while not self._closing.wait(TURN_S):
            events = poll.poll(0)
            if not hung_up(events) or events[0][1] & select.POLLIN:
                self._program_opened()
                listener.opened()
                self._serve(poll, listener)
                listener.closed()

    def _serve(self, poll: select.poll, listener: TerminalListener) -> None:
        """Pass lines on until the program has closed the terminal and all its lines are passed on."""
        splitter = LineSplitter()
        gone = False
        while not (gone or self._closing.is_set()):
            gone = hung_up(poll.poll(round(TURN_S * 1000)))
            data = self._read()
            if gone:  # up to UNREAD_MAX: further bytes belong to the next program
                data += b"".join(islice(iter(self._read, b""), UNREAD_MAX // CHUNK))
                self._program_closed()
            for line in splitter.split(data):
                listener.received(line)
            with self._lock:
                self._flush()
            if len(data) == CHUNK:
                self._closing.wait(TURN_S)

    def _read(self) -> bytes:
        """Return the next bytes; empty if there are none."""
        try:
            return os.read(self._master, CHUNK)
        except OSError:
            return b""

    def _program_opened(self) -> None:
        """Record an opening; keep the program's settings, but switch echo off: the node would read its own answers."""
        with self._lock, contextlib.suppress(OSError, termios.error):
            self._open = True
            self._pending_openings += 1
            settings = termios.tcgetattr(self._master)
            if settings[LOCAL] & termios.ECHO:
                settings[LOCAL] &= ~termios.ECHO
                termios.tcsetattr(self._master, termios.TCSANOW, settings)

    def _program_closed(self) -> None:
        """Discard the program's settings and the answers it has not read, so that the next program does not get them.

        Linux has two queues: one of 16 kB and, nearer to the program, one of 4 kB, which only a change of the settings
        discards. Other systems have one queue.
        """
        with self._lock, contextlib.suppress(OSError, termios.error):
            self._open = False
            self._unread = b""
            if sys.platform == "linux":
                termios.tcflush(self._master, termios.TCOFLUSH)
                tty.setraw(self._master, termios.TCSAFLUSH)
            else:
                termios.tcflush(self._master, termios.TCIFLUSH)
                tty.setraw(self._master, termios.TCSANOW)

    def close(self) -> None:
        """Close the terminal and remove the link."""
        self._closing.set()
        if self._thread is not None:
            self._thread.join(timeout=2.0)
        unlink(self.path, self._device)
        with self._lock:
            self._open = False
            self._unread = b""
            os.close(self._master)


def hung_up(events: list[tuple[int, int]]) -> bool:
    """Return whether no program has the terminal open."""
    return any(event & select.POLLHUP for _, event in events)


GROUP: Final = "dialout"
"""On Linux the group of users who may open serial ports."""
GROUP_MODE: Final = 0o660


def remove_leftover(path: Path) -> None:
    """Remove a link that a node has left behind: the device that it names has gone with the node."""
    if path.is_symlink() and not path.exists():
        with contextlib.suppress(OSError):  # `link` says what to do
            path.unlink()


def link(path: Path, device: str) -> None:
    """Link `path` to `device`; raises Refused (BAD_VALUE): another file has this path, or this user may not write there."""
    try:
        path.symlink_to(device)
    except FileExistsError as error:
        raise bad_value(
            f"--legacy {path} already exists. Choose another path for this robot, or remove it if no program uses it.",
        ) from error
    except OSError as error:
        raise bad_value(
            f"--legacy {path}: {error.strerror}. Choose a path you may write, for example /tmp/beatrix; a link such as "
            "/dev/ttyACM9, which programs find by themselves, needs an administrator.",
        ) from error


def unlink(path: Path, device: str) -> None:
    """Remove `path` if it still leads to `device`."""
    with contextlib.suppress(OSError):
        if str(path.readlink()) == device:
            path.unlink()


def share(device: str) -> None:
    """Let the users who may open serial ports open `device`, if this process has the right to allow it."""
    with contextlib.suppress(KeyError, OSError):  # no such group, or this user is not in it
        os.chown(device, -1, grp.getgrnam(GROUP).gr_gid)
        Path(device).chmod(GROUP_MODE)  # after chown, so that no other group can open it
