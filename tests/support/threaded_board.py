"""A virtual board for which a thread waits, as for a real board, so that a test can lose it."""

from __future__ import annotations

import threading
import time

from beatrix_zenoh.board.state import Port
from beatrix_zenoh.board.virtual import TimedPort
from hw_node.body import VirtualHardware


class ThreadedPort:
    """The port of a virtual board, whose time passes in the thread that waits for its bytes."""

    def __init__(self, port: TimedPort) -> None:
        self._port, self.name, self.boot_s = port, port.name, port.boot_s
        self.write, self.wake = port.write, port.wake
        self._woken, self._closed = threading.Event(), False
        port.notify = self._woken.set

    def read(self, timeout_s: float) -> bytes:
        """Return what the board sends, after at most `timeout_s`; empty after `close`."""
        end_s = time.monotonic() + timeout_s
        while True:
            self._woken.wait(max(0.0, min(self._port.due_s(), end_s) - time.monotonic()))
            self._woken.clear()
            data = self._port.read(0)
            if data or self._closed or time.monotonic() >= end_s:
                return data

    def close(self) -> None:
        """Close the port and wake its reader."""
        self._closed = True
        self._port.close()
        self._woken.set()


class ThreadedHardware(VirtualHardware):
    """A robot whose node reads the bytes of its virtual board in a thread of their own."""

    def __init__(self, name: str) -> None:
        super().__init__(name)
        self._threaded = ThreadedPort(self._port)

    def open_port(self) -> Port:
        return self._threaded

    def timed_port(self) -> None:
        """Give the board no turns on the thread of its node."""
