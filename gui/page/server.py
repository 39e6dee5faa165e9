"""The server of the control page; limits keep a flood of requests from using up open files or the disk."""

from __future__ import annotations

import asyncio
import contextlib
import errno
import logging
import os
import socket
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Final

from tornado import httpserver, ioloop, iostream, web

from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.errors import Refused
from beatrix_zenoh.settings import Settings
from beatrix_zenoh.shutdown import Shutdown
from gui.page.handlers import Context, Front, Live, Nothing, Pictures, Projector, StaticFiles, Stopper
from gui.page.hub import Hub
from gui.page.protection import Login

CONNECTIONS_MAX: Final = 192
"""Largest number of connections: a page needs two, and a system may allow a process only 256 open files."""
ADDRESS_MAX: Final = 64
"""Largest number of connections of one address."""
REFUSED_MAX: Final = 16
"""Largest number of refused connections that stay open so that the reply can be read; others are closed at once."""
REFUSED_S: Final = 1.0
"""Longest time for which a refused connection is kept open."""
LOG_S: Final = 10.0
"""Shortest time between two lines of the log."""
LOGGERS: Final = ("gui.page", "tornado", "asyncio")
LOG: Final = logging.getLogger("gui.page")

FULL: Final = f"The server has {CONNECTIONS_MAX} connections, which is its limit. Close pages that are not needed, then load this page again."
ADDRESS_FULL: Final = f"Your address has {ADDRESS_MAX} connections to this server, which is its limit. Close pages that are not needed, then load this page again."
STATIC: Final = Path(__file__).parent / "static"
LOOPBACK, ALL = "127.0.0.1", "0.0.0.0"  # noqa: S104  # only with --lan, behind a PIN
SHOW_MS: Final = 100
"""Period of the views that pages get."""
HEARTBEAT_MS: Final = 50
"""Period of the check for heartbeats."""
PING_S: Final = 5.0
"""Period of pings to each page; the connection of a page that does not reply is closed."""
REQUEST_S: Final = 20.0
"""Longest time for the body of a request to arrive, and for a connection to be idle."""
BACKLOG: Final = 128
"""Largest number of connections that may wait to be accepted."""
BODY_MAX: Final = 4096
"""Largest request, bytes."""
MESSAGE_MAX: Final = 16384
"""Largest message of a page, bytes: the choices and poses that its browser has kept."""


class Server(httpserver.HTTPServer):
    """An HTTP server that limits its connections, web sockets included."""

    def __init__(self, *args: object, **kwargs: object) -> None:
        """Take the arguments of `HTTPServer`, which Tornado has passed to `initialize` before this call."""
        super().__init__(*args, **kwargs)
        self._open: dict[iostream.IOStream, str] = {}
        self._refused: set[iostream.IOStream] = set()

    def handle_stream(self, stream: iostream.IOStream, address: tuple[str, int]) -> None:
        """Serve a connection, or reply that there are too many."""
        self._open = {one: sender for one, sender in self._open.items() if not one.closed()}
        refusal = refused(list(self._open.values()), address[0])
        if refusal:
            LOG.warning("A connection from %s was refused: %s", address[0], refusal)
            self._refuse(stream, refusal)
        else:
            self._open[stream] = address[0]
            super().handle_stream(stream, address)

    def _refuse(self, stream: iostream.IOStream, sentence: str) -> None:
        """Reply with a sentence, without reading the request, and close the connection after REFUSED_S."""
        self._refused = {one for one in self._refused if not one.closed()}
        if len(self._refused) >= REFUSED_MAX:
            stream.close()
            return
        self._refused.add(stream)
        body = sentence.encode()
        head = (
            "HTTP/1.1 503 Service Unavailable\r\nContent-Type: text/plain; charset=utf-8\r\n"
            f"Content-Length: {len(body)}\r\nConnection: close\r\n\r\n"
        )
        # Close later: closing with the request unread would reset the connection, and the browser could lose the reply.
        stream.io_loop.call_later(REFUSED_S, stream.close)
        with contextlib.suppress(iostream.StreamClosedError):
            stream.write(head.encode() + body).add_done_callback(lambda done: done.exception())

    async def close_all_connections(self) -> None:
        """Close all connections, including the refused ones."""
        for stream in self._refused:
            stream.close()
        await super().close_all_connections()


def refused(addresses: list[str], address: str) -> str:
    """Return why a connection of `address` is refused, given the addresses of all open ones; empty: accepted."""
    if addresses.count(address) >= ADDRESS_MAX:
        return ADDRESS_FULL
    return FULL if len(addresses) >= CONNECTIONS_MAX else ""


