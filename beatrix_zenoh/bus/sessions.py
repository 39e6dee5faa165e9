"""The Zenoh sessions of a process, the watchdog that checks them, and the description of the program from their keys.

Each traffic class has a session, so that a flood in one class does not delay the others.
"""

from __future__ import annotations

import sys
import threading
from collections.abc import Callable, Iterable
from pathlib import Path

from beatrix_zenoh import threads
from beatrix_zenoh.bus.incoming import Incoming, Received
from beatrix_zenoh.bus.messages import HEALTH, HEALTHY, PUBLISHER, QUERYABLE, SUBSCRIBER
from beatrix_zenoh.bus.publication import Publication
from beatrix_zenoh.bus.session import Bus
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import ProgramInfo, Reason
from beatrix_zenoh.contract.errors import NoAnswer, WrongUsage

CONTROL = "control"
"""Traffic class of tokens, STOP and commands; its session is always open and is closed last."""


class Sessions:
    """The sessions by traffic class of keys.toml; Zenoh delivers all data of one session in order.

    The session of a class is opened when this process first serves, subscribes to or publishes a key of the class.
    """

    def __init__(self, connect: Callable[[], Bus]) -> None:
        """Open the control session; raises the errors of `connect` (NoAnswer: no router)."""
        self._connect = connect
        self._lock = threading.Lock()
        self._open: dict[str, Bus] = {CONTROL: connect()}

    @property
    def control(self) -> Bus:
        """The control session."""
        return self._open[CONTROL]

    def session(self, traffic: str) -> Bus:
        """Return the session of a traffic class, opened if necessary; raises the errors of `connect`."""
        with self._lock:
            if traffic not in self._open:
                self._open[traffic] = self._connect()
            return self._open[traffic]

    def opened(self) -> dict[str, Bus]:
        """Return the open sessions by traffic class."""
        with self._lock:
            return dict(self._open)

    def serve(self, key: str, handle: Callable[[Incoming], None]) -> None:
        """Pass queries on `key`, a key of keys.toml, to `handle`, as `Bus.serve` does."""
        self.session(_row(key).session).serve(key, handle)

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
        return self.session(_row(key).publish).publication(key, encoding, on_subscribed)

    def describe(self, side: str) -> ProgramInfo:
        """Return the description of the node that owns these sessions."""
        return describe(self.opened().values(), side)

    def close(self) -> None:
        """Close all sessions, the control session last. May be called twice."""
        for traffic, bus in sorted(self.opened().items(), key=lambda entry: entry[0] == CONTROL):
            bus.close()
            if traffic != CONTROL:
                del self._open[traffic]


def _row(key: str) -> keys.KeyRow:
    parts = keys.parse(key)
    if parts is None:
        raise ValueError(f"{key!r} is not a key of schemas/keys.toml")
    return keys.KEYS[parts.row]


PERIOD_S = 1.0
ANSWER_S = 1.0
FAILURES = 2
"""Failed checks in a row before a session is renewed; just after a reconnection one check may fail."""


class SessionWatchdog:
    """A thread that replaces a session whose queryables the router has lost.

    If the router disconnects a session under a flood of messages, Zenoh 1.10 reconnects it without its declarations in
    about one case in ten. The session is then open, but the router delivers no query to it. `renewed` is called with
    the traffic class, on the watchdog's thread.

    If the router is back after a loss and refuses the account, or has no rules for it, `refused` is called once on the
    same thread, because Zenoh tries to connect for ever, or drops all messages, and reports nothing.
    """

    def __init__(
        self,
        sessions: Sessions,
        token: str,
        renewed: Callable[[str], None],
        refused: Callable[[NoAnswer], None],
    ) -> None:
        """Start the thread; `token` is one that the control session has declared."""
        self._sessions, self._renewed, self._refused = sessions, renewed, refused
        self._token, self._without_rights = token, False
        self._refusals = 0
        self._failures: dict[str, int] = {}
        self._closed = threading.Event()
        self._thread = threads.start(self._run, "watchdog")

    def _run(self) -> None:
        while not self._closed.wait(PERIOD_S):
            opened = self._sessions.opened()
            for traffic, checked in opened.items():
                others = [bus for bus in opened.values() if bus is not checked]
                if others and checked.served and not self._closed.is_set():
                    self._check(traffic, checked, others[0])
            if not self._closed.is_set():
                self._check_account(self._sessions.control)

    def _check(self, traffic: str, checked: Bus, through: Bus) -> None:
        failed = not reached(checked, through)
        self._failures[traffic] = self._failures.get(traffic, 0) + 1 if failed else 0
        if self._failures[traffic] < FAILURES:
            return
        self._failures[traffic] = 0
        control = self._sessions.control
        if self._without_rights and checked is not control:
            return
        try:
            checked.renew()
        except NoAnswer:
            return  # the router has just been lost; the old session remains
        except WrongUsage:
            return  # the node closes
        error = control.refusal(self._token) if checked is control else None
        if error is None:
            self._without_rights = False
            self._renewed(traffic)
        elif not self._without_rights:
            self._without_rights = True
            self._refused(error)

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

    def close(self) -> None:
        """End the watchdog's thread."""
        self._closed.set()
        self._thread.join(timeout=3 * ANSWER_S)


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


COMMAND_LINES = ("beatrix", "beatrix.exe", "cli")
"""Names of programs whose first argument is a verb; `cli`: `python -m beatrix_zenoh.cli`."""


def describe(sessions: Iterable[Bus], side: str = "") -> ProgramInfo:
    """Return the description of this program; `side` is that of a node. Fast enough for Zenoh's threads."""
    buses = list(sessions)

    def declared(kind: str) -> list[str]:
        return sorted({key for bus in buses for key in bus.declared(kind)})

    return ProgramInfo(
        program=program_name(sys.argv),
        side=side,
        serves=[key for key in declared(QUERYABLE) if not _is_description(key)],
        publishes=declared(PUBLISHER),
        subscribes=declared(SUBSCRIBER),
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
