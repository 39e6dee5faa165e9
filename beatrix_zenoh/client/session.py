"""A client's session under one seat, shared by all robots of a program, and the thread that runs its callbacks.

A program or verb that names no robot means the only one online.
"""

from __future__ import annotations

import contextlib
import logging
import math
import queue
import sched
import threading
import time
from collections.abc import Callable, Collection
from dataclasses import replace
from typing import Self, TypeVar
from weakref import WeakValueDictionary

import msgspec

from beatrix_zenoh import bus as zbus
from beatrix_zenoh import threads
from beatrix_zenoh.bus import CLOSED, Bus, Incoming, ProcessBound, Received, Reply
from beatrix_zenoh.contract import codec, printable
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import Reason, Source
from beatrix_zenoh.contract.errors import NoAnswer, Refused, WrongUsage, bad_value
from beatrix_zenoh.settings import Settings

LOG = logging.getLogger("beatrix_zenoh.client")
M = TypeVar("M", bound=msgspec.Struct)
Place = tuple[str, str]
"""Name and side of a robot."""
REPORT = 200
"""Largest number of characters of such an error: any client can cause it."""
SENDERS = 1000
"""Largest number of reported senders; further senders are not reported."""


class Closable:
    """What the end of its `with` block closes."""

    def close(self) -> None:
        """Close it; may be called twice."""
        raise NotImplementedError

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exc: object) -> None:
        self.close()


class Reporter:
    """Logs errors of messages once for each sender, or for each robot in their keys if the sender is unknown."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._reported: set[str] = set()

    def report(self, sender: str, key: str, what: str) -> None:
        """Log a warning; `sender` is a Zenoh session, empty if unknown."""
        parts = keys.parse(key)
        whose = sender or (parts.robot if parts else "") or key
        with self._lock:
            if whose in self._reported or len(self._reported) >= SENDERS:
                return
            self._reported.add(whose)
        source = f"{key or 'error reply'}{f' from session {sender}' if sender else ''}"
        LOG.warning("%s: %s", printable.line(source), printable.line(what, REPORT))


class Client(ProcessBound, Closable):
    """One Zenoh session under one seat; robots of this process share it.

    A liveliness token announces the seat, so that a robot notices the end of the session and stops its motion. Raises
    NoAnswer (NO_ROUTER, ACCOUNT_REFUSED) or, for an invalid endpoint or an expired certificate, WrongUsage.
    """

    def __init__(self, settings: Settings, *, announce: bool = True, source: Source = Source.SDK) -> None:
        """Open the session; without `announce` a motion continues after the end of the session."""
        self.settings = settings
        self.source = source
        """The kind of this program, for events."""
        self.bus: Bus = zbus.connect(settings.connect, label=settings.who, account=settings.account)
        self.losses = 0
        """Number of losses of the router so far; a query that was sent before a loss is lost too."""
        self.lost_s = -math.inf
        """Time of the last of them, or of the return after it (monotonic clock, s)."""
        self.seen: set[Place] = set()
        """Robots that were online or have answered since the session began."""
        self._reporter = Reporter()
        self.dispatcher = Dispatcher()
        """The thread for the user's callbacks; it starts with the first callback."""
        self._lock = threading.Lock()
        self._closed = False
        self._parts: WeakValueDictionary[int, Closable] = WeakValueDictionary()
        """in the order of their beginning"""
        self._media: Bus | None = None
        self.bus.watch_router(self._on_router)
        self._description = keys.program(settings.who, self.bus.session_id)
        self.bus.serve(self._description, self._describe)
        if announce:
            self.bus.declare_token(keys.seat(settings.who, self.bus.session_id))

    @property
    def media(self) -> Bus:
        """A second session for pictures, so that they do not delay replies and positions; opened at its first use.

        Raises:
            NoAnswer: NO_ROUTER or ACCOUNT_REFUSED.
            WrongUsage: SHUTDOWN, the client was closed.
        """
        with self._lock:
            if self._closed:
                raise WrongUsage(Reason.SHUTDOWN, CLOSED)
            if self._media is None:
                settings = self.settings
                self._media = zbus.connect(settings.connect, label=settings.who, account=settings.account)
            return self._media

    def under(self, seat: str) -> Client:
        """Return this session under another seat, as only the teacher's account may use it; close only this one."""
        other = object.__new__(Client)
        other.__dict__ |= vars(self) | {"settings": replace(self.settings, who=seat)}
        return other

    def _on_router(self, there: bool) -> None:  # noqa: FBT001
        self.losses += not there
        self.lost_s = time.monotonic() if self.losses else -math.inf

    def _describe(self, incoming: Incoming) -> None:
        """Answer on Zenoh's thread, without a lock, because `media` holds it while it opens a session."""
        sessions = [bus for bus in (self.bus, self._media) if bus is not None]
        incoming.reply(self._description, *incoming.raw.answer(zbus.describe(sessions)))
        incoming.finish()

    def robots(self) -> list[Place]:
        """Return name and side of every robot online.

        Raises:
            NoAnswer: there seems to be none because the router has put this account out (ACCOUNT_REFUSED) or is stuck
                (NO_ROUTER).
        """
        present = self.bus.robots()
        if not present and (error := self.bus.refusal() or self.bus.silence()) is not None:
            raise error
        self.seen.update(present)
        return present

    def read(self, answer: Reply | Received, kind: type[M]) -> M | None:
        """Decode a reply or publication; if it cannot be decoded, log this once for each sender and return None."""
        try:
            return codec.decode(answer.payload, kind)
        except Refused as error:
            self.report(answer, f"ignored: {error} The sender is a foreign program or has another version.")
            return None

    def report(self, answer: Reply | Received, what: str) -> None:
        """Log an error of a reply or publication once for each sender."""
        self._reporter.report(answer.sender, answer.key, what)

    def at_close(self, part: Closable) -> None:
        """Close this part before the session, if it still exists then; raises WrongUsage (SHUTDOWN) if it is closed."""
        with self._lock:
            if self._closed:
                raise WrongUsage(Reason.SHUTDOWN, CLOSED)
            self._parts[id(part)] = part

    def close(self) -> None:
        """Close the session; robots stop its running motions. May be called twice. Does nothing in a forked child."""
        if self._inherited:
            return
        with self._lock:
            self._closed = True
            parts = list(self._parts.values())
        for part in reversed(parts):
            part.close()
        self.bus.close()
        with self._lock:  # `media` may be opening its session
            media = self._media
        if media is not None:
            media.close()
        self.dispatcher.close()


