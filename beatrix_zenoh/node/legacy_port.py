"""The port of programs of 2023: passes lines between terminal, controller and board."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

from beatrix_zenoh.bus import Sessions
from beatrix_zenoh.contract._generated.serial import Text, TextWarning
from beatrix_zenoh.legacy import Terminal
from beatrix_zenoh.node.access import Operation
from beatrix_zenoh.node.board_watch import BoardWatch, Observer
from beatrix_zenoh.node.controller import MotionController
from beatrix_zenoh.node.interfaces import Component, HardwareInterface
from beatrix_zenoh.node.legacy_driving import Driving
from beatrix_zenoh.node.legacy_lines import LineQueue, operation_of
from beatrix_zenoh.node.requests import Requests

ECHOED: Final = (b"ACK", b"NACK")
"""Lines that a terminal with echo returns to the port; answers to them would be echoed again, without end."""


class LegacyPort(Component):
    """Receives the lines of a terminal; their queue is used on the controller's thread."""

    def __init__(
        self,
        requests: Requests,
        controller: MotionController,
        board_watch: BoardWatch,
        hardware: HardwareInterface,
        terminal: Terminal,
        has_router: Callable[[], bool],
    ) -> None:
        """`has_router`: as for `Driving`."""
        self._terminal, self._post = terminal, requests.queue.post_event
        self._driving = Driving(requests.events, controller, hardware, has_router)
        self._lines = LineQueue(terminal.write, board_watch.board, self._driving)
        controller.on_stop.append(self._lines.refuse_waiting_motions)
        board_watch.observe(Observer(self._lines.observe, lambda: False, urgent=False))
        board_watch.board.on_text = self._board_sent

    def start(self, sessions: Sessions) -> None:  # noqa: ARG002
        self._terminal.start(self)

    def close(self) -> None:
        """Close the terminal; the controller stops the arms."""
        self._terminal.close()

    # -- called on the terminal's thread ----------------------------------------------------------------

    def opened(self) -> None:
        """Handle a program that has opened the terminal."""
        self._post(self._opened)

    def _opened(self) -> None:
        self._lines.program_opened()
        self._terminal.begin_answers()

    def received(self, line: bytes) -> None:
        """Queue a line of the program, unless it is an echoed answer; block new motions at once if it is STOP."""
        if operation_of(line) is Operation.STOP:
            self._driving.stop_pressed()
        if line not in ECHOED:
            self._post(lambda: self._lines.take(line))

    def closed(self) -> None:
        """Handle a program that has closed the terminal, or has ended."""
        self._post(self._lines.program_closed)

    # -- called on the board's thread -------------------------------------------------------------------

    def _board_sent(self, frame: Text | TextWarning) -> None:
        """Handle a line of an answer, or a warning, from the board."""
        opening = self._lines.openings
        self._post(lambda: self._lines.receive(frame, opening))
