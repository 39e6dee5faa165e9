"""A session: open, ask, serve, publish, watch presence, close.

Every callback runs on Zenoh's own thread and only hands over; a slow one would stop the
whole session. Congestion control is DROP everywhere: one frozen listener must not hold
up the others.
"""

from __future__ import annotations

import contextlib
import time
from collections.abc import Callable, Iterator
from functools import cached_property
from typing import Self

import zenoh
from zenoh.handlers import Callback

from beatrix_zenoh._generated import keys
from beatrix_zenoh._generated.messages import Reason
from beatrix_zenoh.bus.endpoint import parts, probe
from beatrix_zenoh.bus.question import PRIORITIES, Answer, Question
from beatrix_zenoh.bus.transport import opened
from beatrix_zenoh.errors import WrongUsage
from beatrix_zenoh.requests import Wording

CLOSED = "This connection was closed by this program: make a new Robot, or ask before close()."


class Incoming:
    """A query to be answered; must end with `finish`, or the asker waits until its timeout."""

    def __init__(self, query: zenoh.Query) -> None:
        # Read nothing else yet: in a flood most queries are replaced before anybody looks at them.
        self._query = query
        self.key = str(query.key_expr)

    @cached_property
    def wording(self) -> Wording:
        """What is asked; the first look at it must come before `finish`."""
        payload, encoding = self._query.payload, self._query.encoding
        return Wording(
            payload=b"" if payload is None else payload.to_bytes(),
            encoding="" if encoding is None else str(encoding),
            parameters=str(self._query.parameters),
        )

    @property
    def session(self) -> str:
        """Session of the asker, empty for clients that do not say."""
        source = self._query.source_info
        return "" if source is None else str(source.source_id.zid)

    def reply(self, key: str, payload: bytes, encoding: str) -> None:
        """Send one reply on the answerer's own concrete key; an asker who has gone is no error."""
        with contextlib.suppress(zenoh.ZError):
            self._query.reply(key, payload, encoding=encoding)

    def finish(self) -> None:
        """Tell the asker that no more will come."""
        self._query.drop()


class Publication:
    """A declared publisher."""

    def __init__(self, key: str, encoding: str, priority: str) -> None:
        self._key, self._encoding, self._priority = key, encoding, priority
        self._publisher: zenoh.Publisher

    def declare(self, session: zenoh.Session) -> object:
        """Publish through this session from now on."""
        self._publisher = session.declare_publisher(
            self._key,
            encoding=self._encoding,
            priority=PRIORITIES[self._priority],
            congestion_control=zenoh.CongestionControl.DROP,
        )
        return self._publisher

    @property
    def watched(self) -> bool:
        """Somebody subscribes to it."""
        return bool(self._publisher.matching_status.matching)  # type: ignore[attr-defined]  # the stub says bool

    def put(self, payload: bytes) -> None:
        """Publish; dropped for whoever cannot keep up."""
        with contextlib.suppress(zenoh.ZError):  # the session may be closing
            self._publisher.put(payload)


