"""The Zenoh sessions of a process and of its nodes, and the description of a program from its declarations.

Each traffic class has a session, so that a flood in one class does not delay the others. Several nodes of one process
share the session of pictures and sound. A watchdog replaces sessions that the router has forgotten.
"""

from __future__ import annotations

import itertools
import sys
import threading
import weakref
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import NamedTuple

from beatrix_zenoh import threads
from beatrix_zenoh.bus.declarations import Publication
from beatrix_zenoh.bus.incoming import Incoming, Received
from beatrix_zenoh.bus.messages import HEALTH, HEALTHY, PUBLISHER, QUERYABLE, SUBSCRIBER
from beatrix_zenoh.bus.session import Bus
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import ProgramInfo, Reason
from beatrix_zenoh.contract.errors import NoAnswer, WrongUsage
from beatrix_zenoh.contract.rows import KeyRow

MEDIA = "media"
"""Traffic class of pictures and sound, in which a node only publishes. Nodes of one process share its session and no
other: a seat may flood its robot with queries of any other class, and the router disconnects a session that is full."""


class ProcessSessions:
    """The sessions of a process by traffic class of keys.toml; Zenoh delivers all data of one session in order.

    The session of a class is opened when this process first serves, subscribes to or publishes a key of the class.
    """

    def __init__(self, connect: Callable[[], Bus]) -> None:
        """Open the control session; raises the errors of `connect` (NoAnswer: no router)."""
        self.connect = connect
        self._lock, self._closing = threading.Lock(), threading.Lock()
        self._open: dict[str, Bus] = {CONTROL: connect()}
        self.watchdog = SessionWatchdog(self.opened)

    @property
    def control(self) -> Bus:
        """The control session."""
        return self._open[CONTROL]

    def session(self, traffic: str) -> Bus:
        """Return the session of a traffic class, opened if necessary; raises the errors of `connect`."""
        with self._lock:
            if traffic not in self._open:
                self._open[traffic] = self.connect()
            return self._open[traffic]

    def opened(self) -> dict[str, Bus]:
        """Return the open sessions by traffic class, the control session first."""
        with self._lock:
            return dict(self._open)

    def close(self) -> None:
        """Close all sessions, the control session last. May be called twice; the second call waits for the first."""
        with self._closing:
            for traffic, bus in sorted(self.opened().items(), key=lambda entry: entry[0] == CONTROL):
                bus.close()
                if traffic != CONTROL:
                    del self._open[traffic]


