"""A virtual board for which a thread waits, as for a real board, so that a test can lose it."""

from __future__ import annotations

from hw_node.body import VirtualHardware


class ThreadedHardware(VirtualHardware):
    """A robot whose node reads the bytes of its virtual board in a thread of their own."""

    def timed_port(self) -> None:
        """Give the board no turns on the thread of its node."""
