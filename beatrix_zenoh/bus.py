"""Zenoh, and nobody else imports it: open, ask, serve, publish, watch presence, close.

Every callback runs on Zenoh's own thread and only hands over; a slow one would stop the
whole session. Congestion control is DROP everywhere: one frozen listener must not hold
up the others.
"""

from __future__ import annotations

import contextlib
import json
import os
import queue
import socket
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Self

import zenoh
from zenoh.handlers import Callback

from beatrix_zenoh._generated import keys
from beatrix_zenoh._generated.messages import Reason
from beatrix_zenoh.errors import NoAnswer, WrongUsage, quoted
from beatrix_zenoh.requests import Wording

LEASE_MS = 2000
"""A frozen session counts as gone after this long; the default of 10 s is too long for a moving robot."""
TCP = {"so_sndbuf": 32768, "so_rcvbuf": 32768}
"""Small socket buffers: what a flooding client has sent waits with the client, not for seconds in the kernel."""
WAIT_DROP_US = 20_000
"""What may be dropped is dropped if it cannot leave for this long; the default of 1 ms loses positions on a busy machine."""
WAIT_CLOSE_US = 500_000
"""A client that reads nothing for this long while replies wait for it is cut off by the router: at the default of 5 s
one flooding client that ends holds up the whole class for seconds."""
RUNTIME = ("ZENOH_RUNTIME", "(rx: (worker_threads: 16))")
"""A router thread that waits for one client that does not read holds up all clients it serves: with Zenoh's three, a
client that floods cut robots off for seconds (measured). Read by Zenoh once, at a process's first session."""
HALF_OPEN = 1000
"""Connections that may be silent at once until they time out; the default of 100 lets one port scanner lock out a class."""
ROUTER_PROBE_S = 1.0
PORT_MAX = 65535
PROTOCOLS = ("tcp",)
"""What is tried here; with others Zenoh waits for ever where nobody answers."""
STALE_S = 0.02
"""After a node's restart a kept session may ask into the void for this long (zenoh#2767)."""
FOR_EVER_S = 24 * 3600.0

PRIORITIES = {
    "real_time": zenoh.Priority.REAL_TIME,
    "interactive_high": zenoh.Priority.INTERACTIVE_HIGH,
    "data": zenoh.Priority.DATA,
    "data_low": zenoh.Priority.DATA_LOW,
}


@dataclass(frozen=True)
class Answer:
    """One reply to `ask`: the key it came on, payload, encoding, and whether it is an error reply."""

    key: str
    payload: bytes
    encoding: str
    error: bool


class Incoming:
    """A query to be answered; must end with `finish`, or the asker waits until its timeout."""

    def __init__(self, query: zenoh.Query) -> None:
        # Read nothing else yet: in a flood most queries are replaced before anybody looks at them.
        self._query = query
        self.key = str(query.key_expr)

    @property
    def wording(self) -> Wording:
        """What is asked; only before `finish`."""
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

    def __init__(self, publisher: zenoh.Publisher) -> None:
        self._publisher = publisher

    @property
    def watched(self) -> bool:
        """Somebody subscribes to it."""
        return bool(self._publisher.matching_status.matching)  # type: ignore[attr-defined]  # the stub says bool

    def put(self, payload: bytes) -> None:
        """Publish; dropped for whoever cannot keep up."""
        with contextlib.suppress(zenoh.ZError):  # the session may be closing
            self._publisher.put(payload)