class Sessions:
    """The sessions as one node uses them, and what this node publishes in the session that it shares."""

    def __init__(
        self, opened: Callable[[], Bus] | ProcessSessions, shared: ProcessSessions | None = None
    ) -> None:
        """Use these sessions, or open some with a function that connects; raises its errors.

        `shared` are those of a process with several nodes, which then share the session of MEDIA and the watchdog.
        """
        self._own = opened if isinstance(opened, ProcessSessions) else ProcessSessions(opened)
        self._shared = shared
        self._published: dict[str, Callable[[], None]] = {}
        """The function that ends each publication in the shared session, by key."""

    @property
    def control(self) -> Bus:
        """The control session."""
        return self._own.control

    def session(self, traffic: str) -> Bus:
        """Return the session of a traffic class, opened if necessary; raises the errors of `connect`."""
        shared = self._shared if traffic == MEDIA else None
        return (shared or self._own).session(traffic)

    def opened(self) -> dict[str, Bus]:
        """Return the open sessions by traffic class, the control session first."""
        shared = {} if self._shared is None else self._shared.opened()
        return {**self._own.opened(), **{traffic: bus for traffic, bus in shared.items() if traffic == MEDIA}}

    def serve(self, key: str, handle: Callable[[Incoming], None]) -> None:
        """Pass queries on `key`, a key of keys.toml, to `handle`, as `Bus.serve` does."""
        self.session(_row(key).session).serve(key, handle)

    def serve_rest(
        self, traffic: str, key: str, handle: Callable[[Incoming], None], skips: Callable[[str], bool]
    ) -> None:
        """Pass queries of a traffic class on `key`, which has wildcards, to `handle`, as `Bus.serve_rest` does."""
        self.session(traffic).serve_rest(key, handle, skips)

    def subscribe(self, key: str, handle: Callable[[Received], None]) -> Callable[[], None]:
        """Pass publications on `key` to `handle`, as `Bus.subscribe` does."""
        return self.session(_row(key).session).subscribe(key, handle)

    def subscribe_newest(
        self, key: str, handle: Callable[[Received], None], skips: Callable[[str], bool]
    ) -> None:
        """Pass publications on `key` to `handle`, as `Bus.subscribe_newest` does."""
        self.session(_row(key).session).subscribe_newest(key, handle, skips)

    def publication(
        self, key: str, encoding: str, on_subscribed: Callable[[], None] | None = None
    ) -> Publication:
        """Declare a publication, as `Bus.publication` does."""
        traffic = _row(key).publish
        publication, end = self.session(traffic).publication(key, encoding, on_subscribed)
        if traffic == MEDIA and self._shared is not None:
            self._published[key] = end
        return publication

    def declare_token(self, key: str) -> Callable[[], None]:
        """Declare a token in the control session, as `Bus.declare_token` does."""
        return self.control.declare_token(key)

    def watch_tokens(self, key: str, handle: Callable[[str, bool], None]) -> None:
        """Report tokens to `handle`, as `Bus.watch_tokens` does."""
        self.control.watch_tokens(key, handle)

    def watch_router(self, handle: Callable[[bool], None]) -> None:
        """Report the connection to the router to `handle`, as `Bus.watch_router` does."""
        self.control.watch_router(handle)

    def watch_sessions(self, listener: SessionListener) -> Callable[[], None]:
        """Let the watchdog of the sessions report to a listener; return a function that ends this, before `close`."""
        if self._shared is None:
            return self._own.watchdog.add(listener)
        return self._shared.watchdog.add(listener, self._own.opened)

    def describe(self, side: str) -> ProgramInfo:
        """Return the description of the node that uses these sessions."""
        return describe(self._own.opened().values(), side, [*self._published])

    def close(self) -> None:
        """Close the sessions of this node, and end its publications in a shared one; may be called twice."""
        self._own.close()
        while self._published:
            self._published.popitem()[1]()


def _row(key: str) -> KeyRow:
    parts = keys.parse(key)
    if parts is None:
        raise ValueError(f"{key!r} is not a key of schemas/keys.toml")
    return keys.KEYS[parts.row]


COMMAND_LINES = ("beatrix", "beatrix.exe", "cli")
"""Names of programs whose first argument is a verb; `cli`: `python -m beatrix_zenoh.cli`."""


def describe(sessions: Iterable[Bus], side: str = "", published: Sequence[str] = ()) -> ProgramInfo:
    """Return the description of this program from the declarations of its sessions. Fast enough for Zenoh's threads.

    `side` is that of a node, `published` are keys in a session that it shares with others.
    """
    buses = list(sessions)

    def keys_of(kind: str) -> set[str]:
        return {key for bus in buses for key in bus.declared(kind)}

    return ProgramInfo(
        program=program_name(sys.argv),
        side=side,
        serves=sorted(key for key in keys_of(QUERYABLE) if not _is_description(key)),
        publishes=sorted({*keys_of(PUBLISHER), *published}),
        subscribes=sorted(keys_of(SUBSCRIBER)),
        asks=sorted({key for bus in buses for key in bus.asked()}),
    )


def program_name(words: list[str]) -> str:
    """Return the name of the program with these command-line words: `lesson.py`, `beatrix gui` or `python`."""
    path = Path(words[0] if words else "")
    name = path.parent.name if path.name == "__main__.py" else path.name
    if name in COMMAND_LINES:
        return " ".join(["beatrix", *words[1:2]])
    return "python" if name in ("", "-c") else name


def _is_description(key: str) -> bool:
    parts = keys.parse(key)
    return parts is not None and parts.row == "program"


CONTROL = "control"
"""Traffic class of tokens, STOP and commands; its session is always open and is closed last."""
PERIOD_S = 1.0
ANSWER_S = 1.0
FAILURES = 2
"""Failed checks in a row before a session is renewed; just after a reconnection one check may fail."""


class SessionListener(NamedTuple):
    """What a node gives to the watchdog."""

    renewed: Callable[[str], None]
    """called with the traffic class of a session that was replaced"""
    refused: Callable[[NoAnswer], None]
    """called when the router refuses the account"""