class Bus:
    """One Zenoh session: a client of an explicit router, no discovery, no shared memory."""

    def __init__(self, open_session: Callable[[], zenoh.Session], endpoint: str) -> None:
        self._open_session = open_session
        self._session = open_session()
        self._recipes: list[Callable[[zenoh.Session], object]] = []
        self._declared: list[object] = []
        self._tokens: dict[str, zenoh.LivelinessToken] = {}
        self.endpoint = endpoint
        self.session_id = str(self._session.zid())

    def _declare(self, recipe: Callable[[zenoh.Session], object]) -> None:
        self._recipes.append(recipe)
        self._declared.append(recipe(self._session))

    def renew(self) -> None:
        """Put a new session in the place of this one and declare everything again.

        What was asked through the old one, and not answered, never will be. Raises NoAnswer as `connect`;
        then the old session stays.
        """
        old, self._session = self._session, self._open_session()
        self._declared = [recipe(self._session) for recipe in self._recipes]
        self._tokens = {key: self._session.liveliness().declare_token(key) for key in self._tokens}
        old.close()

    # -- asking ---------------------------------------------------------------------------------

    def question(
        self, key: str, payload: bytes | None = None, encoding: str | None = None, priority: str = "data"
    ) -> Question:
        """Ask and collect replies one by one; close the question afterwards.

        Raises:
            WrongUsage: SHUTDOWN, this session was closed.
        """
        if self._session.is_closed():
            raise WrongUsage(Reason.SHUTDOWN, CLOSED)
        return Question(self._session, key, payload, encoding, priority)

    def answers(self, key: str, timeout_s: float, payload: bytes | None = None) -> Iterator[Answer]:
        """All good replies to a (wildcard) key within `timeout_s`."""
        deadline = time.monotonic() + timeout_s
        question = self.question(key, payload)
        try:
            while (answer := question.next(deadline - time.monotonic())) is not None:
                if not answer.error:
                    yield answer
        except TimeoutError:
            return
        finally:
            question.close()

    # -- serving --------------------------------------------------------------------------------

    def serve(self, key: str, handle: Callable[[Incoming], None]) -> None:
        """Answer queries on `key`; `handle` runs on Zenoh's thread and must only hand over."""

        def declare(session: zenoh.Session) -> object:
            callback: Callback[zenoh.Query] = Callback(lambda query: handle(Incoming(query)), indirect=False)
            return session.declare_queryable(key, callback, complete=True)

        self._declare(declare)

    def publication(self, key: str, encoding: str, priority: str = "data") -> Publication:
        """Declare a publication."""
        publication = Publication(key, encoding, priority)
        self._declare(publication.declare)
        return publication

    def subscribe(self, key: str, handle: Callable[[str, bytes], None]) -> None:
        """Hear publications: `handle(key, payload)` runs on Zenoh's thread and must only hand over."""

        def receive(sample: zenoh.Sample) -> None:
            handle(str(sample.key_expr), sample.payload.to_bytes())

        self._declare(lambda session: session.declare_subscriber(key, Callback(receive, indirect=False)))

    def put(self, key: str, payload: bytes, encoding: str, priority: str = "data") -> None:
        """Publish once."""
        self._session.put(
            key,
            payload,
            encoding=encoding,
            priority=PRIORITIES[priority],
            congestion_control=zenoh.CongestionControl.DROP,
        )

    # -- presence -------------------------------------------------------------------------------

    def announce(self, key: str) -> None:
        """Declare a liveliness token: it goes when this session does, however it ends."""
        self._tokens[key] = self._session.liveliness().declare_token(key)

    def withdraw(self, key: str) -> None:
        """Take back what was announced."""
        self._tokens.pop(key).undeclare()

    def present(self, key: str, timeout_s: float = 1.0) -> list[str]:
        """Keys of the live tokens that match."""
        replies = self._session.liveliness().get(key, timeout=timeout_s)
        return sorted(str(reply.ok.key_expr) for reply in replies if reply.ok is not None)

    def watch(self, key: str, handle: Callable[[str, bool], None]) -> None:
        """Hear of tokens that come and go, those already there first: `handle(key, alive)`."""

        def receive(sample: zenoh.Sample) -> None:
            handle(str(sample.key_expr), sample.kind == zenoh.SampleKind.PUT)

        self._declare(
            lambda session: session.liveliness().declare_subscriber(
                key, Callback(receive, indirect=False), history=True
            )
        )

    def watch_router(self, handle: Callable[[bool], None]) -> None:
        """Hear of the router that comes and goes, one already there first: `handle(there)`."""

        def receive(event: zenoh.TransportEvent) -> None:
            handle(event.kind == zenoh.SampleKind.PUT)

        self._declare(
            lambda session: session.info.declare_transport_events_listener(
                Callback(receive, indirect=False), history=True
            )
        )

    @property
    def connected(self) -> bool:
        """A router is there."""
        return bool(self._session.info.routers_zid())

    def robots(self, timeout_s: float = 1.0) -> list[tuple[str, str]]:
        """Name and twin of every robot on line."""
        tokens = self.present(keys.alive(robot="*", twin="*"), timeout_s)
        return [(token.split("/")[1], token.split("/")[2]) for token in tokens]

    def claims(self, timeout_s: float = 1.0) -> list[tuple[str, str]]:
        """Name and twin of every node that serves, or is about to: twice where two networks with one name were joined."""
        tokens = self.present(keys.claim(robot="*", twin="*", session="*"), timeout_s)
        return [(token.split("/")[1], token.split("/")[2]) for token in tokens]

    def close(self) -> None:
        """Undeclare everything and leave; may be called twice."""
        self._declared.clear()
        self._tokens.clear()
        self._session.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exc: object) -> None:
        self.close()


def connect(endpoint: str, *, label: str = "") -> Bus:
    """Open a session as client of the router at `endpoint`, for example `tcp/127.0.0.1:7447`.

    Raises:
        NoAnswer: NO_ROUTER, with what to do.
    """
    parts(endpoint)
    settings = {
        "mode": "client",
        "connect/endpoints": [endpoint],
        "connect/timeout_ms": 0,
        "connect/retry": {"period_init_ms": 50, "period_max_ms": 500, "period_increase_factor": 2},
        "scouting/gossip/enabled": False,
        "metadata": {"name": label},
    }

    def open_session() -> zenoh.Session:
        probe(endpoint)
        return opened(
            settings,
            f"Something listens at {endpoint} but does not accept this client: is it a Zenoh router?",
        )

    return Bus(open_session, endpoint)
