"""A session: queries, queryables, publications, subscriptions, liveliness tokens.

Callbacks run on Zenoh's thread and must return at once; a slow callback would delay the whole session.
Publications have congestion control DROP, so that a subscriber that does not read does not delay the others.
"""

from __future__ import annotations

import contextlib
import datetime as dt
import time
from collections.abc import Callable, Iterator
from functools import cached_property
from typing import Self

import msgspec
import zenoh
from zenoh.handlers import Callback

from beatrix_zenoh._generated import keys
from beatrix_zenoh._generated.messages import Reason
from beatrix_zenoh.account import Account
from beatrix_zenoh.bus import credentials
from beatrix_zenoh.bus.endpoint import endpoints, parse_endpoint, probe
from beatrix_zenoh.bus.query import PRIORITIES, QUERY_S, Query, priority_of
from beatrix_zenoh.bus.query_forms import RawQuery
from beatrix_zenoh.bus.transport import OPEN_MS, opened
from beatrix_zenoh.errors import NoAnswer, WrongUsage

HEALTH = "_health"
"""Selector parameter of the session watchdog's queries; no request has a parameter that begins with _."""
HEALTHY = b"served"
CLOSED = "This connection was closed by this program: create a new Robot, or send requests before close()."

PASSES_S = 0.5
"""Time (s) for the router to report the tokens of a new session."""
POLL_S = 0.02
CONGESTION = {"drop": zenoh.CongestionControl.DROP, "block": zenoh.CongestionControl.BLOCK}


class Incoming:
    """A query to answer; call `finish` at the end, because otherwise the client waits until its timeout."""

    def __init__(self, query: zenoh.Query) -> None:
        # Only the key is read here, because in a flood of queries newer ones replace most of them before decoding.
        self._query = query
        self.key = str(query.key_expr)

    @cached_property
    def raw(self) -> RawQuery:
        """Payload, encoding and parameters; the first access must come before `finish`."""
        payload, encoding = self._query.payload, self._query.encoding
        return RawQuery(
            payload=b"" if payload is None else payload.to_bytes(),
            encoding="" if encoding is None else str(encoding),
            parameters=str(self._query.parameters),
        )

    @property
    def session(self) -> str:
        """Id of the client's session; empty if the query has no source info."""
        source = self._query.source_info
        return "" if source is None else str(source.source_id.zid)

    def reply(self, key: str, payload: bytes, encoding: str) -> None:
        """Send one reply on `key`, the robot's own; raises no error if the client has gone."""
        with contextlib.suppress(zenoh.ZError):
            self._query.reply(key, payload, encoding=encoding)

    def finish(self) -> None:
        """End the replies to this query."""
        self._query.drop()


class Received(msgspec.Struct, frozen=True, gc=False):
    """A received publication."""

    key: str
    payload: bytes
    session: str
    """id of the publisher's session; empty if unknown"""
    attachment: bytes | None


class Publication:
    """A declared publisher, with the priority and congestion control of its row in keys.toml."""

    def __init__(self, key: str, encoding: str, on_subscribed: Callable[[], None] | None = None) -> None:
        self._key, self._encoding, self._on_subscribed = key, encoding, on_subscribed
        self._publisher: zenoh.Publisher

    def declare(self, session: zenoh.Session) -> object:
        """Declare the publisher on a session, in place of the publisher of an earlier session."""
        parts = keys.parse(self._key)
        row = None if parts is None else keys.KEYS[parts.row]
        self._publisher = session.declare_publisher(
            self._key,
            encoding=self._encoding,
            priority=PRIORITIES["data" if row is None else row.priority],
            congestion_control=CONGESTION["drop" if row is None else row.congestion],
        )
        on_subscribed = self._on_subscribed
        if on_subscribed is not None:
            # The listener ends with its publisher. Zenoh does not call a new one if the key has no subscribers, so call
            # `on_subscribed` here.
            changed: Callback[zenoh.MatchingStatus] = Callback(lambda _: on_subscribed(), indirect=False)
            self._publisher.declare_matching_listener(changed)
            on_subscribed()
        return self._publisher

    @property
    def subscribed(self) -> bool:
        """Whether any client subscribes to this publication."""
        return bool(self._publisher.matching_status.matching)  # type: ignore[attr-defined]  # the stub says bool

    def put(self, payload: bytes, attachment: bytes | None = None) -> None:
        """Publish; Zenoh drops the message for a subscriber that cannot keep up."""
        with contextlib.suppress(zenoh.ZError):  # the session may be closing
            self._publisher.put(payload, attachment=attachment)


