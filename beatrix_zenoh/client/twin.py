"""The SDK: both robots of one name. A motion is previewed, carried out by the simulation, then by the hardware."""

from __future__ import annotations

import contextlib
import threading
from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, NamedTuple

from beatrix_zenoh.bus import ProcessBound
from beatrix_zenoh.client.degrees import (
    Path,
    Reading,
    Speed,
    checked_seconds,
    motion_query,
    path_figure,
    preview_of,
    true_or_false,
)
from beatrix_zenoh.client.motion import Movable
from beatrix_zenoh.client.robot import Robot
from beatrix_zenoh.client.session import Client, Closable
from beatrix_zenoh.client.stopping import stop_robots
from beatrix_zenoh.client.twin_motion import REPLACED, TwinMotion, furthest
from beatrix_zenoh.client.twin_state import PlanPosition, check_seat, plan_position
from beatrix_zenoh.contract._generated.messages import Info, MotionQuery, PoseQuery, PreviewReply, Reason
from beatrix_zenoh.contract.errors import BeatrixError, Interrupted, NoAnswer, Refused, bad_value, naming

if TYPE_CHECKING:
    from beatrix_zenoh.client.figures import Figure

CLOSE_S = 2.0


SAME_DEG = 0.1
"""Largest distance of two positions that count as equal; a microstep is 0.086 deg."""
UNLIKE = (
    " Simulation and hardware run with different values: the hardware may move differently, or refuse. "
    "Start both with the same --robot-file."
)
Start = tuple[PlanPosition, PlanPosition | None]
"""Positions of simulation and hardware at the preview; None: no hardware was online."""


class TwinReading(NamedTuple):
    """Positions of both robots, in degrees."""

    sim: Reading
    hw: Reading


