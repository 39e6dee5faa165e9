"""The router, to which all clients and nodes connect, and its access rules as Zenoh's configuration.

Zenoh drops messages that no rule allows, without an error.
"""

from __future__ import annotations

import contextlib
import logging
import os
import socket
import sys
from collections.abc import Callable, Container, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

import zenoh

from beatrix_zenoh.bus.callbacks import direct
from beatrix_zenoh.bus.credentials import Identity, tls
from beatrix_zenoh.bus.endpoint import endpoints, is_local
from beatrix_zenoh.bus.transport import (
    HALF_OPEN,
    LARGEST_MESSAGE,
    LEASE_MS,
    RETRY,
    RUNTIME,
    WAIT_CLOSE_US,
    closed,
    opened,
)
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract.errors import wrong_usage

LOG = logging.getLogger("beatrix_zenoh.bus")
DESCRIPTORS = Path("/proc/self/fd" if sys.platform == "linux" else "/dev/fd")


@dataclass(frozen=True)
class RouterAccess:
    """Accounts of a router, and the messages that each may send."""

    grants: list[Grant]
    common_names: Mapping[str, str]
    """common name of the one valid certificate of each account, by the account's name"""
    identity: Identity
    """certificate and key of this router; as `authority` the certificates of all whose sessions and routers it accepts"""
    upstream: str = ""
    """endpoint of a router to which this one connects, and through which its clients reach all others; empty: none"""
    rates: Mapping[str, float] = field(default_factory=dict)
    """largest rate (Hz) of the publications of each of these keys that the router accepts from a session"""


def open_router(listen: str, access: RouterAccess | None = None) -> zenoh.Session:
    """Open a router, to which nodes and clients connect; `close_router` ends it.

    Without `access`, every program that can connect to the router may send all messages.

    Raises:
        WrongUsage: BAD_VALUE, `listen` is not an endpoint of this computer.
        NoAnswer: NO_ROUTER, the endpoint is in use.
    """
    if not is_local(listen):
        raise wrong_usage(
            f"Cannot listen at {listen}: this is the address of another computer. A router can listen at 127.0.0.1 "
            "(for this computer only), at 0.0.0.0 or [::] (for all), or at one of this computer's own addresses. "
            "For a class, correct `addresses` in class.toml and run `beatrix classroom init class.toml` again.",
        )
    os.environ.setdefault(*RUNTIME)
    settings: dict[str, object] = {
        "mode": "router",
        "listen/endpoints": endpoints(listen),
        "listen/exit_on_failure": True,
        "scouting/delay": 0,
        # Zenoh 1.9 to 1.10.2 can deadlock when it answers a query to the admin space (decision 41).
        "adminspace/enabled": False,
        "transport/link/tx/queue/congestion_control/block/wait_before_close": WAIT_CLOSE_US,
        "transport/unicast/accept_pending": HALF_OPEN,
        "transport/unicast/accept_timeout": LEASE_MS,
    }
    trouble = (
        f"Cannot listen at {listen}: another program, perhaps this router, already listens there. For a second router "
        "choose another address with --listen, or in a class another `port` in class.toml."
    )
    if access is not None:
        settings |= {
            "access_control": access_control(access.grants, access.common_names),
            "downsampling": downsampling(access.rates),
            "low_pass_filter": low_pass_filter(),
            "transport/link/tls": tls(access.identity, listens=True),
            # It keeps trying for ever: a router that is started again accepts no connection for a moment.
            "connect/endpoints": [access.upstream] if access.upstream else [],
            "connect/timeout_ms": -1,
            "connect/exit_on_failure": False,
            "connect/retry": RETRY,
        }
    session = opened(settings, trouble)
    _set_up_listening()
    return session


def close_router(session: zenoh.Session) -> None:
    """End a router; log a warning if it cannot close in time, for example because clients keep it busy."""
    if cause := closed(session):
        LOG.warning("The router did not close in time (%s). It ends with its process.", cause)