class Dispatcher:
    """Runs the user's callbacks, because Zenoh's own threads must not be blocked.

    Calls run in order, at once or at given times, in a thread that starts with the first call. Exceptions of calls are logged.
    """

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._calls: queue.SimpleQueue[tuple[float, Callable[[], object]] | None] = queue.SimpleQueue()
        self._thread: threading.Thread | None = None
        self._closed = False

    def call(self, do: Callable[[], object], at_s: float = 0.0) -> None:
        """Run `do` in the dispatcher's thread, not before `at_s` (monotonic clock, s)."""
        with self._lock:
            closed = self._closed
            if self._thread is None and not closed:
                self._thread = threads.start(self._run, "callbacks")
        if not closed:
            self._calls.put((at_s, do))
        elif threading.current_thread() is self._thread and not at_s:
            self._do(do)

    def _run(self) -> None:
        due = sched.scheduler(time.monotonic)
        while True:
            wait_s = due.run(blocking=False)
            with contextlib.suppress(queue.Empty):
                call = self._calls.get(timeout=wait_s)
                if call is None:
                    return
                at_s, do = call
                due.enterabs(at_s, 0, self._do, (do,))

    @staticmethod
    def _do(do: Callable[[], object]) -> None:
        try:
            do()
        except Exception:  # the user's code may raise any exception; concurrent.futures logs them, too
            LOG.exception("A callback failed.")

    def close(self) -> None:
        """Run the calls that are due, and those that they ask for, and end the thread; all other calls are dropped."""
        with self._lock:
            self._closed = True
            thread = self._thread
        self._calls.put(None)
        if thread is not None and thread is not threading.current_thread():
            thread.join(timeout=2.0)


def chosen_name(client: Client, *, acts: bool = True, present: Collection[Place] | None = None) -> str:
    """Return the name in the settings or, if they name none, that of the only robot online.

    A robot online under the default name `user-host` takes precedence over all others.

    Args:
        client: the session.
        acts: whether robots are moved or changed. Then the robot of an account counts as named: a student whose
            simulation is not running must not move the robot of the class by mistake.
        present: the robots online; None: ask the router, if they matter.

    Raises:
        NoAnswer: no robot is named, and none is online.
        Refused: no robot is named, and several are online.
    """
    settings = client.settings
    own = settings.account is not None and settings.account.robot
    if settings.named or (acts and own):
        return settings.robot
    if present is None:
        present = client.robots()
    if any(robot == settings.robot for robot, _ in present):
        return settings.robot
    return only_name(present, client.bus.endpoint)


def only_name(present: Collection[Place], endpoint: str) -> str:
    """Return the name of the only robot online; raises the errors of `chosen_name`."""
    found = sorted({robot for robot, _ in present})
    if not found:
        raise NoAnswer(
            Reason.NO_ANSWER,
            f"No robot is online at {endpoint}. Start a simulation with `beatrix sim` or `beatrix up`.",
        )
    if len(found) > 1:
        raise bad_value(
            f"Several robots are online: {', '.join(found)}. Choose one: with its name in a program, such as "
            f'Robot("{found[0]}"), with --name {found[0]} in a command, or with BEATRIX_ROBOT.',
        )
    return found[0]
