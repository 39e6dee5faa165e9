"""`beatrix router --class`: the two routers of a class as child processes, which are started again when they end.

A client can end Zenoh 1.10 with one declaration (docs/explanation/zenoh-declarations.md), so this process has no part in
the traffic of the class. It only starts the routers, keeps the reports of lessons, and follows changes of the accounts.
"""

from __future__ import annotations

import contextlib
import os
import queue
import subprocess
import threading
import time
from collections.abc import Collection, Iterator
from pathlib import Path
from typing import Final, cast

import msgspec

from beatrix_zenoh import bus as zbus
from beatrix_zenoh import threads
from beatrix_zenoh.account import renewal, today
from beatrix_zenoh.classroom import router_file
from beatrix_zenoh.classroom.pending import PendingDecisions
from beatrix_zenoh.classroom.reports import KeptReports
from beatrix_zenoh.classroom.router_file import CHECK_KEY, Part, RouterFile
from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.errors import BeatrixError, NoAnswer, Refused
from beatrix_zenoh.output import note, say
from beatrix_zenoh.process_groups import GROUP, NEW_GROUP
from beatrix_zenoh.processes import PYTHON, end, in_words
from beatrix_zenoh.shutdown import Shutdown

POLL_S: Final = 0.1
READY_S: Final = 20.0
"""Longest time (s) until a router is ready."""
END_S: Final = 2.0
AGAIN_S: Final = 1.0
"""Time (s) between two attempts to start a router that cannot listen."""
STACK: Final = str(8 << 20)
"""Stack (bytes) of each of Zenoh's threads. A key of 8 000 chunks overflows the usual 2 MiB; with 64 MiB the stacks alone
would exceed the memory of `router_process.MEMORY` (decision 0090)."""
PERIOD_S, ANSWER_S = 1.0, 2.0
"""Time between two queries, and longest time until an answer (s)."""
FAILURES: Final = 3
"""Queries without an answer, one after the other, after which a router counts as stuck. Two may also fail because the
computer was asleep."""
STUCK: Final = f"it did not answer {FAILURES} times, so it was ended"
PUT_OUT: Final = "take it out of class.toml and run `beatrix classroom init class.toml`."
OFTEN, OFTEN_S = 3, 60.0
"""A router that has ended OFTEN times in OFTEN_S is probably ended on purpose."""
CLOSED_S: Final = 60.0
"""Time (s) without a router of the seats after that of robots and teacher has ended OFTEN times."""