def _set_up_listening() -> None:
    """Set options of the listening socket that Zenoh 1.10 does not set (Linux); accepted connections inherit them.

    TCP_USER_TIMEOUT: the kernel ends connections whose data is not acknowledged for LEASE_MS. Zenoh closes a TLS
    connection only after all data is written. If a computer loses its network while the socket's buffer is full, its
    liveliness tokens would remain until TCP gives up, after a quarter of an hour, and its motions would continue.

    TCP_DEFER_ACCEPT: connections that send nothing stay in the kernel. After each failed handshake Zenoh accepts no
    connection for 0.1 s, so a few hundred silent connections would keep out all clients. For the same reason
    `endpoint.probe` resets its connections, which then end in the kernel, too.
    """
    if sys.platform == "linux":
        for listening in _sockets():
            if listening.getsockopt(socket.SOL_SOCKET, socket.SO_ACCEPTCONN):
                listening.setsockopt(socket.IPPROTO_TCP, socket.TCP_USER_TIMEOUT, LEASE_MS)
                listening.setsockopt(socket.IPPROTO_TCP, socket.TCP_DEFER_ACCEPT, LEASE_MS // 1000)


def watch_router(
    session: zenoh.Session, link: Callable[[str, str, bool], None], token: Callable[[str], None]
) -> object:
    """Report what the clients of a router do, on Zenoh's threads, until the returned object is deleted.

    `link(common_name, address, opened)`: a connection of the account with this common name has begun or ended.
    `token(key)`: a client has declared a liveliness token.
    """

    def on_link(event: zenoh.LinkEvent) -> None:
        address = event.link.dst.partition("/")[2]
        link(event.link.auth_identifier or "", address, event.kind == zenoh.SampleKind.PUT)

    def on_token(sample: zenoh.Sample) -> None:
        if sample.kind == zenoh.SampleKind.PUT:
            token(str(sample.key_expr))

    tokens = session.liveliness()
    return (
        session.info.declare_link_events_listener(direct(on_link), history=True),
        *(tokens.declare_subscriber(key, direct(on_token)) for key in EVERYTHING[1:]),
    )


def answer_checks(session: zenoh.Session, key: str) -> object:
    """Answer each query on a key, to show that this router passes on messages, until the returned object is deleted."""

    def answer(query: zenoh.Query) -> None:
        with contextlib.suppress(zenoh.ZError):  # the router is closing
            query.reply(key, b"")
        query.drop()

    return session.declare_queryable(key, direct(answer))


def close_connections(addresses: Container[str]) -> None:
    """End the connections of this process to these addresses, such as `10.0.0.7:51002`; Zenoh cannot end a session.

    Raises:
        NotImplementedError: the system does not list the open files of a process.
    """
    if not DESCRIPTORS.exists():
        raise NotImplementedError
    for connection in _sockets():
        with contextlib.suppress(OSError):  # it has no peer, or has ended meanwhile
            host, port = connection.getpeername()[:2]
            if f"{host}:{port}" in addresses:
                connection.shutdown(socket.SHUT_RDWR)


def _sockets() -> Iterator[socket.socket]:
    """Yield a copy of each socket of this process, which is closed after its use."""
    for path in DESCRIPTORS.iterdir():
        with contextlib.suppress(OSError):  # a descriptor that is no socket, or already closed
            copy = os.dup(int(path.name))
            try:
                found = socket.socket(fileno=copy)
            except OSError:
                os.close(copy)
                continue
            with found:
                yield found


ROOT = keys.KEYS["alive"].key.partition("/")[0]
EVERYTHING = (
    f"{ROOT}/**",
    keys.alive("*", "*"),
    keys.claim("*", "*", "*"),
    keys.seat("*", "*"),
    keys.program("*", "*"),
    keys.note("*", "*"),
    keys.lesson("*", "*"),
    keys.gesture("*", "*"),
    keys.pending("*", "*"),
    keys.seats_router("*"),
)
"""All keys of BEATRIX; some are listed separately, because `**` matches no chunk that begins with @."""
MESSAGES = {
    "puts": ("put",),
    "queries": ("query",),
    "serves": ("declare_queryable", "reply"),
    "subscribes": ("declare_subscriber",),
    "tokens": ("liveliness_token",),
    "watches": ("liveliness_query", "declare_liveliness_subscriber"),
}
"""Zenoh's kinds of messages for each field of `Grant`."""
ALL_MESSAGES = (*(kind for kinds in MESSAGES.values() for kind in kinds), "delete")
DEPTH = 9
"""Largest number of chunks in the keys of BEATRIX, and a few more."""
LARGEST_REQUEST = 64 * 1024
"""Largest query (bytes); the router of a class drops larger ones."""


def below(root: str) -> tuple[str, ...]:
    """Return key expressions that include all keys below `root` with at most DEPTH chunks, and none with `**`.

    Zenoh 1.10 passes a declaration on to other routers, and a router ends with a stack overflow when it forgets a key
    of some thousand chunks, so a rule such as `beatrix/**` would let one seat end the router of the robots.
    """
    return tuple(root + "/*" * count for count in range(1, DEPTH - root.count("/")))


@dataclass(frozen=True)
class Grant:
    """Keys of the messages that one account may send; it may receive all messages of BEATRIX.

    A message whose key has wildcards passes only if one of these key expressions includes all keys that it matches.
    """

    account: str
    puts: tuple[str, ...] = ()
    queries: tuple[str, ...] = ()
    serves: tuple[str, ...] = ()
    subscribes: tuple[str, ...] = ()
    tokens: tuple[str, ...] = ()
    watches: tuple[str, ...] = ()


def access_control(grants: list[Grant], common_names: Mapping[str, str]) -> dict[str, object]:
    """Return Zenoh's section `access_control`: deny by default, a subject and a policy for each account.

    `common_names`: common name of the one valid certificate of each account. A certificate with another common name
    has no rights, even if the authority of the class has signed it.
    """
    rules = [_rule("receive", ALL_MESSAGES, EVERYTHING, "egress")]
    subjects: list[dict[str, object]] = []
    policies: list[dict[str, object]] = []
    for grant in grants:
        own = list(_rules(grant))
        rules += own
        subjects.append({"id": grant.account, "cert_common_names": [common_names[grant.account]]})
        policies.append({"subjects": [grant.account], "rules": ["receive", *(rule["id"] for rule in own)]})
    return {
        "enabled": True,
        "default_permission": "deny",
        "rules": rules,
        "subjects": subjects,
        "policies": policies,
    }


def _rules(grant: Grant) -> Iterator[dict[str, object]]:
    for action, kinds in MESSAGES.items():
        expressions: tuple[str, ...] = getattr(grant, action)
        if expressions:  # Zenoh refuses empty lists
            yield _rule(f"{grant.account} {action}", kinds, expressions)


def _rule(name: str, kinds: tuple[str, ...], expressions: tuple[str, ...], *flows: str) -> dict[str, object]:
    return {
        "id": name,
        "permission": "allow",
        "messages": kinds,
        "flows": flows or ("ingress",),
        "key_exprs": expressions,
    }


def downsampling(rates: Mapping[str, float]) -> list[dict[str, object]]:
    """Return Zenoh's section `downsampling`: the largest rate (Hz) of each key's publications from each session."""
    # All keys that match one rule share its rate, so each key needs its own rule. Zenoh looks for the rule of each
    # message, at the egress once for each receiver: 30 seats that watch 30 robots would double the router's load.
    rules = [{"key_expr": key, "freq": rate} for key, rate in rates.items()]
    return [{"id": "rates", "messages": ["put"], "flows": ["ingress"], "rules": rules}] if rules else []


def low_pass_filter() -> list[dict[str, object]]:
    """Return Zenoh's section `low_pass_filter`: the largest messages that a session may send."""
    requests = {"messages": ["query"], "size_limit": LARGEST_REQUEST}
    messages = {"messages": ["put", "delete", "reply"], "size_limit": LARGEST_MESSAGE}
    return [
        {"id": name, "flows": ["ingress"], "key_exprs": ["**", *EVERYTHING[1:]], **rule}
        for name, rule in {"requests": requests, "messages": messages}.items()
    ]
