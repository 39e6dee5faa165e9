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


class Sessions:
    """The sessions of a node by traffic class of keys.toml; Zenoh delivers all data of one session in order.

    The session of a class is opened when the node first serves, subscribes to or publishes a key of the class. Several
    nodes of one process share the session of MEDIA.
    """

    def __init__(self, connect: Callable[[], Bus], shared: Sessions | None = None) -> None:
        """Open the control session; raises the errors of `connect` (NoAnswer: no router).

        `shared` are those of a process with several nodes.
        """
        self.connect, self._shared = connect, shared
        self._lock, self._closing = threading.Lock(), threading.Lock()
        self._open: dict[str, Bus] = {CONTROL: connect()}
        self._published: dict[str, Callable[[], None]] = {}
        """The function that ends each publication in the shared session, by key."""

    @property
    def control(self) -> Bus:
        """The control session."""
        return self._open[CONTROL]

    def session(self, traffic: str) -> Bus:
        """Return the session of a traffic class, opened if necessary; raises the errors of `connect`."""
        if traffic == MEDIA and self._shared is not None:
            return self._shared.session(traffic)
        with self._lock:
            if traffic not in self._open:
                self._open[traffic] = self.connect()
            return self._open[traffic]

    def opened(self) -> dict[str, Bus]:
        """Return the open sessions of this node alone by traffic class, the control session first."""
        with self._lock:
            return dict(self._open)

    def serve(self, key: str, handle: Callable[[Incoming], None]) -> None:
        """Pass queries on `key`, a key of keys.toml, to `handle`, as `Bus.serve` does."""
        self.session(_row(key).session).serve(key, handle)

    def subscribe(self, key: str, handle: Callable[[Received], None]) -> Callable[[], None]:
        """Pass publications on `key` to `handle`, as `Bus.subscribe` does."""
        return self.session(_row(key).session).subscribe(key, handle)

    def publication(
        self, key: str, encoding: str, on_subscribed: Callable[[], None] | None = None
    ) -> Publication:
        """Declare a publication, as `Bus.publication` does."""
        traffic = _row(key).publish
        publication, end = self.session(traffic).publication(key, encoding, on_subscribed)
        if traffic == MEDIA and self._shared is not None:
            self._published[key] = end
        return publication

    def watch_sessions(
        self, renewed: Callable[[str], None], refused: Callable[[NoAnswer], None]
    ) -> Callable[[], None]:
        """Watch the sessions, as `SessionWatchdog` does; return a function that ends this, before `close`."""
        return SessionWatchdog(self.opened, renewed, refused, in_turn=self._shared is not None).close

    def describe(self, side: str) -> ProgramInfo:
        """Return the description of the node that uses these sessions."""
        return describe(self.opened().values(), side, [*self._published])

    def close(self) -> None:
        """Close all sessions, the control session last. May be called twice; the second call waits for the first."""
        with self._closing:
            for traffic, bus in sorted(self.opened().items(), key=lambda entry: entry[0] == CONTROL):
                bus.close()
                if traffic != CONTROL:
                    del self._open[traffic]
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
PERIOD_S, TURN_S = 1.0, 10.0
"""Time (s) between checks of all sessions, and between those of one session where many nodes share a process."""
ANSWER_S = 1.0
FAILURES = 2
"""Failed checks in a row before a session is renewed; just after a reconnection one check may fail."""


class SessionWatchdog:
    """A thread of a node that replaces a session whose queryables the router has lost.

    If the router disconnects a session under a flood of messages, Zenoh 1.10 reconnects it without its declarations in
    about one case in ten. The session is then open, but the router delivers no query to it.

    If the router is back after a loss and refuses the account, it reports that once, because Zenoh tries to connect for
    ever and reports nothing.
    """

    def __init__(
        self,
        opened: Callable[[], dict[str, Bus]],
        renewed: Callable[[str], None],
        refused: Callable[[NoAnswer], None],
        *,
        in_turn: bool,
    ) -> None:
        """Watch on a thread of its own.

        Args:
            opened: returns the sessions by traffic class, the control session first.
            renewed: called with the traffic class of a session that was replaced.
            refused: called when the router refuses the account.
            in_turn: check one of them every TURN_S, because a process with many nodes may have a hundred.
        """
        self._opened, self._renewed, self._refused, self._in_turn = opened, renewed, refused, in_turn
        self._ended = threading.Event()
        self._refusals = 0
        self._failures: weakref.WeakKeyDictionary[Bus, int] = weakref.WeakKeyDictionary()
        self._thread = threads.start(self._run, "watchdog")

    def close(self) -> None:
        """End the reports."""
        self._ended.set()
        self._thread.join(timeout=3 * ANSWER_S)

    def _run(self) -> None:
        for turn in itertools.count():
            if self._ended.wait(TURN_S if self._in_turn else PERIOD_S):
                return
            opened = list(self._opened().items())
            control = opened[0][1]
            for traffic, checked in opened[turn % len(opened) :][:1] if self._in_turn else opened:
                through = next((bus for _, bus in opened[1:]), None) if checked is control else control
                if through is not None and not self._ended.is_set():
                    self._check(traffic, checked, through)
            if not self._ended.is_set():
                self._check_account(control)

    def _check(self, traffic: str, checked: Bus, through: Bus) -> None:
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
        self._renewed(traffic)

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
                self._refused(error)


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
