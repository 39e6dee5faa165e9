"""A board on a pseudo-terminal that can be plugged in and unplugged: the real firmware behind a real port."""

from __future__ import annotations

import contextlib
import os
import select
import threading
import tty
from pathlib import Path
from typing import Self

from ticking_board import RealTimeTicker

from beatrix_zenoh.board.virtual import Firmware, VirtualBoard


class PtyBoard:
    """The firmware in WebAssembly, in real time, behind the device `path`."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.boots = 0
        self._over = threading.Event()
        self._threads: list[threading.Thread] = []
        self.plug()

    def plug(self) -> None:
        """Create the port and start the board: motors off, home unknown."""
        self.boots += 1
        self._over = threading.Event()
        self._master, slave = os.openpty()
        tty.setraw(slave)
        self._slave = slave  # keep it open, so that the master does not hang up between two programs
        self.path.unlink(missing_ok=True)
        self.path.symlink_to(os.ttyname(slave))
        self.board = VirtualBoard(Firmware(boot=self.boots, name="bea"))
        self._ticker = RealTimeTicker(self.board)
        self._threads = [threading.Thread(target=self._receive), threading.Thread(target=self._send)]
        for thread in self._threads:
            thread.start()

    def _receive(self) -> None:
        while not self._over.is_set():
            if select.select([self._master], [], [], 0.05)[0]:
                with contextlib.suppress(OSError):
                    self.board.write(os.read(self._master, 4096))

    def _send(self) -> None:
        while not self._over.is_set():
            data = self.board.read(0.05)
            if data:
                with contextlib.suppress(OSError):
                    os.write(self._master, data)

    def unplug(self) -> None:
        """Remove the port and end the board."""
        self.path.unlink(missing_ok=True)
        self._over.set()
        for thread in self._threads:
            thread.join()
        self._ticker.close()
        self.board.close()
        os.close(self._slave)
        os.close(self._master)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exc: object) -> None:
        if not self._over.is_set():
            self.unplug()
