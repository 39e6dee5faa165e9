"""The SDK: both robots of one name. A motion is previewed, carried out by the simulation, then by the hardware."""

from __future__ import annotations

import contextlib
import threading
from collections.abc import Callable, Iterable
from typing import NamedTuple

from beatrix_zenoh.bus import ProcessBound
from beatrix_zenoh.client.degrees import Reading, Speed, motion_query
from beatrix_zenoh.client.motion import Movable
from beatrix_zenoh.client.plan import SAME_DEG, Plan, Start, distance, unlike
from beatrix_zenoh.client.robot import Robot
from beatrix_zenoh.client.session import Client, Closable
from beatrix_zenoh.client.stopping import stop_robots
from beatrix_zenoh.client.twin_motion import REPLACED, TwinMotion
from beatrix_zenoh.client.twin_state import PlanPosition, check_seat, plan_position
from beatrix_zenoh.contract._generated.messages import MotionQuery, PoseQuery, Reason
from beatrix_zenoh.contract.errors import BeatrixError, Interrupted, NoAnswer, Refused, naming

CLOSE_S = 2.0


class TwinReading(NamedTuple):
    """Positions of both robots, in degrees."""

    sim: Reading
    hw: Reading


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
        """Preview an arm motion (deg, deg/s; see `Robot.move`); raises the errors of `preview`."""
        return self.preview_query(motion_query(short, middle, long, relative=relative, speed=speed))

    def preview_query(self, query: MotionQuery | PoseQuery) -> Plan:
        """Preview a motion (rad, rad/s); raises the errors of `preview`."""
        motion = self._motion
        during = motion if motion is not None and motion.running() else None
        start = self._start()
        if not query.absolute and (apart := distance(start)) > SAME_DEG:
            raise Refused(
                Reason.BAD_VALUE,
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
