"""A thread that lets the time of a virtual board pass, for tests that read from the board themselves."""

from __future__ import annotations

import threading
import time

from beatrix_zenoh import threads
from beatrix_zenoh.board.virtual import RealTime, VirtualBoard

PERIOD_S = 0.005


class RealTimeTicker:
    """Advances a board in real time until `close`."""

    def __init__(self, board: VirtualBoard) -> None:
        self._time = RealTime(board)
        self._closing = threading.Event()
        self._thread = threads.start(self._run, "virtual-time")

    def _run(self) -> None:
        begin_s = time.monotonic()
        while not self._closing.wait(PERIOD_S - (time.monotonic() - begin_s) % PERIOD_S):
            self._time.turn(written=False)

    def close(self) -> None:
        """Stop the board's time and wait for the end of the thread."""
        self._closing.set()
        self._thread.join()
