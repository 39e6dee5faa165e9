"""A Zenoh session that can be replaced, and its declarations, which are repeated in the new session, with publishers."""

from __future__ import annotations

import contextlib
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final, Protocol, Self, TypeVar

import zenoh

from beatrix_zenoh.bus.at_exit import OPEN
from beatrix_zenoh.bus.callbacks import direct
from beatrix_zenoh.bus.forks import ProcessBound
from beatrix_zenoh.bus.query import priority_of
from beatrix_zenoh.bus.transport import closed
from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.errors import WrongUsage

CLOSED = "This connection was closed by this program: create a new Robot, or send requests before close()."
MATCHING_S: Final = 1.0
"""Age (s) at which the answer of Zenoh about subscribers is renewed, even if Zenoh has reported no change."""
T = TypeVar("T")


class Declared(Protocol):
    """What Zenoh returns for a declaration."""

    def undeclare(self) -> object: ...


@dataclass(frozen=True, eq=False)
class Declaration:
    """One declaration: what it declares, such as `queryable`, its key, and the function that declares it."""

    kind: str
    key: str
    make: Callable[[zenoh.Session], Declared]


class RenewableSession(ProcessBound):
    """A session and its declarations; several threads may declare, end declarations, renew and close at once.

    The lock protects the session and the dictionary of declarations. No call of Zenoh, and no deletion of an object of
    Zenoh, runs under it: Zenoh may run a callback in the calling thread or wait for a callback, and callbacks may
    declare.
    """

    def __init__(self, open_session: Callable[[], zenoh.Session]) -> None:
        """Open the session; raises the errors of `open_session`."""
        self._open_session = open_session
        self._session = open_session()
        self._lock = threading.Lock()
        self._renewal = threading.Lock()
        self._made: dict[Declaration, Declared] = {}
        self.closed = False
        """Whether this program has closed the session."""
        OPEN.add(self)

    def use(self, do: Callable[[zenoh.Session], T]) -> T:
        """Return the result of `do`, which is called again if the session was replaced meanwhile.

        Raises:
            WrongUsage: SHUTDOWN, this program has closed the session or closes it meanwhile.
        """
        while True:
            session = self._session
            try:
                with OPEN.call():
                    if self.closed:
                        raise WrongUsage(Reason.SHUTDOWN, CLOSED)
                    return do(session)
            except zenoh.ZError:
                if session is self._session and not self.closed:
                    raise

    def add(self, kind: str, key: str, make: Callable[[zenoh.Session], Declared]) -> Callable[[], None]:
        """Declare now and in every renewed session; return a function that ends the declaration.

        `make` declares in a session. Raises the errors of `use`.
        """
        declaration = Declaration(kind, key, make)
        while True:
            session, made = self.use(lambda session: (session, make(session)))
            with self._lock:
                present = session is self._session and not self.closed
                if present:
                    self._made[declaration] = made
            if present:
                return lambda: self._end(declaration)
            _undeclare(made)  # the session was replaced or closed before the declaration was recorded

    def _end(self, declaration: Declaration) -> None:
        with self._lock:
            made = self._made.pop(declaration, None)
        if made is not None:
            _undeclare(made)

    def renew(self) -> None:
        """Open a new session in place of this one and repeat all declarations.

        Queries of the old session that are not answered yet get no reply. Raises the errors of `open_session`, for
        example NoAnswer, and then the old session remains; and those of `use`.
        """
        with self._renewal, OPEN.call():
            new = self._open_session()
            with self._lock:
                old, repeated = self._session, list(self._made)
                if not self.closed:
                    self._session = new
            if self._session is not new:
                closed(new)
                raise WrongUsage(Reason.SHUTDOWN, CLOSED)
            try:
                for declaration in repeated:
                    self._repeat(declaration, new)
            finally:
                closed(old)

    def _repeat(self, declaration: Declaration, session: zenoh.Session) -> None:
        try:
            made = declaration.make(session)
        except zenoh.ZError as error:
            if not self.closed:
                raise
            raise WrongUsage(Reason.SHUTDOWN, CLOSED) from error
        with self._lock:
            former = self._made.get(declaration)
            if former is not None:
                self._made[declaration] = made
        if former is None:  # it has ended meanwhile
            _undeclare(made)

    def declared(self, kind: str) -> list[str]:
        """Return the keys of all declarations of one kind (such as QUERYABLE), sorted, each once."""
        with self._lock:
            return sorted({declaration.key for declaration in self._made if declaration.kind == kind})

    def objects(self) -> object:
        """Return the session and its declarations, for the exit of a program that has no time to close them."""
        with self._lock:
            return self._session, self._made

    def close(self) -> None:
        """Close the session with all declarations; may be called twice. Does nothing in a forked child."""
        if self._inherited:
            return
        with self._lock:
            self.closed = True
            session, made, self._made = self._session, self._made, {}
        closed(session)  # a router that hangs notices the end by itself
        made.clear()
        OPEN.discard(self)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exc: object) -> None:
        self.close()


def _undeclare(made: Declared) -> None:
    with contextlib.suppress(zenoh.ZError, WrongUsage), OPEN.call():  # the session may be closing
        made.undeclare()


class Publication:
    """A declared publisher, with the priority and congestion control of its row in keys.toml."""

    def __init__(self, key: str, encoding: str, on_subscribed: Callable[[], None] | None = None) -> None:
        self._key, self._encoding, self._on_subscribed = key, encoding, on_subscribed
        self._publisher: zenoh.Publisher
        self._matching = False
        self._read_s = float("-inf")
        """Time (s, monotonic) at which `_matching` was read; -inf: read it again."""
        self._reading = threading.Lock()
        """Held while Zenoh is asked: a thread that a change has woken must not get the answer from before."""

    def declare(self, session: zenoh.Session) -> zenoh.Publisher:
        """Declare the publisher on a session, in place of the publisher of an earlier session."""
        self._publisher = session.declare_publisher(
            self._key,
            encoding=self._encoding,
            priority=priority_of(self._key),
            congestion_control=zenoh.CongestionControl.DROP,
        )
        # The listener ends with its publisher. Zenoh does not call a new one if the key has no subscribers, so call
        # `_changed` here.
        self._publisher.declare_matching_listener(direct(self._on_matching))
        self._changed()
        return self._publisher

    def _on_matching(self, _: zenoh.MatchingStatus) -> None:
        self._changed()

    def _changed(self) -> None:
        self._read_s = float("-inf")
        if self._on_subscribed is not None:
            self._on_subscribed()

    @property
    def subscribed(self) -> bool:
        """Whether any client subscribes to this publication."""
        with self._reading:
            now_s = time.monotonic()
            if now_s - self._read_s > MATCHING_S:
                self._read_s = now_s  # before the call, because a change may be reported during it
                self._matching = bool(self._publisher.matching_status.matching)  # type: ignore[attr-defined]  # the stub says bool
            return self._matching

    def put(self, payload: bytes, attachment: bytes | None = None) -> None:
        """Publish; Zenoh drops the message for a subscriber that cannot keep up."""
        with contextlib.suppress(zenoh.ZError, WrongUsage), OPEN.call():  # the session may be closing
            self._publisher.put(payload, attachment=attachment)