class Question:
    """An `ask` under way: replies as they come, each waited for with its own time-out."""

    def __init__(
        self, session: zenoh.Session, key: str, payload: bytes | None, encoding: str | None, priority: str
    ) -> None:
        self._inbox: queue.SimpleQueue[Answer | None] = queue.SimpleQueue()
        self._cancel = zenoh.CancellationToken()
        session.get(
            key,
            Callback(self._receive, drop=lambda: self._inbox.put(None), indirect=False),
            payload=payload,
            encoding=encoding,
            consolidation=zenoh.ConsolidationMode.NONE,
            priority=PRIORITIES[priority],
            timeout=FOR_EVER_S,
            source_info=zenoh.SourceInfo(session.id, 0),
            cancellation_token=self._cancel,
        )

    def _receive(self, reply: zenoh.Reply) -> None:
        good = reply.ok
        if good is not None:
            self._inbox.put(
                Answer(str(good.key_expr), good.payload.to_bytes(), str(good.encoding), error=False)
            )
            return
        bad = reply.err
        if bad is not None:
            self._inbox.put(Answer("", bad.payload.to_bytes(), str(bad.encoding), error=True))

    def next(self, timeout_s: float) -> Answer | None:
        """The next reply; None when there will be no more.

        Raises:
            TimeoutError: nothing came within `timeout_s`; the question stays open.
        """
        try:
            return self._inbox.get(timeout=max(0.0, timeout_s))
        except queue.Empty:
            raise TimeoutError from None

    def close(self) -> None:
        """Wait for no more replies."""
        self._cancel.cancel()


class Bus:
    """One Zenoh session: a client of an explicit router, no discovery, no shared memory."""

    def __init__(self, session: zenoh.Session, endpoint: str) -> None:
        self._session = session
        self._declared: list[object] = []
        self._tokens: dict[str, zenoh.LivelinessToken] = {}
        self.endpoint = endpoint
        self.session_id = str(session.zid())

    # -- asking ---------------------------------------------------------------------------------

    def question(
        self, key: str, payload: bytes | None = None, encoding: str | None = None, priority: str = "data"
    ) -> Question:
        """Ask and collect replies one by one; close the question afterwards."""
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
        callback: Callback[zenoh.Query] = Callback(lambda query: handle(Incoming(query)), indirect=False)
        self._declared.append(self._session.declare_queryable(key, callback, complete=True))

    def publication(self, key: str, encoding: str, priority: str = "data") -> Publication:
        """Declare a publication."""
        publisher = self._session.declare_publisher(
            key,
            encoding=encoding,
            priority=PRIORITIES[priority],
            congestion_control=zenoh.CongestionControl.DROP,
        )
        self._declared.append(publisher)
        return Publication(publisher)

    def subscribe(self, key: str, handle: Callable[[str, bytes], None]) -> None:
        """Hear publications: `handle(key, payload)` runs on Zenoh's thread and must only hand over."""

        def receive(sample: zenoh.Sample) -> None:
            handle(str(sample.key_expr), sample.payload.to_bytes())

        self._declared.append(self._session.declare_subscriber(key, Callback(receive, indirect=False)))

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

        liveliness = self._session.liveliness()
        callback = Callback(receive, indirect=False)
        self._declared.append(liveliness.declare_subscriber(key, callback, history=True))

    def watch_router(self, handle: Callable[[bool], None]) -> None:
        """Hear of the router that comes and goes, one already there first: `handle(there)`."""

        def receive(event: zenoh.TransportEvent) -> None:
            handle(event.kind == zenoh.SampleKind.PUT)

        callback = Callback(receive, indirect=False)
        self._declared.append(self._session.info.declare_transport_events_listener(callback, history=True))

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
    probe(endpoint)
    config = zenoh.Config()
    settings = {
        "mode": "client",
        "connect/endpoints": [endpoint],
        "connect/timeout_ms": 0,
        "connect/retry": {"period_init_ms": 50, "period_max_ms": 500, "period_increase_factor": 2},
        "scouting/multicast/enabled": False,
        "scouting/gossip/enabled": False,
        "transport/shared_memory/enabled": False,
        "transport/link/tx/lease": LEASE_MS,
        "transport/link/tcp": TCP,
        "transport/link/tx/queue/congestion_control/drop/wait_before_drop": WAIT_DROP_US,
        "metadata": {"name": label},
    }
    for key, value in settings.items():
        config.insert_json5(key, json.dumps(value))
    try:
        return Bus(zenoh.open(config), endpoint)
    except zenoh.ZError as error:
        raise NoAnswer(
            Reason.NO_ROUTER,
            f"Something listens at {endpoint} but does not accept this client: is it a Zenoh router? ({short(error)})",
        ) from error


