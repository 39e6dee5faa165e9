"""The port for programs of 2023: passes lines between terminal, controller and board.

The firmware understands the lines and answers them (decision 0013). The port queues them, applies the access
rules and STOP, and answers every line in order, even if the board is lost.
"""

from __future__ import annotations

from collections.abc import Callable

from beatrix_zenoh.board.board import Board
from beatrix_zenoh.contract._generated.serial import Text, TextWarning
from beatrix_zenoh.legacy.interface import NodeInterface
from beatrix_zenoh.legacy.line import Effect, effect_of
from beatrix_zenoh.legacy.line_queue import LineQueue
from beatrix_zenoh.legacy.link import TextLink
from beatrix_zenoh.legacy.terminal import Terminal

ECHOED = (b"ACK", b"NACK")
"""Lines that a terminal with echo returns to the port; answers to them would be echoed again, without end."""


class TextPort:
    """Receives the lines of a terminal; `lines` is their queue, used on the controller's thread through `post`."""

    def __init__(
        self,
        terminal: Terminal,
        board: Board,
        node: NodeInterface,
        post: Callable[[Callable[[], None]], None],
    ) -> None:
        self._terminal, self._node, self._post = terminal, node, post
        self._link = TextLink(board)
        self.lines = LineQueue(terminal.write, self._link, node)

    # -- called on the terminal's thread ----------------------------------------------------------------

    def opened(self) -> None:
        """Handle a program that has opened the terminal."""
        self._post(self._opened)

    def _opened(self) -> None:
        self.lines.program_opened()
        self._terminal.begin_answers()

    def received(self, line: bytes) -> None:
        """Queue a line of the program, unless it is an echoed answer; report STOP to the node at once."""
        if effect_of(line) is Effect.STOP:
            self._node.stop_pressed()
        if line not in ECHOED:
            self._post(lambda: self.lines.take(line))

    def closed(self) -> None:
        """Handle a program that has closed the terminal, or has ended."""
        self._post(self.lines.program_closed)

    # -- called on the board's thread -------------------------------------------------------------------

    def board_sent(self, seq: int, frame: Text | TextWarning) -> None:
        """Handle a line of an answer, or a warning, from the board; `seq` counts both."""
        opening = self._link.openings
        self._post(lambda: self.lines.receive(seq, frame, opening))

    # -- called by the node -----------------------------------------------------------------------------

    def start(self) -> None:
        """Begin to receive lines."""
        self._terminal.start(self)

    def close(self) -> None:
        """Close the terminal."""
        self._terminal.close()
