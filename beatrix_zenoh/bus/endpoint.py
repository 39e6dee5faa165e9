"""Endpoints such as `tcp/127.0.0.1:7447`: parse them, check whether they are local and whether a process listens."""

from __future__ import annotations

import socket
import struct

from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.errors import NoAnswer, quoted, wrong_usage
from beatrix_zenoh.output import typed
from beatrix_zenoh.settings import DEFAULT_ENDPOINT

ROUTER_PROBE_S = 1.0
PORT_MAX = 65535
PROTOCOLS = ("tcp", "tls")
"""Supported protocols; with others Zenoh waits for ever if no process answers."""
INIT = bytes.fromhex("1300 0109 f2") + bytes([1]) * 16
"""First message of a client of Zenoh 1 on TCP: length, message `Init`, protocol version 9, client, an identity."""
CLOSES = bytes.fromhex("0200 03")
"""Beginning of the answer of a router with another protocol version, such as Zenoh 0.11: length, message `Close`."""
RESET = struct.pack("ii", 1, 0)
"""Value of SO_LINGER with which `close` resets a connection."""


def endpoints(text: str) -> list[str]:
    """Split a list of endpoints of one router, such as `tls/10.0.0.2:7447,tls/192.168.1.20:7447`."""
    return [endpoint.strip() for endpoint in text.split(",")]


def probe(endpoint: str) -> None:
    """Try to connect to one endpoint or one of several; unlike an error of Zenoh, the error says what to do.

    Raises:
        NoAnswer: NO_ROUTER, no endpoint accepts a connection.
        WrongUsage: BAD_VALUE, as `parse_endpoint`.
    """
    failures = []
    for one in endpoints(endpoint):
        try:
            _probe(one)
        except NoAnswer as error:
            failures.append(error)
        else:
            return
    raise failures[0]


def _probe(endpoint: str) -> None:
    """Connect to one endpoint and reset the connection.

    A router with TLS accepts no session for 0.1 s after each connection that is closed without a handshake, so two seats
    that asked for an absent robot, and probed to explain its silence, kept the robot out for as long as they asked. A
    connection that is reset instead stays in the kernel of the router (Linux, TCP_DEFER_ACCEPT in `router.py`).
    """
    _, host, port = parse_endpoint(endpoint)
    try:
        with socket.create_connection((host, port), timeout=ROUTER_PROBE_S) as connection:
            connection.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, RESET)
    except OSError as error:
        start = f"`beatrix router --listen tcp/0.0.0.0:{port}` on that computer"
        if endpoint == DEFAULT_ENDPOINT:
            start = "`beatrix up`, together with a simulation, or alone with `beatrix router`"
        elif is_local(endpoint):
            start = f"`{typed('beatrix', 'router', '--listen', endpoint)}`"
        raise NoAnswer(
            Reason.NO_ROUTER,
            f"No router at {endpoint} ({error}). Start one with {start}; or name another with "
            "--connect or BEATRIX_CONNECT.",
        ) from error


def speaks_another_zenoh(endpoint: str) -> bool:
    """Return whether a router of another protocol version of Zenoh listens at this endpoint, or at the first of a list."""
    _, host, port = parse_endpoint(endpoints(endpoint)[0])
    try:
        with socket.create_connection((host, port), timeout=ROUTER_PROBE_S) as connection:
            connection.sendall(INIT)
            return connection.recv(len(CLOSES)) == CLOSES
    except OSError:
        return False


def is_listening(endpoint: str) -> bool:
    """Return whether a process accepts connections at this endpoint."""
    try:
        probe(endpoint)
    except NoAnswer:
        return False
    return True


def parse_endpoint(endpoint: str) -> tuple[str, str, int]:
    """Return protocol, host and port of an endpoint such as `tcp/127.0.0.1:7447`.

    Raises:
        WrongUsage: BAD_VALUE, it is not an endpoint.
    """
    protocol, _, address = endpoint.partition("/")
    host, _, port = address.partition("#")[0].rpartition(":")
    number = int(port) if port.isascii() and port.isdigit() else PORT_MAX + 1
    resolvable = all(0 < len(label) < 64 for label in host.split(".")) and host.isprintable()
    if protocol not in PROTOCOLS or not resolvable or number > PORT_MAX:
        raise wrong_usage(
            f"{quoted(endpoint)} is not an endpoint. Write protocol/host:port, for example tcp/127.0.0.1:7447; "
            f"the protocol is {' or '.join(PROTOCOLS)}.",
        )
    return protocol, host.strip("[]"), number


def is_local(text: str) -> bool:
    """Return whether the host of each endpoint is an address of this computer.

    Raises the errors of `parse_endpoint`.
    """
    return all(_is_local(endpoint) for endpoint in endpoints(text))


def _is_local(endpoint: str) -> bool:
    _, host, _ = parse_endpoint(endpoint)
    try:
        family, kind, protocol, _, address = socket.getaddrinfo(host, 0, type=socket.SOCK_STREAM)[0]
        with socket.socket(family, kind, protocol) as test_socket:
            test_socket.bind(address)
    except OSError:
        return False
    return True
