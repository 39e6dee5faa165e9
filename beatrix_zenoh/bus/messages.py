"""The messages of a session: queries, queryables, publications, subscriptions.

Callbacks run on Zenoh's thread and must return at once; a slow callback would delay the whole session.
Publications have congestion control DROP, so that a subscriber that does not read does not delay the others.
"""

from __future__ import annotations

import contextlib
import time
from collections.abc import Callable

import zenoh

from beatrix_zenoh import threads
from beatrix_zenoh.bus.callbacks import direct
from beatrix_zenoh.bus.declarations import Declared, Publication, RenewableSession
from beatrix_zenoh.bus.incoming import Incoming, Received, subscribe_newest
from beatrix_zenoh.bus.query import QUERY_S, Query, priority_of
from beatrix_zenoh.contract._generated import keys

HEALTH = "_health"
"""Selector parameter of the session watchdog's queries; no request has a parameter that begins with _."""
HEALTHY = b"served"

QUERYABLE, PUBLISHER, SUBSCRIBER, TOKEN, WATCH = "queryable", "publisher", "subscriber", "token", "watch"
"""Kinds of declarations."""
REST = "rest"
"""Kind of the declaration of a queryable for the rest, which is no part of the description of a program."""
LATELY_S = 60.0
"""How long (s) a session remembers the key of a query or put."""
MOST_KEYS = 256
"""Largest number of keys of queries and puts that a session remembers."""


class MessageSession(RenewableSession):
    """A session that sends and serves queries, publishes and subscribes."""

    def __init__(self, open_session: Callable[[], zenoh.Session]) -> None:
        super().__init__(open_session)
        self._asked: dict[str, float] = {}

    @property
    def served(self) -> str:
        """A key that this session serves and its own account may query; empty: none."""
        with self._lock:
            first = next((made.key for made in self._made if made.kind == QUERYABLE), "")
        return _own_seat(first)

    def asked(self) -> list[str]:
        """Return the keys of the queries and puts of the last LATELY_S seconds, sorted."""
        since_s = time.monotonic() - LATELY_S
        return sorted(key for key, asked_s in self._asked.copy().items() if asked_s > since_s)

    def _ask(self, key: str) -> None:
        """Remember the key of a query or put; the oldest of MOST_KEYS is forgotten."""
        self._asked.pop(key, None)
        if len(self._asked) >= MOST_KEYS:
            self._asked.pop(next(iter(self._asked.copy())), None)
        self._asked[key] = time.monotonic()

    def query(
        self,
        key: str,
        payload: bytes | None = None,
        encoding: str | None = None,
        priority: str | None = None,
        timeout_s: float = QUERY_S,
        attachment: bytes | None = None,
    ) -> Query:
        """Send a query and return it; the caller reads its replies one by one and closes it.

        `priority` defaults to that of the key. No reply arrives after `timeout_s`.

        Raises:
            WrongUsage: SHUTDOWN, this session is closed.
        """
        plain, _, parameters = key.partition("?")
        if parameters != HEALTH:
            self._ask(plain)
        return self.use(
            lambda session: Query(session, key, payload, encoding, priority, timeout_s, attachment)
        )

    def serve(
        self, key: str, handle: Callable[[Incoming], None], skips: Callable[[str], bool] | None = None
    ) -> Callable[[], None]:
        """Pass queries on `key` to `handle`, and return a function that ends this.

        `handle` runs on Zenoh's thread and must return at once.

        With `skips`, `key` has wildcards: a query for whose key `skips` returns True is dropped, as those of the watchdog
        are: another queryable answers it, after this one, so it must cost little. The queryable is then not complete, so
        that a foreign complete one on these keys keeps receiving all its queries.
        """

        def receive(query: zenoh.Query) -> None:
            checks = str(query.parameters) == HEALTH
            if skips is not None and (checks or skips(str(query.key_expr))):
                return
            if checks:
                with contextlib.suppress(zenoh.ZError):
                    query.reply_err(HEALTHY)
                query.drop()
            else:
                handle(Incoming(query))

        def declare(session: zenoh.Session) -> Declared:
            return session.declare_queryable(key, direct(receive), complete=skips is None)

        return self.add(QUERYABLE if skips is None else REST, key, declare)

    def publication(
        self, key: str, encoding: str, on_subscribed: Callable[[], None] | None = None
    ) -> tuple[Publication, Callable[[], None]]:
        """Declare a publication; return it, and a function that ends it.

        `on_subscribed` is called when `Publication.subscribed` may have changed. It may run on Zenoh's thread and must
        return at once.
        """
        publication = Publication(key, encoding, on_subscribed)
        return publication, self.add(PUBLISHER, key, publication.declare)

    def subscribe(self, key: str, handle: Callable[[Received], None]) -> Callable[[], None]:
        """Pass publications on `key` to `handle`, and return a function that ends the subscription.

        `handle` runs on Zenoh's thread and must return at once. Raises the errors of `query`.
        """

        def receive(sample: zenoh.Sample) -> None:
            handle(Received.of(sample))

        return self.add(SUBSCRIBER, key, lambda session: session.declare_subscriber(key, direct(receive)))

    def subscribe_newest(
        self, key: str, handle: Callable[[Received], None], skips: Callable[[str], bool]
    ) -> Callable[[], None]:
        """As `subscribe`, but on a thread of its own, and in a flood only for the newest publications.

        A publication is dropped before it is read if `skips` returns True for its key: that costs little.
        """
        owner = threads.OWNER.get()

        def declare(session: zenoh.Session) -> Declared:
            with threads.owned_by(owner):  # the watchdog repeats this on its own thread
                return subscribe_newest(session, key, handle, skips)

        return self.add(SUBSCRIBER, key, declare)

    def put(
        self,
        key: str,
        payload: bytes,
        encoding: str,
        priority: str | None = None,
        attachment: bytes | None = None,
    ) -> None:
        """Publish once, with a `priority` as in `query`; raises the errors of `query`."""
        self._ask(key)
        self.use(
            lambda session: session.put(
                key,
                payload,
                encoding=encoding,
                attachment=attachment,
                priority=priority_of(key, priority),
                congestion_control=zenoh.CongestionControl.DROP,
                source_info=zenoh.SourceInfo(session.id, 0),
            )
        )


def _own_seat(key: str) -> str:
    """Return a key with the robot's name as the seat: the one seat under which a robot's account may query itself."""
    parts = keys.parse(key)
    return key if parts is None else key.replace("*", parts.robot)
