"""The interface of the node that the text port uses."""

from __future__ import annotations

from typing import Protocol

from beatrix_zenoh._generated.messages import Detail, Phase
from beatrix_zenoh.legacy.line import Cause, Effect


class NodeInterface(Protocol):
    """The node behind the port; called on the controller's thread, except `stop_pressed`."""

    def program_began(self) -> None:
        """Note that a program has opened the port."""

    def authorize(self, effect: Effect) -> None:
        """Permit an action of the program now; with MOVE it takes the lease.

        Raises:
            BeatrixError: the program may not act; the error gives the reason.
        """

    def move_declined(self) -> None:
        """Restart the pause after STOP: the text port refused a motion and did not call `authorize`."""

    def move_refused(self) -> bool:
        """Note that the firmware refused or ended a motion.

        If no arm has moved, give the lease back and return True.
        """

    def moves_ended(self) -> None:
        """Note that no motion of the program runs or waits."""

    def set_home(self) -> None:
        """Prepare for @CALNOW, which sets the robot's home."""

    def stop_pressed(self) -> None:
        """Note that the program has sent @STOPALL; called on the terminal's thread, before the line is queued."""

    def stop_sent(self) -> None:
        """Note that @STOPALL was sent to the firmware."""

    def warn(self, text: str) -> None:
        """Show a sentence in the status for some seconds."""

    def record(
        self,
        effect: Effect,
        word: str,
        outcome: Cause,
        *,
        phase: Phase | None = None,
        detail: Detail | None = None,
        duration_s: float = 0.0,
    ) -> None:
        """Record the outcome of a line that begins with `word` as an event."""