class Plan(ProcessBound):
    """A previewed motion, to be committed or aborted."""

    def __init__(
        self,
        twin: Twin,
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
        self.duration: float = preview.duration
        """Time (s) from the start of the motion until the arms rest."""
        self.verdict: str = preview.message
        """The result of the preview in a sentence, and whether it holds for the hardware."""
        apart = distance(start)
        self.apart: float = apart if apart > SAME_DEG else 0.0
        """Distance (deg) of the hardware from the simulation at the preview; 0 if they stood at the same position."""
        self.alike: bool = alike
        """Whether simulation and hardware run with the same values, so that the preview holds for the hardware."""
        if self.apart:
            self.verdict += (
                f" The hardware stands {apart:.1f}° away from the simulation, so its path was not previewed."
            )
        if not alike:
            self.verdict += UNLIKE
        self.path: Path = preview_of(preview).path
        """Times (s), arms and head (deg) of the previewed motion."""
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
            raise bad_value(f"This plan was {self._settled} already: make a new preview.")

    def plot(self) -> Figure:
        """Return a figure of the path; needs the extra `plot`."""
        return path_figure(self.path)


class Twin(ProcessBound, Closable, Movable[TwinMotion, Plan]):
    """Simulation and hardware of one name; see `Robot` for the arguments.

    `preview` tries a motion and returns a plan to commit. `look` and `move` send a motion to both robots without a
    preview, the simulation first, for programs that send a new target many times a second: they return when both have
    arrived or, with wait=False, when both have accepted the motion. If one robot refuses, is not online or is stopped,
    the other is stopped, too. `sim` and `hw` are the robots.
    """

    def __init__(
        self,
        name: str | None = None,
        *,
        connect: str | None = None,
        who: str | None = None,
        timeout_s: float = 2.0,
        client: Client | None = None,
    ) -> None:
        self.sim = Robot(name, "sim", connect=connect, who=who, timeout_s=timeout_s, client=client)
        self.client, self.name = self.sim.client, self.sim.name
        self.hw = Robot(self.name, "hw", timeout_s=timeout_s, client=self.client)
        self._starting = threading.RLock()
        self._motion: TwinMotion | None = None

    # -- switching -------------------------------------------------------------------------------

    def enable(self) -> None:
        """Switch the motors of both robots on; of neither if a robot is not reachable or another seat drives it."""
        self._switch_both(Robot.enable)

    def _switch_both(self, do: Callable[[Robot], None]) -> None:
        """Send a command to both robots, or to neither if this seat may not switch one of them."""
        for robot in (self.sim, self.hw):
            check_seat(robot, moves=False)
        each((self.sim, self.hw), do)

    def make_ready(self) -> None:
        """Enable and calibrate both robots as far as needed; raises the errors of `Robot.make_ready`."""
        each((self.sim, self.hw), Robot.make_ready)

    def reset(self) -> None:
        """Clear the emergency latch of both robots; the motors stay off."""
        each((self.sim, self.hw), Robot.reset)

    def disable(self) -> None:
        """Switch the motors of both robots off."""
        each((self.sim, self.hw), Robot.disable)

    def calibrate(self) -> None:
        """Calibrate both robots where they are, or neither if a robot is not reachable or another seat drives it."""
        self._switch_both(Robot.calibrate)

    def stop(self) -> None:
        """Send STOP to both robots at the same time, then raise the first error of `Robot.stop`, if any."""
        for _, reply in list(stop_robots((self.hw, self.sim))):
            if isinstance(reply, BeatrixError):
                raise reply

    # -- motions with a preview ------------------------------------------------------------------

    def preview_arms(
        self,
        short: float,
        middle: float,
        long: float,
        *,
        relative: bool = False,
        speed: Speed | None = None,
    ) -> Plan:
        """Preview an arm motion (deg, deg/s; see `Robot.move`); raises WrongUsage, Refused or NoAnswer as `preview`."""
        return self.preview_query(motion_query(short, middle, long, relative=relative, speed=speed))

    def preview_query(self, query: MotionQuery | PoseQuery) -> Plan:
        """Preview a motion (rad, rad/s); raises the errors of `preview`."""
        motion = self._motion
        during = motion if motion is not None and motion.running() else None
        start = self._start()
        if not query.absolute and (apart := distance(start)) > SAME_DEG:
            raise bad_value(
                f"The robots stand {apart:.1f}° apart, so a relative motion would leave them apart: move both to "
                "the same position first, with home or with a motion that is not relative.",
            )
        with naming(str(self.sim)):
            reply = self.sim.try_out(query)
        plan = Plan(self, query, reply, start, alike=start[1] is None or self._alike(), during=during)
        if start[1] is not None:
            try:
                check_seat(self.hw, moves=True)
            except BeatrixError as error:
                why = error.message.removeprefix(f"{self.hw}: ")
                plan.verdict += f" But the hardware may not move now: {why}"
        return plan

    def _start(self) -> Start:
        hardware: PlanPosition | None = None
        # A preview needs only the simulation; commit reports missing hardware.
        with contextlib.suppress(NoAnswer):
            hardware = plan_position(self.hw)
        return plan_position(self.sim), hardware

    def _alike(self) -> bool:
        """Return whether both robots have the same robot values; True if one of them does not answer."""
        with contextlib.suppress(NoAnswer):
            return not unlike(self.sim.info(), self.hw.info())
        return True

    def home(self) -> None:
        """Preview the motion home and commit it."""
        self.preview_arms(0, 0, 0).commit()

    # -- motions without a preview ---------------------------------------------------------------------

    def _carry_out(self, query: MotionQuery | PoseQuery, *, wait: bool) -> TwinMotion:
        motion = TwinMotion(self.sim, self.hw, query)
        self.start(motion, wait=wait)
        return motion

    def start(self, motion: TwinMotion, *, wait: bool) -> None:
        """Start a motion of both robots, which replaces a running one; raises the errors of `TwinMotion.start`."""
        with self._starting:
            before, self._motion = self._motion, motion
        if before is None or not before.hold():
            before = None  # otherwise the tracebacks of failed starts keep all motions that have failed before them
            motion.start(wait=wait)
            return
        try:
            motion.start(wait=wait, begun=lambda: before.end(Interrupted(Reason.REPLACED, REPLACED)))
        except BaseException:
            before.cancel()  # the simulation has refused the new motion: the old one must not reach the hardware alone
            raise

    # -- state -----------------------------------------------------------------------------------

    def positions(self) -> TwinReading:
        """Return the current positions of both robots, in degrees; raises NoAnswer as `Robot.positions` does."""
        return TwinReading(self.sim.positions(), self.hw.positions())

    def check_ready(self) -> None:
        """Raise unless both robots may move now, so that no robot starts and is stopped again.

        Raises:
            Refused: motors off, not calibrated, or another seat drives.
            NoAnswer: one robot is not online, or has lost its board.
        """
        for robot in (self.sim, self.hw):
            check_seat(robot, moves=True)

    def close(self) -> None:
        """Close the session: the robots stop running motions, and a motion in its lead is not sent to the hardware.

        A shared session stays open; then STOP ends the last motion of this object.
        """
        motion = self._motion
        if motion is not None:
            motion.hold()
        self.sim.close()
        if motion is not None and motion.running():
            motion.end(
                Interrupted(
                    Reason.SHUTDOWN, "This program closed its connection, so the robots stop its motions."
                )
            )
            with contextlib.suppress(TimeoutError):
                motion.exception(CLOSE_S)


def each(robots: Iterable[Robot], do: Callable[[Robot], None]) -> None:
    """Call a function for one robot after the other; messages of errors begin with the robot's name."""
    for robot in robots:
        with naming(str(robot)):
            do(robot)


def unlike(sim: Info, hw: Info) -> bool:
    """Return whether two robots have different robot values; False if one is too old to report a fingerprint."""
    return None not in (sim.fingerprint, hw.fingerprint) and sim.fingerprint != hw.fingerprint


def distance(start: Start) -> float:
    """Return the largest difference (deg) between the same arms of both robots; 0 without hardware."""
    simulation, hardware = start
    return 0.0 if hardware is None else furthest(simulation.arms, hardware.arms)
