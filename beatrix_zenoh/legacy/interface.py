"""The interface of the node that the text port uses."""

from __future__ import annotations

from typing import Protocol

from beatrix_zenoh.contract._generated.messages import Detail, Phase
from beatrix_zenoh.legacy.line import Effect, LineCause


class NodeInterface(Protocol):
    """The node behind the port; its methods are called on the controller's thread, except `stop_pressed`."""

    def program_began(self) -> None:
        """Record that a program has opened the port."""

    def authorize(self, effect: Effect) -> None:
        """Check that the program may act now; with MOVE it becomes the holder.

        Raises:
            BeatrixError: the program may not act; the error gives the reason.
        """

    def move_declined(self) -> None:
        """Restart the pause after STOP: the text port refused a motion and did not call `authorize`."""

    def move_refused(self) -> bool:
        """Handle a motion that the firmware refused or ended; return whether no arm has moved.

        If none has moved, restore the previous holder.
        """

    def moves_ended(self) -> None:
        """Record that no motion of the program is running or waiting."""

    def set_home(self) -> None:
        """Prepare for a @CALNOW that sets the robot's home."""

    def stop_pressed(self) -> None:
        """Record that the program has sent @STOPALL; called on the terminal's thread, before the line is queued."""

    def stop_sent(self) -> None:
        """Record that @STOPALL was sent to the firmware."""

    def warn(self, text: str) -> None:
        """Show a sentence in the status for some seconds."""

    def record(
        self,
        effect: Effect,
        word: str,
        outcome: LineCause,
        *,
        phase: Phase | None = None,
        detail: Detail | None = None,
        duration_s: float = 0.0,
    ) -> None:
        """Record the outcome of a line that begins with `word` as an event."""
