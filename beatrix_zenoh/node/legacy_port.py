"""The port of programs of 2023 as a component of the node."""

from __future__ import annotations

from beatrix_zenoh.bus import Sessions
from beatrix_zenoh.legacy import Terminal, TextPort
from beatrix_zenoh.node.board_watch import Observer
from beatrix_zenoh.node.commands import CommandHandler
from beatrix_zenoh.node.component import Component, Context
from beatrix_zenoh.node.stop import StopHandler
from beatrix_zenoh.node.text_driving import TextDriving


class LegacyPort(Component):
    """Passes lines between a terminal and the board."""

    def __init__(
        self, context: Context, stop: StopHandler, commands: CommandHandler, terminal: Terminal
    ) -> None:
        self._sessions: Sessions | None = None
        board_watch = context.board_watch
        driving = TextDriving(context, stop, commands, self._has_router)
        self._port = TextPort(terminal, board_watch.board, driving, context.queue.post_event)
        lines = self._port.lines
        stop.on_stop(lines.refuse_waiting_motions)
        board_watch.observe(Observer(lines.observe, lines.overdue, urgent=False))
        board_watch.on_text(self._port.board_sent)

    def _has_router(self) -> bool:
        return self._sessions is not None and self._sessions.control.connected

    def start(self, sessions: Sessions) -> None:
        self._sessions = sessions
        self._port.start()

    def close(self) -> None:
        """Close the terminal; the controller stops the arms."""
        self._port.close()