class Brief(logging.Filter):
    """Passes at most one record in LOG_S, and adds the number of records that were left out before it."""

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        """Make the filter; `clock` returns monotonic seconds."""
        super().__init__()
        self._clock = clock
        self._next_s, self._left_out = clock(), 0

    def filter(self, record: logging.LogRecord) -> bool:
        """Return whether the record is logged."""
        now_s = self._clock()
        if now_s < self._next_s:
            self._left_out += 1
            return False
        if self._left_out:
            record.msg = f"{record.getMessage()} ({self._left_out} lines before this one were left out.)"
            record.args = None
        self._next_s, self._left_out = now_s + LOG_S, 0
        return True


@contextlib.contextmanager
def brief_log() -> Iterator[None]:
    """Write warnings of the server and its libraries to stderr, at most one in LOG_S."""
    handler = logging.StreamHandler()
    handler.setLevel(logging.WARNING)
    handler.addFilter(Brief())
    loggers = [logging.getLogger(name) for name in LOGGERS]
    before = [logger.propagate for logger in loggers]
    for logger in loggers:
        logger.propagate = False
        logger.addHandler(handler)
    try:
        yield
    finally:
        for logger, propagate in zip(loggers, before, strict=True):
            logger.removeHandler(handler)
            logger.propagate = propagate


def serve(
    settings: Settings,
    port: int,
    *,
    only: str | None,
    pin: str | None,
    ready: Callable[[int], None],
    shutdown: Shutdown,
) -> None:
    """Serve the page until a shutdown is requested.

    Args:
        settings: router and seat.
        port: TCP port; 0: any free port.
        only: name of the only robot that pages may use; None: all robots at the router.
        pin: PIN that every browser needs; None: serve this computer only, without a PIN.
        ready: called with the port when the page is served.
        shutdown: ends the server.

    Raises:
        NoAnswer: NO_ROUTER.
        Refused: BAD_VALUE, another program uses the port, or the system does not allow it.
    """
    with brief_log():
        asyncio.run(_serve(settings, port, only, pin, ready, shutdown))


async def _serve(
    settings: Settings,
    port: int,
    only: str | None,
    pin: str | None,
    ready: Callable[[int], None],
    shutdown: Shutdown,
) -> None:
    listening = bind(port, LOOPBACK if pin is None else ALL)
    port = listening.getsockname()[1]
    loop = ioloop.IOLoop.current()
    try:
        hub = Hub(settings, only, loop.add_callback)
    except BaseException:
        listening.close()
        raise
    context = Context(hub, Login(pin), f"beatrix-{port}")
    server = Server(
        application(context),
        max_body_size=BODY_MAX,
        max_header_size=4 * BODY_MAX,
        body_timeout=REQUEST_S,
        idle_connection_timeout=REQUEST_S,
    )
    server.add_socket(listening)
    ended = asyncio.Event()
    timers = [
        ioloop.PeriodicCallback(hub.show, SHOW_MS),
        ioloop.PeriodicCallback(hub.check_heartbeats, HEARTBEAT_MS),
        ioloop.PeriodicCallback(lambda: ended.set() if shutdown.requested(0.0) else None, SHOW_MS),
    ]
    for timer in timers:
        timer.start()
    try:
        ready(port)
        await ended.wait()
    finally:
        for timer in timers:
            timer.stop()
        server.stop()
        for page in list(hub.pages):
            page.close()
        await server.close_all_connections()
        hub.close()


def bind(port: int, address: str) -> socket.socket:
    """Return a socket that listens on a port; raises Refused if the port is in use or not allowed."""
    try:
        listening = socket.create_server((address, port), backlog=BACKLOG)
    except OSError as error:
        if error.errno not in (errno.EADDRINUSE, errno.EACCES):
            raise
        other = port + 1 if 1023 < port < 65535 else 8088
        text = f"Port {port} cannot be used: {os.strerror(error.errno)}. Choose another one with --port, for example {other}."
        raise Refused(Reason.BAD_VALUE, text) from error
    listening.setblocking(False)  # noqa: FBT003
    return listening


def application(context: Context) -> web.Application:
    """Return the Tornado application with all routes of the server."""
    shared = {"context": context}
    return web.Application(
        [
            ("/", Front, shared),
            ("/class", Projector, shared),
            ("/stop", Stopper, shared),
            ("/live", Live, shared),
            ("/pictures", Pictures, shared),
            (r"/static/([a-z.]+)", StaticFiles, {**shared, "path": str(STATIC)}),
        ],
        default_handler_class=Nothing,
        default_handler_args=shared,
        template_path=str(STATIC),
        xsrf_cookies=True,
        xsrf_cookie_kwargs={"samesite": "Strict", "httponly": True},
        websocket_ping_interval=PING_S,
        websocket_max_message_size=MESSAGE_MAX,
        log_function=lambda _: None,  # an access log would grow without limit
    )
