"""The arms of a simulation that follows."""

from __future__ import annotations

from msgspec.structs import replace

from beatrix_zenoh.contract._generated.serial import Move, MoveStraight
from beatrix_zenoh.contract.errors import Refused
from beatrix_zenoh.node.access import Access
from beatrix_zenoh.node.controller import MotionController
from beatrix_zenoh.node.snapshot import Snapshot
from sim_node.following.follower import Places, SetPoint, Step, advanced


def follows(access: Access) -> bool:
    """Return whether the simulation may still follow; call this just before each motion. Freeze ends it, as STOP does."""
    with access.lock:
        access.following &= not access.teacher.frozen
        access.begun += access.following
        return access.following


class OwnArms:
    """The arms of the simulation; all methods run on the controller's thread."""

    def __init__(self, controller: MotionController, snapshot: Snapshot) -> None:
        self._controller, self._snapshot = controller, snapshot
        self._board, self._planner = controller.board, controller.planner
        self._last: Move | MoveStraight | None = None

    def set_point(self, now_s: float) -> SetPoint | None:
        """Return the set points at `now_s` (monotonic clock, s); None before the first telemetry."""
        sample, gear = self._board.sample, self._planner.gear
        if sample is None:
            return None
        telemetry = sample.telemetry
        point = SetPoint(gear.to_rad(telemetry.position), gear.to_rad(telemetry.velocity))
        return advanced(point, now_s - sample.t_mono_ns / 1e9)

    def measured(self) -> tuple[float, Places]:
        """Return a time (monotonic clock, s), and the measured places of arms and head then."""
        now = self._snapshot.positions()
        return now.t_mono_ns / 1e9, Places.of(now)

    def move(self, step: Step) -> None:
        """Begin a motion, unless it is the last one or the arms rest at its target.

        Raises BeatrixError if its path exceeds a limit, or if the firmware refuses it.
        """
        try:
            self._send(self._frame(step))
        except Refused:
            # A target ahead of the hardware may exceed a guard of the firmware, although the hardware does not.
            if step.careful is None:
                raise
            self._send(self._frame(Step(step.careful, straight=False)))

    def _send(self, frame: Move | MoveStraight) -> None:
        if frame == self._last:
            return
        telemetry = self._board.ready_telemetry()
        if telemetry.position == frame.target and not any(telemetry.velocity):
            return
        controller = self._controller
        if follows(self._controller.access):
            controller.follows, controller.last_goal = True, None
            controller.send(lambda number: replace(frame, motion=number))
            self._board.wake()
            self._last = frame

    def _frame(self, step: Step) -> Move | MoveStraight:
        """Return the frame of a motion, without its number; raises Refused if its path exceeds a limit."""
        planner, (target, speed) = self._planner, step.course
        steps, quarters = planner.gear.to_steps(target), planner.gear.speed_to_quarters(speed)
        if not step.straight:
            return Move(0, steps, quarters)
        telemetry = self._board.ready_telemetry()
        start, velocity = planner.gear.to_rad(telemetry.position), planner.gear.to_rad(telemetry.velocity)
        sent = planner.gear.quarters_to_speed(quarters)
        planner.limits.check_motion(start, velocity, target, sent, straight=True)
        return MoveStraight(0, steps, quarters[0])
