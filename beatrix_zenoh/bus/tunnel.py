"""A port of this computer that leads to the router of a class: its user needs no account, and gets none.

Zenoh sends the same bytes over TCP and TLS, so that a tunnel which adds TLS lends a session of an account to a program
that must not read the private key.
"""

from __future__ import annotations

import asyncio
import contextlib
import socket
from typing import Self

from beatrix_zenoh import threads
from beatrix_zenoh.account import Account
from beatrix_zenoh.bus import credentials
from beatrix_zenoh.bus.endpoint import endpoints, parse_endpoint

HERE = "127.0.0.1"
CHUNK = 64 * 1024


class Tunnel:
    """Each connection to `endpoint` becomes one to the router, with an account. A `with` block ends all of them.

    Every program of this computer can use the port in the meantime.
    """

    def __init__(self, router: str, account: Account) -> None:
        """Listen, for a tunnel to the router at an endpoint, or at one of several separated by commas."""
        self._routers = [parse_endpoint(one) for one in endpoints(router)]
        self._context = credentials.client_context(account)
        self._connections: set[asyncio.Task[None]] = set()
        self._socket = socket.create_server((HERE, 0))
        self.endpoint = f"tcp/{HERE}:{self._socket.getsockname()[1]}"

    def __enter__(self) -> Self:
        self._loop = asyncio.new_event_loop()
        self._ended = asyncio.Event()
        self._thread = threads.start(self._run, "tunnel")
        return self

    def __exit__(self, *_error: object) -> None:
        self._loop.call_soon_threadsafe(self._ended.set)
        self._thread.join()

    def _run(self) -> None:
        with contextlib.closing(self._loop):
            self._loop.run_until_complete(self._serve())

    async def _serve(self) -> None:
        server = await asyncio.start_server(self._accept, sock=self._socket)
        await self._ended.wait()
        server.close()
        for connection in self._connections:
            connection.cancel()
        await asyncio.gather(*self._connections, return_exceptions=True)

    async def _accept(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        task = asyncio.current_task()
        assert task is not None
        self._connections.add(task)
        try:
            with contextlib.suppress(OSError, asyncio.CancelledError):
                await self._connect(reader, writer)
        finally:
            self._connections.discard(task)
            writer.transport.abort()

    async def _connect(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        first = await reader.read(CHUNK)
        if not first:
            return  # a probe: TLS accepts no session for 0.1 s after a connection without a handshake
        far_reader, far_writer = await self._open()
        far_writer.write(first)
        await asyncio.gather(_copy(reader, far_writer), _copy(far_reader, writer), return_exceptions=True)

    async def _open(self) -> tuple[asyncio.StreamReader, asyncio.StreamWriter]:
        """Connect to the router; raises OSError."""
        for protocol, host, port in self._routers:
            context = self._context if protocol == "tls" else None
            with contextlib.suppress(OSError):
                return await asyncio.open_connection(host, port, ssl=context)
        raise ConnectionError


async def _copy(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
    """Copy until one end is closed, then close the other."""
    try:
        while data := await reader.read(CHUNK):
            writer.write(data)
            await writer.drain()
    finally:
        writer.transport.abort()
