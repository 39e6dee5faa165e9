"""A thread that lets the time of a virtual board pass, for tests that read from the board themselves."""

from __future__ import annotations

import threading

from beatrix_zenoh import threads
from beatrix_zenoh.board.virtual import RealTime, VirtualBoard

SHORTEST_S = 0.001
"""Shortest pause (s) between two turns, in which other threads run."""


class RealTimeTicker:
    """Advances a board in real time until `close`."""

    def __init__(self, board: VirtualBoard) -> None:
        self._time = RealTime(board)
        self._closing = threading.Event()
        self._thread = threads.start(self._run, "virtual-time")

    def _run(self) -> None:
        while not self._closing.wait(max(SHORTEST_S, self._time.wait_s())):
            self._time.turn(written=False)

    def close(self) -> None:
        """Stop the board's time and wait for the end of the thread."""
        self._closing.set()
        self._thread.join()