class Bus:
    """One Zenoh session: a client of an explicit router, without discovery and shared memory."""

    def __init__(self, open_session: Callable[[], zenoh.Session], endpoint: str) -> None:
        self._open_session = open_session
        self._session = open_session()
        self._declarations: list[Callable[[zenoh.Session], object]] = []
        self._declared: list[object] = []
        self._tokens: dict[str, zenoh.LivelinessToken] = {}
        self.served = ""
        """A key that this session serves; empty: none."""
        self.endpoint = endpoint
        self.session_id = str(self._session.zid())

    def _declare(self, declaration: Callable[[zenoh.Session], object]) -> Callable[[], None]:
        """Declare now and in every renewed session; return a function that ends the declaration."""
        with self._open() as session:
            self._declared.append(declaration(session))
        self._declarations.append(declaration)

        def undeclare() -> None:
            if declaration not in self._declarations:
                return  # it was called before, or the session is closed
            index = self._declarations.index(declaration)
            del self._declarations[index]
            with contextlib.suppress(zenoh.ZError):  # the session may be closing
                self._declared.pop(index).undeclare()  # type: ignore[attr-defined]  # every declaration has it

        return undeclare

    def renew(self) -> None:
        """Open a new session in place of this one and repeat all declarations.

        Queries of the old session that are not answered yet get no reply. If this raises NoAnswer, as `connect` does,
        the old session remains.
        """
        old, self._session = self._session, self._open_session()
        self._declared = [declaration(self._session) for declaration in self._declarations]
        self._tokens = {key: self._session.liveliness().declare_token(key) for key in self._tokens}
        old.close()

    # -- queries --------------------------------------------------------------------------------

    @property
    def closed(self) -> bool:
        """Whether this program has closed the session."""
        return self._session.is_closed()

    @contextlib.contextmanager
    def _open(self) -> Iterator[zenoh.Session]:
        """Yield the session; raise WrongUsage (SHUTDOWN) if this program has closed it or closes it meanwhile."""
        if self.closed:
            raise WrongUsage(Reason.SHUTDOWN, CLOSED)
        try:
            yield self._session
        except zenoh.ZError as error:
            if not self.closed:
                raise
            raise WrongUsage(Reason.SHUTDOWN, CLOSED) from error

    def query(
        self,
        key: str,
        payload: bytes | None = None,
        encoding: str | None = None,
        priority: str | None = None,
        timeout_s: float = QUERY_S,
    ) -> Query:
        """Send a query and return it; the caller reads its replies one by one and closes it.

        `priority` defaults to that of the key. No reply arrives after `timeout_s`.

        Raises:
            WrongUsage: SHUTDOWN, this session is closed.
        """
        with self._open() as session:
            return Query(session, key, payload, encoding, priority, timeout_s)

    # -- serving --------------------------------------------------------------------------------

    def serve(self, key: str, handle: Callable[[Incoming], None]) -> None:
        """Pass queries on `key` to `handle`, which runs on Zenoh's thread and must return at once."""

        def receive(query: zenoh.Query) -> None:
            if str(query.parameters) == HEALTH:
                with contextlib.suppress(zenoh.ZError):
                    query.reply_err(HEALTHY)
                query.drop()
            else:
                handle(Incoming(query))

        def declare(session: zenoh.Session) -> object:
            return session.declare_queryable(key, Callback(receive, indirect=False), complete=True)

        self.served = self.served or key
        self._declare(declare)

    def publication(
        self, key: str, encoding: str, on_subscribed: Callable[[], None] | None = None
    ) -> Publication:
        """Declare a publication.

        `on_subscribed` is called when `Publication.subscribed` may have changed. It may run on Zenoh's thread and must
        return at once.
        """
        publication = Publication(key, encoding, on_subscribed)
        self._declare(publication.declare)
        return publication

    def subscribe(self, key: str, handle: Callable[[Received], None]) -> Callable[[], None]:
        """Pass publications on `key` to `handle`, and return a function that ends the subscription.

        `handle` runs on Zenoh's thread and must return at once. Raises the errors of `query`.
        """

        def receive(sample: zenoh.Sample) -> None:
            source, attachment = sample.source_info, sample.attachment
            handle(
                Received(
                    str(sample.key_expr),
                    sample.payload.to_bytes(),
                    "" if source is None else str(source.source_id.zid),
                    None if attachment is None else attachment.to_bytes(),
                )
            )

        return self._declare(
            lambda session: session.declare_subscriber(key, Callback(receive, indirect=False))
        )

    def put(self, key: str, payload: bytes, encoding: str, priority: str | None = None) -> None:
        """Publish once, with a `priority` as in `query`; raises the errors of `query`."""
        with self._open() as session:
            session.put(
                key,
                payload,
                encoding=encoding,
                priority=priority_of(key, priority),
                congestion_control=zenoh.CongestionControl.DROP,
                source_info=zenoh.SourceInfo(session.id, 0),
            )

    # -- liveliness tokens ----------------------------------------------------------------------

    def declare_token(self, key: str) -> None:
        """Declare a liveliness token, which disappears when this session ends for any reason."""
        self._tokens[key] = self._session.liveliness().declare_token(key)

    def undeclare_token(self, key: str) -> None:
        """Undeclare a token of this session."""
        self._tokens.pop(key).undeclare()

    def tokens(self, key: str, timeout_s: float = 1.0) -> list[str]:
        """Return the keys of the live tokens that match; raises the errors of `query`."""
        with self._open() as session:
            replies = list(session.liveliness().get(key, timeout=timeout_s))
        return sorted(str(reply.ok.key_expr) for reply in replies if reply.ok is not None)

    def router_answers(self, timeout_s: float) -> bool:
        """Return whether the router answers a query about tokens within `timeout_s` (s)."""
        begin = time.monotonic()
        return (
            self.connected
            and self.tokens(keys.claim("*", "*", "none"), timeout_s) == []
            and (time.monotonic() - begin < timeout_s)
        )

    def router_passes(self, token: str) -> bool:
        """Return whether the router has accepted a token of this session and reports tokens to this session.

        Zenoh returns a session's own token twice, from the session itself and from the router. In the first
        milliseconds of a session the router may not return it yet, so this method tries for PASSES_S.
        """
        deadline_s = time.monotonic() + PASSES_S
        while len(self.tokens(token)) <= 1:
            if time.monotonic() > deadline_s:
                return False
            time.sleep(POLL_S)
        return True

    def watch_tokens(self, key: str, handle: Callable[[str, bool], None]) -> Callable[[], None]:
        """Report tokens that appear or disappear, first the existing ones; return a function that ends the reports.

        `handle(key, alive)` runs on Zenoh's thread and must return at once.
        """

        def receive(sample: zenoh.Sample) -> None:
            handle(str(sample.key_expr), sample.kind == zenoh.SampleKind.PUT)

        return self._declare(
            lambda session: session.liveliness().declare_subscriber(
                key, Callback(receive, indirect=False), history=True
            )
        )

    def watch_router(self, handle: Callable[[bool], None]) -> None:
        """Call `handle(connected)` when the router connects or disconnects, and once if it is connected now."""

        def receive(event: zenoh.TransportEvent) -> None:
            handle(event.kind == zenoh.SampleKind.PUT)

        self._declare(
            lambda session: session.info.declare_transport_events_listener(
                Callback(receive, indirect=False), history=True
            )
        )

    @property
    def connected(self) -> bool:
        """Whether a router is connected; false after `close`."""
        return not self.closed and bool(self._session.info.routers_zid())

    def connection_error(self) -> NoAnswer | None:
        """Try to open another session with the same account; return the error, or None if the router accepts it."""
        try:
            self._open_session().close()
        except NoAnswer as error:
            return error
        return None

    def robots(self, timeout_s: float = 1.0) -> list[tuple[str, str]]:
        """Return name and twin of every robot on line."""
        return _places(self.tokens(keys.alive(robot="*", twin="*"), timeout_s))

    def claims(self) -> list[tuple[str, str]]:
        """Return name and twin of every node that serves or starts; in joined networks one robot may occur twice."""
        return _places(self.tokens(keys.claim(robot="*", twin="*", session="*")))

    def close(self) -> None:
        """Close the session and all its declarations; may be called twice."""
        self._declared.clear()
        self._declarations.clear()
        self._tokens.clear()
        self._session.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exc: object) -> None:
        self.close()


