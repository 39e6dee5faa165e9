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

from beatrix_zenoh.board.link import Decoder
from beatrix_zenoh.board.virtual import Firmware, VirtualBoard
from beatrix_zenoh.contract._generated.serial import FrameType


class PtyBoard:
    """The firmware in WebAssembly, in real time, behind the device `path`."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.boots = 0
        self.deaf = False
        self.lost_text = 0
        """Number of the TEXT frame that will be lost: 1 is the next, 0 none."""
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
                    data = os.read(self._master, 4096)
                    if not self.deaf:
                        self.board.write(data)

    def _send(self) -> None:
        while not self._over.is_set():
            data = self.board.read(0.05)
            if data and not self.deaf:
                with contextlib.suppress(OSError):
                    os.write(self._master, self._arriving(data))

    def _arriving(self, data: bytes) -> bytes:
        """Return the bytes without lost frames; the board returns whole frames."""
        kept = b""
        for block in data.split(b"\0"):
            text = any(frame.type == FrameType.TEXT for frame in Decoder().feed(block + b"\0"))
            if text and self.lost_text == 1:
                self.lost_text = 0
                continue
            self.lost_text -= text and self.lost_text > 0
            kept += block + b"\0"
        return kept

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
