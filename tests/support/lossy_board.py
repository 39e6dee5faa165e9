"""A virtual board on a wire that loses, delays and forges frames, and a Board that is connected to it."""

from __future__ import annotations

import threading

from robots import until
from ticking_board import RealTimeTicker

from beatrix_zenoh.board.board import Board
from beatrix_zenoh.board.link import Decoder, encode
from beatrix_zenoh.board.virtual import Firmware, VirtualBoard


class LossyPort:
    """A virtual board whose wire can lose, delay or forge frames to the host."""

    name = "lossy:"
    boot_s = 0.0

    def __init__(self, board: VirtualBoard) -> None:
        self.board = board
        self.lose: list[int] = []
        self.unplugged = self.mute = False
        self.free = threading.Event()
        self.free.set()
        self.forged = b""
        self.instead = b""
        """Bytes that `read` returns instead of each lost frame."""
        self._decoder = Decoder()

    def write(self, data: bytes) -> bytes:
        if self.unplugged:
            raise OSError("unplugged")
        self.board.write(data)
        return b""  # replies are returned by `read`

    def wake(self) -> None:
        self.board.wake()

    def read(self, timeout_s: float) -> bytes:
        self.free.wait(10)
        if self.unplugged:
            raise OSError("unplugged")
        out, self.forged = self.forged, b""
        for frame in self._decoder.feed(self.board.read(timeout_s)):
            if self.mute:
                continue
            if frame.type in self.lose:
                self.lose.remove(frame.type)
                out += self.instead
            else:
                out += encode(frame.type, frame.seq, frame.payload)
        return out

    def close(self) -> None:
        """Keep the board running."""


class Rig:
    """A Board on a lossy wire."""

    def __init__(self) -> None:
        self.virtual = VirtualBoard(Firmware(boot=1, name="bea"))
        self.ticker = RealTimeTicker(self.virtual)
        self.port = LossyPort(self.virtual)
        self.board = Board(lambda: self.port, lambda _: None, lambda: None)
        self.board.start()
        assert self.board.wait_for(lambda _: True, 2.0)

    def rest(self) -> tuple[int, int, int]:
        """Wait until no arm has stepped for 0.2 s; return the positions of the arms."""
        seen: list[tuple[int, int, int]] = []

        def at_rest() -> bool:
            with self.virtual.lock:
                seen.append(self.virtual.firmware.steps())
            return len(seen) > 20 and seen[-1] == seen[-21]

        until(at_rest, "at rest")
        return seen[-1]

    def lost(self) -> None:
        """Wait until the board counts as lost."""
        until(lambda: not self.board.connected, "lost")

    def close(self) -> None:
        self.board.close()
        self.ticker.close()
        self.virtual.close()
