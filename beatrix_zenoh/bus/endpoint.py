"""Endpoints such as `tcp/127.0.0.1:7447`: what they may be, whose they are, whether somebody listens."""

from __future__ import annotations

import socket

from beatrix_zenoh._generated.messages import Reason
from beatrix_zenoh.errors import NoAnswer, WrongUsage, quoted
from beatrix_zenoh.settings import DEFAULT_ENDPOINT

ROUTER_PROBE_S = 1.0
PORT_MAX = 65535
PROTOCOLS = ("tcp",)
"""What is tried here; with others Zenoh waits for ever where nobody answers."""


def probe(endpoint: str) -> None:
    """Say in plain words why an endpoint cannot be reached: Zenoh's own text does not.

    Raises:
        NoAnswer: NO_ROUTER.
    """
    _, host, port = parts(endpoint)
    try:
        socket.create_connection((host, port), timeout=ROUTER_PROBE_S).close()
    except OSError as error:
        here = ours(endpoint)
        listen = "" if endpoint == DEFAULT_ENDPOINT else f" --listen {endpoint}"
        start = f"`beatrix router{listen}`" if here else f"`beatrix router --listen tcp/0.0.0.0:{port}` there"
        raise NoAnswer(
            Reason.NO_ROUTER,
            f"No router at {endpoint} ({error}). Start one with {start}, or name another with "
            "--connect or BEATRIX_CONNECT.",
        ) from error


def listens(endpoint: str) -> bool:
    """Something accepts connections there."""
    try:
        probe(endpoint)
    except NoAnswer:
        return False
    return True


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
