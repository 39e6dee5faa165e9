"""Child processes of the command line and of the window: a supervisor starts, watches and ends them."""

from __future__ import annotations

import contextlib
import os
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time
import webbrowser
from collections.abc import Container, Iterator, Mapping, Sequence
from enum import Enum
from pathlib import Path
from types import MappingProxyType
from typing import IO, Self

from beatrix_zenoh import bus as zbus
from beatrix_zenoh import threads
from beatrix_zenoh.account import Account
from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.errors import BeatrixError, NoAnswer, Refused
from beatrix_zenoh.output import CODES, FAILED, USAGE, note, typed
from beatrix_zenoh.process_groups import GROUP, NEW_GROUP, ask_to_end, kill_group
from beatrix_zenoh.settings import DEFAULT_ENDPOINT
from beatrix_zenoh.shutdown import INTERRUPTED, Shutdown, signals_ignored

PYTHON = (sys.executable, "-X", "utf8", "-P", "-m")
"""Starts a module of ours; its pipes are UTF-8 on Windows, too, where names of users, folders and ports may have umlauts."""
READY_S = 20.0
"""Time (s) after which a start is reported as slow; a busy computer that imports MuJoCo may need all of it."""
CRASHES_S = 60.0
"""A robot that crashes twice within this time (s) is not started again."""
REFUSALS = (FAILED, USAGE, CODES[Reason.ACCOUNT_REFUSED], CODES[Reason.ACCESS_DENIED])
"""Exit codes of a process that cannot do what it was started for; it would end in the same way again."""
END_S = 4.0
"""Time to end (s), in which a node also stops its robot; after this time the child is killed."""
KILL_S = 0.4
"""Time (s) before a deadline at which children that do not end are killed, and the folder of their output deleted."""
POLL_S = 0.02
WATCH_S = 0.2
"""Period (s) in which `watch` prints the output of the children."""
LAST_LINES = 5
"""Number of output lines of a failed child that are shown."""


class Role(Enum):
    """What the end of a child means for its supervisor."""

    REQUIRED = "all children end"
    ROBOT = "it is started again after a crash; the other children continue"
    WINDOW = "the other children continue"


def in_words(code: int) -> str:
    """Return an exit code as text: the name of the signal that ended the process, or the number."""
    try:
        return signal.Signals(-code).name
    except ValueError:
        return f"exit code {code}"


def start_child(
    arguments: Sequence[str], output: IO[bytes] | int, environment: Mapping[str, str]
) -> subprocess.Popen[bytes]:
    """Start `beatrix …` with more variables; `output`: where it writes to, as for Popen.

    It has its own process group, so that Ctrl-C reaches only the parent. Its standard input is a pipe from the parent,
    so that it ends with the parent even if the parent is killed (see cli/__main__.py).
    """
    return subprocess.Popen(
        [*PYTHON, "beatrix_zenoh.cli", "--with-parent", *arguments],
        stdin=subprocess.PIPE,
        stdout=output,
        stderr=subprocess.STDOUT,
        env=os.environ | dict(environment),
        process_group=GROUP,
        creationflags=NEW_GROUP,
    )


class Child:
    """A `beatrix …` process whose output goes to a file."""

    def __init__(
        self,
        title: str,
        arguments: Sequence[str],
        log: Path,
        role: Role = Role.REQUIRED,
        environment: Mapping[str, str] = MappingProxyType({}),
        robots: int = 1,
    ) -> None:
        self.title, self.arguments, self.log, self.role = title, arguments, log, role
        self.robots = robots
        """how many times it prints `ready`"""
        self._reported = 0
        with log.open("wb") as output:
            self._process = start_child(arguments, output, environment)

    @property
    def ready(self) -> bool:
        """Whether the process has printed `ready`, a simulation of several robots for each of them."""
        return sum(line.startswith("ready ") for line in self.lines()) >= self.robots

    @property
    def code(self) -> int | None:
        """Exit code; None while it runs."""
        return self._process.poll()

    def lines(self) -> list[str]:
        """Return the lines of the process's output; empty if the log file has been deleted."""
        return self._written().decode("utf-8", "replace").splitlines()

    def new_lines(self) -> list[str]:
        """Return the complete lines that the process has written since the last call."""
        written = self._written(self._reported)
        complete = written[: written.rfind(b"\n") + 1]
        self._reported += len(complete)
        return complete.decode("utf-8", "replace").splitlines()

    def _written(self, since: int = 0) -> bytes:
        try:
            with self.log.open("rb") as log:
                log.seek(since)
                return log.read()
        except FileNotFoundError:
            return b""

    def end(self, grace_s: float = END_S) -> None:
        """Ask the process to end and wait; kill the process after `grace_s` (s)."""
        end(self._process, grace_s)
        if self._process.stdin is not None:
            self._process.stdin.close()