class ChildRouter:
    """The process of one router."""

    def __init__(self, part: Part, file: RouterFile) -> None:
        """Start it; wait for it with `wait_ready`."""
        self.part, self.file = part, file
        self.connected: list[str] = []
        """accounts"""
        self.failures = 0
        """number of queries through it without an answer, since the last answer"""
        self._closed = threading.Event()
        self._asking: threading.Thread | None = None
        self._events: queue.SimpleQueue[list[object]] = queue.SimpleQueue()
        self._process = subprocess.Popen(
            [*PYTHON, "beatrix_zenoh.classroom.router_process", part.value],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            env={"RUST_MIN_STACK": STACK, **os.environ},
            process_group=GROUP,
            creationflags=NEW_GROUP,
        )
        self._reader = threads.start(self._read, f"router-{part.value}")
        self._write(file)

    def _read(self) -> None:
        for line in self._process.stdout or ():
            with contextlib.suppress(msgspec.DecodeError):  # another line than ours
                self._events.put(msgspec.json.decode(line, type=list[object]))

    def _write(self, message: object) -> None:
        """Send a line to the process; one that has ended needs none."""
        stdin = self._process.stdin
        with contextlib.suppress(OSError):
            if stdin is not None:
                stdin.write(msgspec.json.encode(message) + b"\n")
                stdin.flush()

    def wait_ready(self) -> None:
        """Wait until the router listens; raise the error of its process if it cannot."""
        deadline_s = time.monotonic() + READY_S
        while time.monotonic() < deadline_s:
            with contextlib.suppress(queue.Empty):
                event, *data = self._events.get(timeout=POLL_S)
                if event == "ready":
                    self._asking = threads.start(self._ask, "answering")
                    return
                if event == "failed":
                    reason, message = cast("tuple[str, str]", data)
                    kind = NoAnswer if reason == Reason.NO_ROUTER else Refused
                    raise kind(Reason(reason), message)
                continue
            if self.code is not None:
                raise Refused(Reason.SHUTDOWN, f"The {self.part.called} has ended ({in_words(self.code)}).")
        raise Refused(Reason.SHUTDOWN, f"The {self.part.called} was not ready within {READY_S:.0f} s.")

    @property
    def code(self) -> int | None:
        """Exit code; None while it runs."""
        return self._process.poll()

    def _ask(self) -> None:
        """Ask the router of robots and teacher through this one each second, because a router can run and be stuck.

        It sends a query as clients do: one for tokens may take a second after a seat with 2 000 subscribers has left,
        while STOP takes 10 ms (measured).
        """
        while not self._closed.is_set():
            try:
                bus = zbus.connect(self.file.endpoint(self.part), account=self.file.account())
            except NoAnswer:  # strangers may keep sessions out of a router that serves all others
                self._closed.wait(PERIOD_S)
                continue
            with bus:
                while not self._closed.wait(PERIOD_S):
                    answered = bus.query(CHECK_KEY, timeout_s=ANSWER_S).is_answered(ANSWER_S)
                    self.failures = 0 if answered else self.failures + 1

    def kill(self) -> None:
        """End the process at once."""
        end(self._process, 0.0)

    def floods(self) -> Iterator[str]:
        """Handle what the process has printed; yield the accounts that it has put out for their tokens."""
        while not self._events.empty():
            event, *data = self._events.get()
            if event == "connected":
                self.connected = cast("list[str]", data[0])
            elif event == "flood":
                yield str(data[0])

    def put_out(self, accounts: set[str], file: RouterFile) -> None:
        """End the sessions of accounts, which are not in `file` any more; others notice nothing."""
        self.file = file
        self._write(sorted(accounts))

    def close(self) -> None:
        """End the process."""
        if self._process.stdin is not None:
            with contextlib.suppress(OSError):
                self._process.stdin.close()
        try:
            self._process.wait(END_S)
        except subprocess.TimeoutExpired:
            self.kill()
        self._reader.join(END_S)
        self._closed.set()  # after the end of the router, which may let no session close
        if self._asking is not None:
            self._asking.join(3 * ANSWER_S)


