"""The server of the control page; limits keep a flood of requests from using up open files."""

from __future__ import annotations

import asyncio
import contextlib
import errno
import logging
import os
import socket
from collections.abc import Callable
from typing import Final

from tornado import httpserver, ioloop, iostream, web

from beatrix_zenoh import memory
from beatrix_zenoh.contract.errors import bad_value
from beatrix_zenoh.settings import Settings
from beatrix_zenoh.shutdown import Shutdown
from gui.page.gallery import Gallery, GalleryList, GalleryPicture
from gui.page.handlers import Context, Front, Nothing, Projector, StaticFiles, Stopper
from gui.page.hub import Hub
from gui.page.mesh import HeadMesh
from gui.page.protection import Login
from gui.page.shelf import Shelf
from gui.page.sockets import Live, Pictures
from gui.page.static_files import STATIC, StaticFolder

CONNECTIONS_MAX: Final = 192
"""Largest number of connections: a page needs two, and a system may allow a process only 256 open files."""
ADDRESS_MAX: Final = 128
"""Largest number of connections of one address: a class may be behind one."""
LOOPBACK, ALL = "127.0.0.1", "0.0.0.0"  # noqa: S104  # only with --lan, behind a PIN
SHOW_MS: Final = 100
"""Period of the views that pages get."""
HEARTBEAT_MS: Final = 50
"""Period of the check for heartbeats."""
POSE_MS: Final = 50
"""Period of the poses that pages get of a robot that moves."""
PING_S: Final = 5.0
"""Period of pings to each page; the connection of a page that does not reply is closed."""
REQUEST_S: Final = 20.0
"""Longest time for the body of a request to arrive, and for a connection to be idle."""
BACKLOG: Final = 128
"""Largest number of connections that may wait to be accepted."""
BODY_MAX: Final = 4096
"""Largest request, bytes."""
LIMITS: Final = {
    "max_body_size": BODY_MAX,
    "max_header_size": 4 * BODY_MAX,
    "body_timeout": REQUEST_S,
    "idle_connection_timeout": REQUEST_S,
}
MESSAGE_MAX: Final = 131072
"""Largest message of a page, bytes: a program, whose quotes double in JSON."""


class Server(httpserver.HTTPServer):
    """An HTTP server that limits its connections, web sockets included."""

    def __init__(self, *args: object, **kwargs: object) -> None:
        """Take the arguments of `HTTPServer`, which Tornado has passed to `initialize` before this call."""
        super().__init__(*args, **kwargs)
        self._open: dict[iostream.IOStream, str] = {}

    def handle_stream(self, stream: iostream.IOStream, address: tuple[str, int]) -> None:
        """Serve a connection, or close it at once if there are too many."""
        self._open = {one: sender for one, sender in self._open.items() if not one.closed()}
        if too_many([*self._open.values()], address[0]):
            stream.close()
        else:
            self._open[stream] = address[0]
            super().handle_stream(stream, address)


def too_many(addresses: list[str], address: str) -> bool:
    """Return whether a connection of `address` is one too many, given the addresses of all open ones."""
    return addresses.count(address) >= ADDRESS_MAX or len(addresses) >= CONNECTIONS_MAX


async def serve(
    settings: Settings,
    port: int,
    *,
    login: Login,
    lan: bool,
    ready: Callable[[int], None],
    shutdown: Shutdown,
) -> None:
    """Serve the page until a shutdown is requested.

    Args:
        settings: router and seat.
        port: TCP port; 0: any free port.
        login: the browsers that may use the page.
        lan: whether to serve other computers, too.
        ready: called with the port when the page is served.
        shutdown: ends the server.

    Raises:
        NoAnswer: NO_ROUTER.
        Refused: BAD_VALUE, another program uses the port, or the system does not allow it.
    """
    logging.getLogger("tornado").setLevel(logging.ERROR)  # each bad request would be a warning, without limit
    with contextlib.closing(bind(port, ALL if lan else LOOPBACK)) as listening:
        shelf = Shelf(login.folder / "programs")
        hub = Hub(settings, login, ioloop.IOLoop.current().add_callback, shelf)
        port = listening.getsockname()[1]
        server = Server(application(Context(hub, login, f"beatrix-{port}", StaticFolder.read())), **LIMITS)
        server.add_socket(listening)
        await _run(server, hub, lambda: ready(port), shutdown)


async def _run(server: Server, hub: Hub, ready: Callable[[], None], shutdown: Shutdown) -> None:
    """Send views and check heartbeats until a shutdown is requested, then close all connections."""
    ended = asyncio.Event()
    timers = [
        ioloop.PeriodicCallback(lambda: ended.set() if shutdown.requested(0.0) else None, SHOW_MS),
        ioloop.PeriodicCallback(hub.show, SHOW_MS),
        ioloop.PeriodicCallback(hub.check_heartbeats, HEARTBEAT_MS),
        ioloop.PeriodicCallback(hub.poses.send, POSE_MS),
    ]
    for timer in timers:
        timer.start()
    try:
        ready()
        memory.keep_loaded()
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
        raise bad_value(text) from error
    listening.setblocking(False)  # noqa: FBT003
    return listening


def application(context: Context) -> web.Application:
    """Return the Tornado application with all routes of the server."""
    pictures = {"gallery": Gallery(context.login.folder / "gallery")}
    return web.Application(
        [
            ("/", Front),
            ("/class", Projector),
            ("/stop", Stopper),
            ("/live", Live),
            ("/pictures", Pictures),
            (context.static.root + r"/([a-z0-9_./-]+)", StaticFiles),
            (r"/static/(vendor/[a-z0-9_./-]+)", StaticFiles),  # a path that outlives changes of the page
            ("/head.json", HeadMesh),
            ("/gallery", GalleryList, pictures),
            ("/gallery/([^/]+)/([0-9a-z.]+)", GalleryPicture, pictures),
        ],
        default_handler_class=Nothing,
        context=context,
        template_path=str(STATIC),
        cookie_secret=context.login.secret,
        xsrf_cookies=True,
        xsrf_cookie_kwargs={"samesite": "Strict", "httponly": True},
        websocket_ping_interval=PING_S,
        websocket_max_message_size=MESSAGE_MAX,
        log_function=lambda _: None,  # an access log would grow without limit
    )
