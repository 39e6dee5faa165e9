"""Motions of both robots: previewed, made by the simulation, and after the lead sent to the hardware."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Final

from beatrix_zenoh.client.plan import Plan
from beatrix_zenoh.client.twin import Twin
from beatrix_zenoh.client.twin_motion import TwinMotion
from beatrix_zenoh.contract._generated.messages import MotionQuery, PoseQuery, Reason
from beatrix_zenoh.contract.errors import BeatrixError, Refused
from gui.console.link.jobs import Jobs
from gui.console.link.outcomes import WindowError, accepted, done, failed, replaced
from gui.console.state.actions import Outcome
from gui.console.state.world import PlanPhase, PlanProgress

BOTH = ""
"""`Outcome.side` of a motion of both robots."""
REST_S: Final = 5.0
"""How long a motion is previewed again because a robot still moves: a preview is valid only from where it began."""
AGAIN_S: Final = 0.05
"""Time between two previews of a motion."""


@dataclass(eq=False)
class PlanJob:
    """One motion of both robots, from the request to its end."""

    row: int
    twin: Twin
    query: MotionQuery | PoseQuery
    lead_s: float
    clear: Callable[[], None]
    """ends motions that must not run beside this motion; called before this motion is sent"""
    plan: Plan | None = None
    motion: TwinMotion | None = None
    """the motion, after it was committed"""
    dropped: BeatrixError | None = None
    """why the motion must not begin or go on; None: it may"""
    reported: bool = False
    """whether the last outcome of the motion was reported"""
    over: threading.Event = field(default_factory=threading.Event)
    """set when the motion must not begin or go on"""

    def cancel(self, why: BeatrixError) -> None:
        """End the motion without waiting: nothing more is sent, and moving robots are stopped."""
        self.dropped = self.dropped or why
        self.over.set()
        motion = self.motion or (None if self.plan is None else self.plan.motion)
        if motion is not None:
            motion.end(why)


class Plans:
    """Carries out the newest motion of both robots; methods return at once. Any thread may call them."""

    def __init__(self, jobs: Jobs, report: Callable[[Outcome], None]) -> None:
        self._jobs, self._report = jobs, report
        self._lock = threading.Lock()
        self._trying: PlanJob | None = None
        """the newest job, until it is committed"""
        self._moving: PlanJob | None = None
        """the job that was committed last, until its end"""

    def send(
        self, row: int, twin: Twin, query: MotionQuery | PoseQuery, lead_s: float, clear: Callable[[], None]
    ) -> None:
        """Preview a motion and commit it; it replaces a motion that is being previewed or waits for its lead."""
        job = PlanJob(row, twin, query, lead_s, clear)
        self.drop_trying(replaced())
        with self._lock:
            self._trying = job
        self._jobs.put("plans", lambda: self._run(job))

    def progress(self) -> PlanProgress | None:
        """Return the progress of the newest motion; None if none is under way."""
        trying, moving = self._trying, self._moving
        if trying is not None:
            plan = trying.plan
            if plan is None:
                return PlanProgress(PlanPhase.TRYING, lead_s=trying.lead_s)
            return _progress(PlanPhase.TRYING, plan, trying.lead_s, trying.lead_s)
        if moving is None or moving.plan is None or moving.motion is None or moving.motion.done():
            return None
        phase = PlanPhase.SENT if moving.motion.hardware_sent else PlanPhase.LEADING
        return _progress(phase, moving.plan, moving.lead_s, moving.motion.countdown_s)

    def send_now(self) -> None:
        """Send the waiting motion to the hardware now."""
        moving = self._moving
        if moving is not None and moving.motion is not None:
            moving.motion.send_now()

    def abort(self) -> None:
        """Stop the simulation and keep the hardware unmoved; if the motion was sent to the hardware, stop both."""
        self.drop(WindowError(Reason.STOPPED, "result.aborted"))

    def drop(self, why: BeatrixError) -> None:
        """End the plan that is being previewed, and the one that is carried out."""
        self.drop_trying(why)
        moving = self._moving
        if moving is not None:
            moving.cancel(why)  # `_ended` reports the outcome

    def drop_trying(self, why: BeatrixError) -> None:
        """End the plan that is still being previewed."""
        with self._lock:
            job, self._trying = self._trying, None
        if job is not None:
            job.cancel(why)
            self._finish(job, failed(job.row, BOTH, why))

    def drop_leading(self, why: BeatrixError) -> None:
        """End the committed plan, unless its motion was sent to the hardware already."""
        moving = self._moving
        if moving is not None and moving.motion is not None and not moving.motion.hardware_sent:
            moving.cancel(why)

    def _finish(self, job: PlanJob, outcome: Outcome) -> None:
        with self._lock:
            first, job.reported = not job.reported, True
            if self._trying is job:
                self._trying = None
            if self._moving is job:
                self._moving = None
        if first:
            self._report(outcome)

    # -- one after the other -----------------------------------------------------------------------

    def _run(self, job: PlanJob) -> None:
        if job.dropped is not None:
            return
        began_s = time.monotonic()
        try:
            begun = _begin(job)
        except BeatrixError as error:
            self._finish(job, failed(job.row, BOTH, _explained(error)))
            return
        if begun is None:
            return
        plan, motion = begun
        with self._lock:
            job.motion = motion
            self._moving = job
            if self._trying is job:
                self._trying = None
        if job.dropped is not None:  # another thread dropped it during the commit
            job.cancel(job.dropped)
        if not job.reported:
            self._report(accepted(job.row, BOTH, plan.verdict, plan.duration + job.lead_s))
        motion.add_done_callback(lambda motion: self._ended(job, motion, time.monotonic() - began_s))

    def _ended(self, job: PlanJob, motion: TwinMotion, took_s: float) -> None:
        error = motion.exception(0.0)
        if error is None:
            self._finish(job, done(job.row, BOTH, motion.result(0.0).hw.message, took_s))
        elif isinstance(error, BeatrixError):
            self._finish(job, failed(job.row, BOTH, _explained(error)))
        else:
            raise error


def _begin(job: PlanJob) -> tuple[Plan, TwinMotion] | None:
    """Preview and commit a motion, again while a robot still moves; None if the motion was dropped meanwhile."""
    patient_until_s = time.monotonic() + REST_S
    while job.dropped is None:
        plan = job.plan = job.twin.preview_query(job.query)
        if job.dropped is not None:
            break
        job.clear()
        try:
            return plan, plan.commit(job.lead_s, wait=False)
        except Refused as error:
            if not _is_obsolete(error) or time.monotonic() > patient_until_s:
                raise
        job.over.wait(AGAIN_S)
    return None


def _is_obsolete(error: BeatrixError) -> bool:
    """Return whether a plan was refused because a robot has moved since its preview."""
    return isinstance(error, Refused) and error.reason is Reason.REPLACED


def _explained(error: BeatrixError) -> BeatrixError:
    """Return the error to report: no newer motion has replaced one whose preview is obsolete."""
    return WindowError(Reason.NOT_AT_REST, "result.moved") if _is_obsolete(error) else error


def _progress(phase: PlanPhase, plan: Plan, lead_s: float, countdown_s: float) -> PlanProgress:
    return PlanProgress(phase, plan.duration, lead_s, countdown_s, plan.path, plan.apart, plan.alike)
