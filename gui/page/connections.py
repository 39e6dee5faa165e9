"""Limits of connections and of the log, so that a flood of requests uses up neither open files nor the disk."""

from __future__ import annotations

import contextlib
import logging
import time
from collections.abc import Callable, Iterator
from typing import Final

from tornado import httpserver, iostream

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