def end(process: subprocess.Popen[bytes], grace_s: float) -> None:
    """Ask a process to end, unless it has ended, and wait; kill the process after `grace_s` (s)."""
    ask_to_end(process)
    try:
        process.wait(grace_s)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()


def end_with_children(process: subprocess.Popen[bytes], grace_s: float) -> None:
    """End a process of `start_child` as `end` does, and kill what it has started."""
    end(process, grace_s)
    kill_group(process)


class Supervisor:
    """Child processes that run during a `with` block; the last one started ends first.

    Their output goes to a temporary folder. The folder is deleted at the end, unless a child has failed and the error
    message does not show all of its output. `end_all` may be called while another thread starts or awaits a child.
    """

    def __init__(
        self, environment: Mapping[str, str] = MappingProxyType({}), prefix: str = "beatrix-"
    ) -> None:
        """Prepare for children with these variables besides those of this process.

        `prefix`: beginning of the name of the temporary folder.
        """
        self._environment = environment
        self.folder = Path(tempfile.mkdtemp(prefix=prefix))
        self._kept = False
        self._starting = threading.Lock()
        self._closed = False
        self.children: list[Child] = []
        self._crashed_s: dict[str, float] = {}
        """time of the last crash by title (monotonic clock, s)"""

    def start(self, title: str, *arguments: str, role: Role = Role.REQUIRED, robots: int = 1) -> Child:
        """Start `beatrix …`, with so many robots; wait with `wait_ready`. Raises Refused (SHUTDOWN) after `end_all`."""
        with self._starting:
            if self._closed:
                raise Refused(Reason.SHUTDOWN, f"The {title} is not started, because this program ends.")
            number = len(list(self.folder.glob(f"{title}*.log")))
            log = self.folder / (f"{title}-{number + 1}.log" if number else f"{title}.log")
            child = Child(title, arguments, log, role, self._environment, robots)
            self.children.append(child)
        return child

    def wait_ready(self) -> None:
        """Wait until all children are ready, and print which of them is slow every READY_S seconds.

        Raises:
            Refused: a required child has ended, or the last robot.
        """
        slow_s = READY_S
        began_s = time.monotonic()
        while waiting := [child for child in self.children if not child.ready]:
            robots = self._robots()
            reports = self.tend()
            if robots and not self._robots():
                raise Refused(Reason.SHUTDOWN, reports.pop())
            for report in reports:
                note(report)
            if time.monotonic() - began_s > slow_s:
                titles = " and the ".join(child.title for child in waiting)
                note(f"Still waiting for the {titles} after {slow_s:.0f} s; Ctrl-C ends all.")
                slow_s += READY_S
            time.sleep(POLL_S)

    def _robots(self) -> list[Child]:
        return [child for child in self.children if child.role is Role.ROBOT]

    def finish(self, child: Child) -> None:
        """End one child."""
        self.children.remove(child)
        child.end()

    def forget_ended(self) -> None:
        """Remove the children that have ended."""
        for child in list(self.children):
            if child.code is not None:
                self.finish(child)

    def check(self, roles: Container[Role] = (Role.REQUIRED,)) -> None:
        """Raise Refused if a child with one of these roles has ended."""
        for child in self.children:
            if child.code is not None and child.role in roles:
                raise Refused(
                    Reason.SHUTDOWN,
                    f"The {child.title} has ended ({in_words(child.code)}). {self.output_of(child)}",
                )

    def tend(self) -> list[str]:
        """Start crashed robots again, remove other children that have ended, and return a report about each.

        Raises:
            Refused: a required child has ended.
        """
        self.check()
        return [self._replace(child, child.code) for child in list(self.children) if child.code is not None]

    def _replace(self, child: Child, code: int) -> str:
        """Start a crashed robot again, or remove the child; return a report for the user."""
        now_s = time.monotonic()
        crashed = code not in (0, INTERRUPTED, *REFUSALS) and child.role is Role.ROBOT
        cause = f"The {child.title} has ended ({in_words(code)})"
        output = f" {self.output_of(child)}"
        self.finish(child)
        if crashed and now_s - self._crashed_s.get(child.title, -CRASHES_S) >= CRASHES_S:
            self._crashed_s[child.title] = now_s
            self.start(child.title, *child.arguments, role=child.role, robots=child.robots)
            return f"{cause}. It is started again, as if it had just been switched on.{output}"
        others = "; the robots continue to run" if child.role is Role.WINDOW else " and stays down"
        return f"{cause}{others}.{output}\nTo start it again: {typed('beatrix', *child.arguments)}"

    def new_lines(self) -> list[str]:
        """Return the lines that the children have written since the last call, each with the title of its child."""
        return [f"{child.title}: {line}" for child in self.children for line in child.new_lines()]

    def output_of(self, child: Child) -> str:
        """Return the last lines of the output of a child, and the path of its log if there are more."""
        lines = child.lines()
        shown = "\n".join(f"  {line}" for line in lines[-LAST_LINES:])
        if len(lines) <= LAST_LINES:
            return f"Its output:\n{shown}" if lines else "It printed nothing."
        self._kept = True
        return f"Its last lines:\n{shown}\nIts complete output is in {child.log}."

    def end(self) -> None:
        """End all children, the last one started first."""
        while self.children:
            self.children.pop().end()
        if not self._kept:
            shutil.rmtree(self.folder, ignore_errors=True)

    def end_all(self, deadline_s: float) -> None:
        """End all children at the same time.

        Those that still run shortly before `deadline_s` (monotonic clock, s) are killed.
        """
        with self._starting:
            self._closed = True
        grace_s = max(0.0, deadline_s - KILL_S - time.monotonic())
        ending = [
            threads.start(lambda child=child: child.end(grace_s), f"end-{child.title}")  # type: ignore[misc]
            for child in list(self.children)
        ]
        for thread in ending:
            thread.join()
        self.end()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, _kind: object, error: BaseException | None, _traceback: object) -> None:
        with signals_ignored():
            try:
                if isinstance(error, BeatrixError):
                    self.check((Role.REQUIRED, Role.ROBOT))  # its end is the cause of the error
            finally:
                self.end()


