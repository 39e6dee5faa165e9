"""Those who pressed STOP and wait until the arms rest, but not for ever."""

from __future__ import annotations

import time

from beatrix_zenoh._generated.messages import Reason
from beatrix_zenoh.board.board import Board
from beatrix_zenoh.drive import Arms
from beatrix_zenoh.errors import NoAnswer
from beatrix_zenoh.node.answers import Asker, at_rest, command_reply, lost_while_stopping, not_stopped

PATIENCE_S = 2.0
"""Arms at their highest speed rest long before; whoever pressed STOP listens for a second more."""
STILL_MOVING = NoAnswer(Reason.FAULT, "The board has taken it and says that the arms still move.")


class Stopping:
    """Filled and told on the driver's thread; `overdue` may be asked on any."""

    def __init__(self, board: Board) -> None:
        self._board = board
        self._askers: list[Asker] = []
        self._until_s = float("inf")

    def __bool__(self) -> bool:
        return bool(self._askers)

    def add(self, asker: Asker) -> None:
        """Another one waits."""
        if not self._askers:
            self._until_s = time.monotonic() + PATIENCE_S
        self._askers.append(asker)

    def overdue(self) -> bool:
        """They have waited long enough."""
        return bool(self._askers) and time.monotonic() > self._until_s

    def tell(self, arms: Arms, *, moving: bool) -> None:
        """Answer all of them; arms in rad."""
        link = self._board.link
        if not link.connected:
            error = lost_while_stopping(reset=link.reset)
            self._answer(error.reason, error.message, arms)
        elif moving:
            error = not_stopped(STILL_MOVING)
            self._answer(error.reason, error.message, arms)
        else:
            self._answer(Reason.OK, at_rest(self._board, "Stopped", arms), arms)

    def close(self, arms: Arms) -> None:
        """The node ends before the arms rest."""
        self._answer(Reason.SHUTDOWN, "The node is closing.", arms)

    def _answer(self, reason: Reason, text: str, arms: Arms) -> None:
        askers, self._askers = self._askers, []
        for asker in askers:
            asker.answer(command_reply(reason, text, arms))
            asker.finish()
