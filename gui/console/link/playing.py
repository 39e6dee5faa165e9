"""Plays of choreographies, files and poses, on a thread of their own until the end, a newer request or STOP."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, replace

from beatrix_zenoh.client.robot import Robot
from beatrix_zenoh.client.twin import Twin
from beatrix_zenoh.contract.errors import BeatrixError
from gui.console.link.jobs import Jobs
from gui.console.link.newest import Newest
from gui.console.link.outcomes import accepted, done, failed
from gui.console.state.actions import Outcome, Play

END_S = 1.0
"""Longest time that a newer motion waits for the end of the play that it replaces."""


@dataclass(eq=False)
class PlayJob:
    """One play, from the request to its end."""

    action: Play
    robots: Twin | Robot
    title: str
    ending: BeatrixError | None = None
    """why the play must end; None: it may go on"""
    pose: int = -1
    """number of the pose that began last, from 0; -1: none"""

    @property
    def side(self) -> str:
        """Twin of its outcomes; empty: both."""
        return "" if isinstance(self.robots, Twin) else self.robots.side

    def check(self) -> None:
        """Raise `ending` if the play must end."""
        if self.ending is not None:
            raise self.ending


class Playing:
    """Plays the newest choreography; methods except `wait_ended` return at once."""

    def __init__(self, jobs: Jobs, report: Callable[[Outcome], None]) -> None:
        self._jobs, self._report = jobs, report
        self._newest: Newest[PlayJob] = Newest()

    @property
    def title(self) -> str:
        """Title of the current play; empty if there is none."""
        job = self._newest.job
        return "" if job is None else job.title

    @property
    def pose(self) -> int:
        """Number of the pose of the window that the current play began last, from 0; -1: none."""
        job = self._newest.job
        return -1 if job is None or not job.action.poses else job.pose

    def begin(self, action: Play, robots: Twin | Robot, clear: Callable[[], None]) -> None:
        """Start a play, which replaces the current one; `clear` ends other motions, on the play's thread."""
        job = PlayJob(action, robots, action.title)
        self._newest.begin(job)
        self._jobs.put("play", lambda: self._run(job, clear))

    def end(self, why: BeatrixError) -> None:
        """End the current play; its robots are stopped, unless a newer request replaces the play."""
        job = self._newest.job
        if job is not None:
            job.ending = job.ending or why

    def wait_ended(self, timeout_s: float = END_S) -> bool:
        """Wait for the end of the current play; return False on timeout."""
        return self._newest.wait_ended(timeout_s)

    # -- the play's thread --------------------------------------------------------------------------

    def _run(self, job: PlayJob, clear: Callable[[], None]) -> None:
        began_s = time.monotonic()
        try:
            job.check()
            clear()
            from gui.console.link.choreographies import prepared  # noqa: PLC0415  # numpy and the planner would delay the window

            def begun(rounds: int = 0) -> None:
                told = accepted(job.action.row, job.side, f"{job.title}: checked.", lasts_s)
                self._report(replace(told, rounds=rounds))

            def posed(number: int) -> None:
                job.pose = number

            lasts_s, perform = prepared(job.action, job.robots, job.check, begun, posed)
            job.check()
            begun()
            perform()
            outcome = done(job.action.row, job.side, f"{job.title}: played.", time.monotonic() - began_s)
        except BeatrixError as error:
            outcome = failed(job.action.row, job.side, error)
        finally:
            self._newest.finish(job)
        self._report(outcome)
