"""A motion of both robots that was previewed on a copy of the simulation."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

from beatrix_zenoh.bus import ProcessBound
from beatrix_zenoh.client.degrees import checked_seconds, path_figure, preview_of, true_or_false
from beatrix_zenoh.client.robot import Robot
from beatrix_zenoh.client.twin_motion import TwinMotion, furthest
from beatrix_zenoh.client.twin_state import PlanPosition, plan_position
from beatrix_zenoh.contract._generated.messages import Info, MotionQuery, PoseQuery, PreviewReply, Reason
from beatrix_zenoh.contract.errors import BeatrixError, Refused

if TYPE_CHECKING:
    from beatrix_zenoh.client.figures import Figure

SAME_DEG = 0.1
"""Largest distance of two positions that count as equal; a microstep is 0.086 deg."""
THERE_DEG = 0.2
"""Largest distance from the end of a path at which a robot stands there already; the path is measured, not commanded."""
UNLIKE = (
    " Simulation and hardware run with different values: the hardware may move differently, or refuse. "
    "Start both with the same --robot-file."
)
Start = tuple[PlanPosition, PlanPosition | None]
"""Positions of simulation and hardware at the preview; None: no hardware was online."""


class RobotPair(Protocol):
    """What a plan needs of a `Twin`."""

    sim: Robot
    hw: Robot
    name: str

    def check_ready(self) -> None:
        """Raise an error if a robot cannot move now."""

    def start(self, motion: TwinMotion, *, wait: bool) -> None:
        """Begin a motion of both robots."""


class Plan(ProcessBound):
    """A previewed motion, to be committed or aborted."""

    def __init__(
        self,
        twin: RobotPair,
        query: MotionQuery | PoseQuery,
        preview: PreviewReply,
        start: Start,
        *,
        alike: bool,
        during: TwinMotion | None = None,
    ) -> None:
        """Store a preview from `start`; `during` is the motion of the same Twin at that time, None at rest."""
        self._twin, self._query = twin, query
        self._start, self._during = start, during
        self.duration = preview.duration
        """Time (s) from the start of the motion until the arms rest."""
        self.verdict = preview.message
        """The result of the preview in a sentence, and whether it holds for the hardware."""
        apart = distance(start)
        self.apart = apart if apart > SAME_DEG else 0.0
        """Distance (deg) of the hardware from the simulation at the preview; 0 if they stood at the same position."""
        self.alike = alike
        """Whether simulation and hardware run with the same values, so that the preview holds for the hardware."""
        if self.apart:
            self.verdict += (
                f" The hardware stands {apart:.1f}° away from the simulation, so its path was not previewed."
            )
        if not alike:
            self.verdict += UNLIKE
        self.path = preview_of(preview).path
        self._settled = ""
        self._motion: TwinMotion | None = None

    def commit(self, lead_s: float = 0.0, *, wait: bool = True) -> TwinMotion:
        """Carry the motion out: the simulation at once, the hardware `lead_s` (s) later.

        Returns when both have arrived. With wait=False it returns when the simulation has accepted the motion or,
        without a lead, when both robots have accepted it.
        During the lead, `abort`, STOP at either robot or Ctrl-C stops the simulation and leaves the hardware unmoved;
        another commit of this Twin replaces this one, and the hardware gets only the new motion. If one robot refuses
        or is stopped, the other is stopped too.

        Raises:
            WrongUsage: `lead_s` is not a number from 0 to a day.
            Refused: one robot refused, may not move now, or has moved since the preview; or the plan was committed or
                aborted before.
            NoAnswer: one robot is not online, or has lost its board.
            Interrupted: the motion of one robot was stopped, or this one was aborted or replaced.
        """
        lead_s, waits = checked_seconds("lead_s", lead_s, zero=True), true_or_false("wait", wait)
        self._check_open()
        sim, hw = self._twin.sim, self._twin.hw
        motion = self._motion = TwinMotion(sim, hw, self._query, lead_s)  # from here on `abort` can cancel it
        try:
            self._twin.check_ready()
            self._settled = "committed"
            now = self._check_unmoved(sim), self._check_unmoved(hw)
        except BeatrixError:
            self._motion = None
            raise
        motion.prepare(*now, self._check_both, measured=self._during is None)
        self._twin.start(motion, wait=waits)
        return motion

    def stands_at_end(self, side: str) -> bool:
        """Return whether the robot, `sim` or `hw`, stood at the end of the path at the preview, so that it will not move."""
        was = self._start[side == "hw"]
        return was is not None and furthest(was.arms, self.path.arms[-1]) <= THERE_DEG

    @property
    def motion(self) -> TwinMotion | None:
        """The motion that `commit` has begun; None before `commit`, or if a check of `commit` has failed."""
        return self._motion

    def _check_both(self) -> None:
        """Raise unless both robots may still move and the hardware has not moved since the preview."""
        self._twin.check_ready()
        self._check_unmoved(self._twin.hw)

    def _check_unmoved(self, robot: Robot) -> PlanPosition:
        """Return the position of a robot; raise Refused (REPLACED) if the preview is obsolete."""
        was = self._start[robot is self._twin.hw]
        now = plan_position(robot)
        if not self._holds(robot, was, now):
            what = "was not online at" if was is None else "has moved, or was calibrated, since"
            raise Refused(
                Reason.REPLACED, f"{robot} {what} this preview, so its path would differ: preview again."
            )
        return now

    def _holds(self, robot: Robot, was: PlanPosition | None, now: PlanPosition) -> bool:
        """Return whether a preview from `was` is valid: the robot is still there, or continues the motion `during`."""
        if was is None or was.calibrations != now.calibrations:
            return False
        during = self._during
        moves = (
            during is not None and during.running() and (robot is not self._twin.hw or during.hardware_sent)
        )
        return moves or furthest(was.arms, now.arms) <= SAME_DEG

    def __repr__(self) -> str:
        return f"<plan for {self._twin.name}: {self._settled or self.verdict}>"

    def abort(self) -> None:
        """Discard the plan; if it was committed, stop the simulation, and the hardware if it has begun to move.

        Raises:
            Refused: the plan was aborted or carried out before.
        """
        if self._motion is None or not self._motion.cancel():
            self._check_open()
        self._settled = "aborted"

    def _check_open(self) -> None:
        if self._settled:
            raise Refused(Reason.BAD_VALUE, f"This plan was {self._settled} already: make a new preview.")

    def plot(self) -> Figure:
        """Return a figure of the path; needs the extra `plot`."""
        return path_figure(self.path)


def unlike(sim: Info, hw: Info) -> bool:
    """Return whether two robots have different robot values; False if one is too old to report a fingerprint."""
    return None not in (sim.fingerprint, hw.fingerprint) and sim.fingerprint != hw.fingerprint


def distance(start: Start) -> float:
    """Return the largest difference (deg) between the same arms of both robots; 0 without hardware."""
    simulation, hardware = start
    return 0.0 if hardware is None else furthest(simulation.arms, hardware.arms)