class ClassRouters:
    """Both routers of a class."""

    def __init__(self, of_class: Path, lessons: Collection[str]) -> None:
        """Start the routers of a class file or router file, and keep the reports of these lessons.

        Raises the errors of `router_file.load` and `open_router`.
        """
        self.file = router_file.load(of_class)
        self._of_class, self._place = of_class, router_file.place(of_class)
        self._written_ns = self._place.stat().st_mtime_ns
        self._children: dict[Part, ChildRouter] = {}
        self._ends: dict[Part, list[tuple[float, frozenset[str]]]] = {part: [] for part in Part}
        """when each router has ended (monotonic clock, s), with the accounts that were connected to it or through it"""
        self._again_s: dict[Part, float] = {}
        """when to start a router that does not run (monotonic clock, s)"""
        try:
            self._start(Part.ROBOTS)
            self._reports = zbus.connect(self.file.listen, account=self.file.account())
            KeptReports(self._reports, lessons)
            PendingDecisions(self._reports, self._place.with_name("pending.json"), lambda: self.file.robots)
            self._start(Part.SEATS)
        except BeatrixError:
            self.close()
            raise

    def _start(self, part: Part) -> None:
        child = ChildRouter(part, self.file)
        self._children[part] = child
        child.wait_ready()

    def say_ready(self) -> None:
        """Print where the routers listen, and whether accounts expire soon."""
        say(f"ready {self.file.listen} (seats: {self.file.listen_seats})")
        if expiring := renewal(self.file.class_name, self.file.expires, today()):
            note(expiring)

    def tend(self) -> None:
        """Start routers that have ended again, follow changes of the accounts, and report both."""
        for part in Part:
            child = self._children.get(part)
            if child is not None:
                self._check(part, child)
            elif time.monotonic() >= self._again_s[part]:
                self._again(part)
        found = self._changed()
        if found is not None:
            self._follow(found)

    def _check(self, part: Part, child: ChildRouter) -> None:
        """Report what a router has printed; start it again if it has ended or is stuck.

        Keep the seats out for a while if they end the router of robots and teacher.
        """
        if stuck := self._stuck(part, child):
            child.kill()
        if (code := child.code) is not None:
            child.close()
        for account in child.floods():  # after the end also what it has printed last
            note(flooded(account))
        if code is None:
            return
        suspects = self._children.values() if part is Part.ROBOTS else (child,)
        connected = frozenset(name for one in suspects for name in one.connected)
        ends = [*self._ends[part], (time.monotonic(), connected)]
        self._ends[part] = ends
        recent = [who for at_s, who in ends if at_s > ends[-1][0] - OFTEN_S]
        note(ended(part, STUCK if stuck else in_words(code), connected, len(ends), recent))
        if part is Part.ROBOTS and len(recent) >= OFTEN and Part.SEATS in self._children:
            self._put_off(Part.SEATS, CLOSED_S)
            note(f"The seats are out for {CLOSED_S:.0f} s. Robots and teacher work meanwhile.")
        self._again(part)

    def _stuck(self, part: Part, child: ChildRouter) -> bool:
        """Return whether a router does not answer; that of the seats is asked for answers of the other one."""
        robots = self._children.get(Part.ROBOTS)
        blameless = part is Part.SEATS and (robots is None or robots.failures > 0)
        return child.failures >= FAILURES and not blameless

    def _put_off(self, part: Part, wait_s: float) -> None:
        """Close a router; `tend` starts it again after a time (s)."""
        self._children.pop(part).close()
        self._again_s[part] = time.monotonic() + wait_s

    def _again(self, part: Part) -> None:
        """Start a router that ran before."""
        try:
            self._start(part)
        except BeatrixError as error:
            note(f"The {part.called} cannot start. {error.message} It tries again in {AGAIN_S:.0f} s.")
            self._put_off(part, AGAIN_S)
        else:
            note(f"The {part.called} runs again.")
            if part is Part.ROBOTS and Part.SEATS in self._children:
                self._children[Part.SEATS].failures = 0

    def _changed(self) -> RouterFile | None:
        """Return the file if it has changed since the last call; None if it has not or cannot be read."""
        try:
            if (written_ns := self._place.stat().st_mtime_ns) == self._written_ns:
                return None
            found = router_file.load(self._of_class)
        except (OSError, BeatrixError):
            return None  # the class file has changed, and `init` will follow
        self._written_ns = written_ns
        return None if found == self.file else found

    def _follow(self, found: RouterFile) -> None:
        """Use a new file: put removed accounts out, or restart the routers for which more has changed."""
        former, self.file = self.file, found
        for part, child in [*self._children.items()]:
            gone = set(former.own(part)) - set(found.own(part))
            if serves_alike(former, found, part):
                child.file = found
            elif gone and serves_alike(former.without(gone), found, part):
                child.put_out(gone, found)
                note(f"Put out: {', '.join(sorted(gone))}.")
            else:
                note(f"The accounts have changed: the {part.called} restarts.")
                child.close()
                self._again(part)
        if len(self._children) == len(Part):
            self.say_ready()

    def close(self) -> None:
        """End both routers."""
        if hasattr(self, "_reports"):
            self._reports.close()
        for child in self._children.values():
            child.close()


def serves_alike(one: RouterFile, other: RouterFile, part: Part) -> bool:
    """Return whether one of the routers is the same with both files."""
    return (one.endpoint(part), one.access(part)) == (other.endpoint(part), other.access(part))


def ended(part: Part, cause: str, connected: frozenset[str], count: int, recent: list[frozenset[str]]) -> str:
    """Return the report that a router has ended for the `count`th time.

    `recent`: the accounts that were connected at each of its ends within OFTEN_S.
    """
    names = ", ".join(sorted(connected)) or "none that it reported in time"
    text = f"The {part.called} has ended ({cause}), {count} x since the start. It is started again. Connected were: {names}."
    if len(recent) < OFTEN:
        return text
    suspects = ", ".join(sorted(frozenset.intersection(*recent))) or "no account was"
    return (
        f"{text}\nIt has ended {len(recent)} x within a minute, so a program may do it on purpose. Connected each time: "
        f"{suspects}. To put an account out, {PUT_OUT}"
    )


def flooded(account: str) -> str:
    """Return the report that an account was put out for its tokens."""
    return (
        f"{account} announced more programs than any lesson needs, so it is put out for a minute. To put it out for good, "
        f"{PUT_OUT}"
    )


def run(of_class: Path, lessons: Collection[str], shutdown: Shutdown) -> None:
    """Run the routers of a class until the shutdown; raises the errors of `ClassRouters`."""
    routers = ClassRouters(of_class, lessons)
    try:
        routers.say_ready()
        while not shutdown.requested(POLL_S):
            routers.tend()
    finally:
        routers.close()