def frozen_router(endpoint: str) -> str:
    """Return the message about a router that accepts connections and does not answer."""
    return (
        f"The router at {endpoint} does not answer: it hangs or is very busy. Robots stop by themselves within 3 s "
        "of losing their router."
    )


def _places(tokens: list[str]) -> list[tuple[str, str]]:
    """Return name and twin from the key of each token."""
    found = [keys.parse(token) for token in tokens]
    return [(parts.robot, parts.twin) for parts in found if parts is not None]


def connect(endpoint: str, *, label: str = "", account: Account | None = None) -> Bus:
    """Open a session as a client of the router at an endpoint such as `tcp/127.0.0.1:7447`, or at one of several.

    Raises:
        NoAnswer: NO_ROUTER or ACCOUNT_REFUSED, with what to do.
        WrongUsage: BAD_VALUE, `endpoint` or ZENOH_RUNTIME is invalid, or the certificate of the account has expired.
    """
    for one in endpoints(endpoint):
        parse_endpoint(one)
    if account is not None:
        account.check_time(dt.datetime.now().astimezone().date())
    settings = {
        "mode": "client",
        "connect/endpoints": endpoints(endpoint),
        "connect/timeout_ms": 0,
        "connect/retry": {"period_init_ms": 50, "period_max_ms": 500, "period_increase_factor": 2},
        "scouting/gossip/enabled": False,
        "metadata": {"name": label},
        **credentials.settings(account),
    }

    def check_listening() -> None:
        try:
            probe(endpoint)
        except NoAnswer as error:
            raise credentials.no_router(error, account) from error

    def open_session() -> zenoh.Session:
        check_listening()
        begin = time.monotonic()
        try:
            return opened(settings, lambda: credentials.refusal(endpoint, account), Reason.ACCOUNT_REFUSED)
        except NoAnswer as error:
            check_listening()  # a router that shuts down did not refuse the account: report it as lost
            if time.monotonic() - begin < OPEN_MS / 1e3 * 0.9:
                raise
            plain = account is not None and not account.password
            other = (
                " Or it does not use certificates: it serves no class, or a class with passwords."
                if plain
                else ""
            )
            raise NoAnswer(Reason.NO_ROUTER, frozen_router(endpoint) + other) from error

    return Bus(open_session, endpoint)