def probe(endpoint: str) -> None:
    """Say in plain words why an endpoint cannot be reached: Zenoh's own text does not.

    Raises:
        NoAnswer: NO_ROUTER.
    """
    _, host, port = parts(endpoint)
    try:
        socket.create_connection((host, port), timeout=ROUTER_PROBE_S).close()
    except OSError as error:
        start = (
            "`beatrix router`" if ours(endpoint) else f"`beatrix router --listen tcp/0.0.0.0:{port}` there"
        )
        raise NoAnswer(
            Reason.NO_ROUTER,
            f"No router at {endpoint} ({error}). Start one with {start}, or name another with "
            "--connect or BEATRIX_CONNECT.",
        ) from error


def parts(endpoint: str) -> tuple[str, str, int]:
    """Protocol, host and port of `tcp/127.0.0.1:7447`.

    Raises:
        WrongUsage: BAD_VALUE.
    """
    protocol, _, address = endpoint.partition("/")
    host, _, port = address.partition("#")[0].rpartition(":")
    if protocol not in PROTOCOLS or not host or not port.isdigit() or int(port) > PORT_MAX:
        raise WrongUsage(
            Reason.BAD_VALUE,
            f"{quoted(endpoint)} is no endpoint: write protocol/host:port, for example tcp/127.0.0.1:7447; "
            f"the protocol is {' or '.join(PROTOCOLS)}.",
        )
    return protocol, host.strip("[]"), int(port)


def ours(endpoint: str) -> bool:
    """Whether this computer can listen there: at loopback, at all its addresses, or at one of them."""
    _, host, _ = parts(endpoint)
    try:
        family, kind, protocol, _, address = socket.getaddrinfo(host, 0, type=socket.SOCK_STREAM)[0]
        with socket.socket(family, kind, protocol) as knocker:
            knocker.bind(address)
    except OSError:
        return False
    return True


def short(error: zenoh.ZError) -> str:
    """What Zenoh says, without the places in its source."""
    return str(error).partition(" at /")[0]


def open_router(listen: str) -> zenoh.Session:
    """Be the router of a classroom: clients meet here. Close the session to end it.

    Raises:
        WrongUsage: BAD_VALUE, if `listen` is no endpoint, or not ours.
        NoAnswer: NO_ROUTER, if the endpoint is taken.
    """
    if not ours(listen):
        raise WrongUsage(
            Reason.BAD_VALUE,
            f"Cannot listen at {listen}: that is another computer. A router listens at 127.0.0.1 (for this computer "
            "only), at 0.0.0.0 or [::] (for all), or at one of this computer's own addresses.",
        )
    os.environ.setdefault(*RUNTIME)
    config = zenoh.Config()
    settings = {
        "mode": "router",
        "listen/endpoints": [listen],
        "listen/exit_on_failure": True,
        "scouting/multicast/enabled": False,
        "scouting/delay": 0,
        "adminspace/enabled": True,
        "transport/shared_memory/enabled": False,
        "transport/link/tcp": TCP,
        "transport/link/tx/queue/congestion_control/drop/wait_before_drop": WAIT_DROP_US,
        "transport/link/tx/queue/congestion_control/block/wait_before_close": WAIT_CLOSE_US,
        "transport/unicast/accept_pending": HALF_OPEN,
        "transport/unicast/accept_timeout": LEASE_MS,
    }
    for key, value in settings.items():
        config.insert_json5(key, json.dumps(value))
    try:
        return zenoh.open(config)
    except zenoh.ZError as error:
        raise NoAnswer(
            Reason.NO_ROUTER,
            f"Cannot listen at {listen}: is another router running there? Choose another with --listen. ({short(error)})",
        ) from error