def start_router(supervisor: Supervisor, endpoint: str, account: Account | None = None) -> str:
    """Start a router if none answers, and return its state as text.

    Raises:
        NoAnswer: NO_ROUTER, no router answers, and the endpoint is on another computer or that of a class.
    """
    if zbus.is_listening(endpoint):
        return "runs already"
    if account is not None:
        zbus.connect(endpoint, account=account).close()  # raises NoAnswer with advice
    if not zbus.is_local(endpoint):
        port = endpoint.rpartition(":")[2]
        raise NoAnswer(
            Reason.NO_ROUTER,
            f"No router answers at {endpoint}, which is another computer. Start one there with "
            f"`beatrix router --listen tcp/0.0.0.0:{port}`, or omit --connect to start one here.",
        )
    supervisor.start("router", "router", "--listen", endpoint)
    supervisor.wait_ready()
    return "started"


def beatrix() -> str:
    """Return how to start `beatrix` in a terminal: its path if the shell does not find it, as after `make demo`."""
    mine = Path(sys.executable).with_name("beatrix")
    return str(mine) if shutil.which("beatrix") is None and mine.exists() else "beatrix"


def advice(endpoint: str, verbs: Sequence[str], logs: Path) -> str:
    """Return a text with the commands to type next, and the folder with the output of the children."""
    where = "" if endpoint == DEFAULT_ENDPOINT else " " + typed("--connect", endpoint)
    lines = "\n".join(f"  {typed(beatrix())} {words}{where}" for words in verbs)
    return f"\nNow type in another terminal:\n{lines}\n\nThe output of all processes is in {logs}. Ctrl-C here ends them."


def free_port() -> int:
    """Return a port of this computer that is free now."""
    with socket.create_server(("127.0.0.1", 0)) as free:
        port: int = free.getsockname()[1]
        return port


def open_in_browser(address: str) -> bool:
    """Open an address in the browser of the user, which stays open after this program; return whether there is one."""
    try:
        webbrowser.get()
    except webbrowser.Error:
        return False
    silent = subprocess.DEVNULL
    # A process of its own, because some browsers keep the one that opens them waiting until they are closed.
    subprocess.Popen(
        [*PYTHON, "webbrowser", address], stdin=silent, stdout=silent, stderr=silent, start_new_session=True
    )
    return True


@contextlib.contextmanager
def end_on_interrupt() -> Iterator[None]:
    """Print a note instead of raising KeyboardInterrupt: Ctrl-C and SIGTERM are the normal end of the block."""
    try:
        yield
    except KeyboardInterrupt:
        note("Ending.")


def watch(supervisor: Supervisor, shutdown: Shutdown, last: Child | None = None) -> None:
    """Print the output of the children and start crashed robots again, until Ctrl-C.

    Args:
        supervisor: the supervisor of the children.
        shutdown: the value of `signals_interrupt`.
        last: return when this child has ended; None: only Ctrl-C ends the function.

    Raises:
        Refused: a required child has ended.
    """
    while last is None or last.code is None:
        for line in (*supervisor.tend(), *supervisor.new_lines()):
            note(line)
        if shutdown.requested(WATCH_S):
            raise KeyboardInterrupt
