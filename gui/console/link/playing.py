"""Plays of choreographies, files and poses, until the end, a newer request or STOP."""

from __future__ import annotations

from dataclasses import replace

from beatrix_zenoh.client.robot import Robot
from beatrix_zenoh.client.twin import Twin
from gui.console.link.outcomes import accepted
from gui.console.link.programs import Program, Report
from gui.console.state.actions import Play


class Playing(Program):
    """One play."""

    QUEUE, WAIT_S = "play", 1.0

    def __init__(self, action: Play, robots: Twin | Robot) -> None:
        """Store the arguments."""
        super().__init__(action.row, "" if isinstance(robots, Twin) else robots.side)
        self._action, self._robots, self.title = action, robots, action.title
        self.pose = -1
        """number of the pose of the window that began last, from 0; -1: none"""

    def perform(self, report: Report) -> str:
        """Check all of the play, then play it."""
        from gui.console.link.choreographies import prepared  # noqa: PLC0415  # numpy and the planner would delay the window

        def begun(rounds: int = 0) -> None:
            told = accepted(self.row, self.side, f"{self.title}: checked.", lasts_s)
            report(replace(told, rounds=rounds))

        def posed(number: int) -> None:
            if self._action.poses:
                self.pose = number

        lasts_s, play = prepared(self._action, self._robots, self.check, begun, posed)
        self.check()
        begun()
        play()
        return f"{self.title}: played."