class SessionWatchdog:
    """A thread that replaces a session whose queryables the router has lost; it runs while there are listeners.

    If the router disconnects a session under a flood of messages, Zenoh 1.10 reconnects it without its declarations in
    about one case in ten. The session is then open, but the router delivers no query to it.

    If the router is back after a loss and refuses the account, it reports that to the listeners once, because Zenoh tries
    to connect for ever and reports nothing.
    """

    def __init__(self, opened: Callable[[], dict[str, Bus]]) -> None:
        """`opened` returns the sessions to check by traffic class, the control session first."""
        self._opened = opened
        self._lock = threading.Lock()
        self._listeners: dict[SessionListener, Callable[[], dict[str, Bus]]] = {}
        """The listeners, each with a function that returns the sessions of its node that no other node uses."""
        self._ended = threading.Event()
        self._thread: threading.Thread | None = None
        self._refusals = 0
        self._failures: weakref.WeakKeyDictionary[Bus, int] = weakref.WeakKeyDictionary()

    def add(self, listener: SessionListener, own: Callable[[], dict[str, Bus]] = dict) -> Callable[[], None]:
        """Report to a listener, on the watchdog's thread, and check the sessions that `own` returns for it alone.

        Of these one is checked in each period, because a process may have a hundred. Return a function that ends this.
        """
        with self._lock:
            self._listeners = {**self._listeners, listener: own}
            if self._thread is None:
                self._ended = ended = threading.Event()
                with threads.owned_by(None):  # not by the robot that adds the first listener
                    self._thread = threads.start(lambda: self._run(ended), "watchdog")
        return lambda: self._remove(listener)

    def _remove(self, listener: SessionListener) -> None:
        """End the reports to a listener; with the last one end the thread."""
        with self._lock:
            self._listeners = {other: own for other, own in self._listeners.items() if other is not listener}
            thread = None if self._listeners else self._thread
            if thread is not None:
                self._ended.set()
                self._thread = None
        if thread is not None:
            thread.join(timeout=3 * ANSWER_S)

    def _run(self, ended: threading.Event) -> None:
        for turn in itertools.count():
            if ended.wait(PERIOD_S):
                return
            opened = self._opened()
            control, *others = opened.values()
            for traffic, checked in opened.items():
                through = next(iter(others), None) if checked is control else control
                if through is not None and not ended.is_set():
                    self._check(traffic, checked, through, list(self._listeners))
            for listener, own in self._listeners.items():
                sessions = list(own().items())
                if sessions and not ended.is_set():
                    self._check(*sessions[turn % len(sessions)], control, [listener])
            if not ended.is_set():
                self._check_account(control)

    def _check(self, traffic: str, checked: Bus, through: Bus, listeners: list[SessionListener]) -> None:
        if not checked.served:
            return
        failed = not reached(checked, through)
        self._failures[checked] = self._failures.get(checked, 0) + 1 if failed else 0
        if self._failures[checked] < FAILURES:
            return
        del self._failures[checked]
        try:
            checked.renew()
        except (NoAnswer, WrongUsage):
            return  # the router has just been lost, and the old session remains; or the node closes
        for listener in listeners:
            listener.renewed(traffic)

    def _check_account(self, control: Bus) -> None:
        """Report a router that refuses the account twice in a row; one that has just started may refuse it once."""
        if control.connected:
            self._refusals = 0
        elif self._refusals < FAILURES:
            error = control.connection_error()
            if error is None or error.reason is not Reason.ACCOUNT_REFUSED:
                self._refusals = 0
                return
            self._refusals += 1
            if self._refusals == FAILURES:
                for listener in self._listeners:
                    listener.refused(error)


def reached(checked: Bus, through: Bus) -> bool:
    """Return False if the router passes no query to `checked`; True if it does, or if this is unknown."""
    if not (through.connected and checked.connected):
        return True
    query = through.query(f"{checked.served}?{HEALTH}")
    try:
        while (answer := query.next(ANSWER_S)) is not None:
            if answer.error and answer.payload == HEALTHY:
                return True
    except TimeoutError:
        return True
    finally:
        query.close()
    return False
