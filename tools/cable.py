"""A TCP relay in place of a network cable to a router: records the bytes of clients, and can be cut or unplugged."""

from __future__ import annotations

import contextlib
import socket
import threading
from typing import Final, Self

CHUNK: Final = 65536
LOOK_S: Final = 0.1
"""Longest time (s) until a thread of the relay notices that the relay is closed."""


class Cable:
    """A port of this computer whose connections end at a router's port."""

    def __init__(self, host: str, port: int) -> None:
        self.recorded: list[bytearray] = []
        """bytes that clients have sent, by connection"""
        self._router = (host, port)
        self._server = socket.create_server(("127.0.0.1", 0))
        self.port: int = self._server.getsockname()[1]
        self._plugged, self._closed = threading.Event(), threading.Event()
        self._plugged.set()
        self._open: list[socket.socket] = []
        self._threads = [threading.Thread(target=self._accept)]
        self._threads[0].start()

    def unplug(self) -> None:
        """Stop passing data on; the connections stay open at both ends."""
        self._plugged.clear()

    def plug(self) -> None:
        """Pass data on again."""
        self._plugged.set()

    def cut(self) -> None:
        """Close all connections; new connections are accepted."""
        while self._open:
            with contextlib.suppress(OSError):
                self._open.pop().shutdown(socket.SHUT_RDWR)

    def close(self) -> None:
        """End all connections and threads."""
        self._closed.set()
        self._plugged.set()
        self.cut()
        for thread in self._threads:
            thread.join()
        self._server.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exc: object) -> None:
        self.close()

    def _accept(self) -> None:
        self._server.settimeout(LOOK_S)
        while not self._closed.is_set():
            try:
                client, _ = self._server.accept()
            except TimeoutError:
                continue
            try:
                router = socket.create_connection(self._router, 5.0)
            except OSError:  # there is no router: close the connection of the client
                client.close()
                continue
            sent = bytearray()
            self.recorded.append(sent)
            self._open += [client, router]
            for source, sink, record in ((client, router, sent), (router, client, None)):
                self._threads.append(threading.Thread(target=self._pass_on, args=(source, sink, record)))
                self._threads[-1].start()

    def _pass_on(self, source: socket.socket, sink: socket.socket, record: bytearray | None) -> None:
        source.settimeout(LOOK_S)
        with source, contextlib.suppress(OSError):
            while not self._closed.is_set():
                try:
                    data = source.recv(CHUNK)
                except TimeoutError:
                    continue
                while not (self._plugged.wait(LOOK_S) or self._closed.is_set()):
                    pass
                if not data:
                    break
                if record is not None:
                    record += data
                sink.sendall(data)
        with contextlib.suppress(OSError):
            sink.shutdown(socket.SHUT_RDWR)
