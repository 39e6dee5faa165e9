"""The limits of one robot: every motion is checked over its whole path before it is accepted."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final

from msgspec.structs import replace

from beatrix_zenoh.contract import refusals
from beatrix_zenoh.contract._generated.messages import Alternative, Detail, Limit, Reason
from beatrix_zenoh.contract._generated.robot import ROBOT, RobotData
from beatrix_zenoh.contract.errors import BeatrixError, Refused
from beatrix_zenoh.contract.names import ARMS
from beatrix_zenoh.motion.gear import Arms, Gear
from beatrix_zenoh.motion.kinematics import Neck
from beatrix_zenoh.motion.limits.alternatives import in_single, typed_speed
from beatrix_zenoh.motion.limits.path_check import TILT, YAW, Bounds, PathChecker
from beatrix_zenoh.motion.limits.path_check import TILT_KNOWN_BEYOND as TILT_KNOWN_BEYOND
from beatrix_zenoh.motion.limits.path_check import known_tilt as known_tilt
from beatrix_zenoh.motion.limits.refusal import RefusalBuilder
from beatrix_zenoh.motion.rotation import tilt_of
from beatrix_zenoh.motion.trajectory import PlannedMotion, Trajectory

_REACH_MARGIN: Final = math.radians(1.0)
_ROUNDING: Final = 1e-9
_POSE_ROUNDING: Final = math.radians(0.1)
"""Tolerance (rad), so that float32 and whole microsteps do not make a pose at a limit exceed it."""
_SPEED_ROUNDING: Final = 1.001
"""Tolerance (factor), so that float32 and quarter microsteps do not make a speed at a limit exceed it."""
_FURTHEST_STEPS: Final = 2**15 - 1
"""Largest distance from home in microsteps: the target of a MOVE is an i16."""
_FURTHEST_START: Final = 1000.0
"""Largest angle (rad) of an arm from home at the start of a motion: a larger one is an error of the step counter."""
_FASTEST_START: Final = 10.0
"""Largest velocity of an arm at the start of a motion, in multiples of the speed limit: a larger one is an error."""

SLOWEST_LIMIT_DEG: Final = 5.0
"""Lowest limit (deg/s) that the teacher may set. Clients wait for a motion as long as one at this speed can take."""


class MotionLimits:
    """Limits of one robot, in rad, rad/s and rad/s2."""

    def __init__(self, robot: RobotData = ROBOT) -> None:
        """Raise Refused (BAD_VALUE) if the geometry is impossible, or cannot reach the tilt limit."""
        data = robot.limits
        self._neck, self._gear = Neck(robot.geometry), Gear(robot.drive)
        self.tilt_max = math.radians(data.tilt_max)
        most = self._neck.reach - _REACH_MARGIN
        if self.tilt_max > most + _ROUNDING:
            detail = Detail(limit=Limit.TILT, value=self.tilt_max, high=most, unit="rad", field="tilt_max")
            raise Refused(Reason.BAD_VALUE, detail=detail)
        self.gap_min = math.radians(data.gap_min)
        self.yaw_max = math.radians(data.yaw_max)
        self.speed_max = math.radians(data.speed_max)
        self.speed_min = max(self._gear.quarters_to_speed((1, 1, 1)))
        """The slowest speed (rad/s) that can be sent to the board."""
        self.acceleration = math.radians(data.acceleration)
        self.default_speed = math.radians(data.speed_default)
        self._arm_max = self.yaw_max + math.pi
        self._count_max = _FURTHEST_STEPS / self._gear.steps_per_turn * math.tau
        bounds = Bounds(self.tilt_max, self.yaw_max, self.gap_min)
        self._checker = PathChecker(self._neck, bounds)
        self._refusals = RefusalBuilder(
            self._checker, self.acceleration, self.speed_min, self._accepts_as_sent
        )

    def check_pose(self, arms: Sequence[float]) -> None:
        """Check that the head may rest at these arm angles (rad).

        Raises Refused: BAD_VALUE, OUT_OF_REACH, YAW_LIMIT, ARM_GAP.
        """
        x, y, z = arms
        self._check_finite(arms)
        if self._too_far((x, y, z)):
            raise refusals.too_far_for_any_pose(arms, self._arm_max)
        exceeded = self._checker.exceeded((x, y, z))
        if exceeded:
            raise self._refusals.of_rest(max(exceeded), (x, y, z))

    def check_speed(self, speed: Sequence[float]) -> None:
        """Raise Refused (SPEED_LIMIT, BAD_VALUE) unless the speeds (rad/s) of all arms are allowed."""
        low, high = self.speed_min / _SPEED_ROUNDING, self.speed_max * _SPEED_ROUNDING
        if low <= min(speed) and max(speed) <= high and math.isfinite(sum(speed)):
            return
        if not all(map(math.isfinite, speed)):
            raise refusals.bad_field("speed", "Every speed must be a finite number.")
        wrong = [i for i, value in enumerate(speed) if not low <= value <= high]
        value = speed[wrong[0]]
        arms = [ARMS[i] for i in wrong if speed[i] == value]
        detail = Detail(
            limit=Limit.SPEED, value=value, low=self.speed_min, high=self.speed_max, unit="rad/s", arms=arms
        )
        raise Refused(Reason.SPEED_LIMIT, detail=detail)

    def nearest_speed(self, speed: Sequence[float]) -> Arms:
        """Return the allowed speeds nearest to these finite speeds (rad/s)."""
        x, y, z = (
            value
            if self.speed_min <= value <= self.speed_max
            else typed_speed(value, self.speed_min, self.speed_max)
            for value in speed
        )
        return in_single((x, y, z))

    def head_at(self, arms: Arms) -> tuple[float, float, float]:
        """Return yaw, pitch and roll (rad) for arm angles (rad).

        Raises Refused (OUT_OF_REACH) if no orientation is possible.
        """
        try:
            return self._neck.forward(arms)
        except BeatrixError:
            raise self._refusals.of_start(arms) from None

    def arms_of_head(self, yaw: float, pitch: float, roll: float) -> Arms:
        """Return the arm angles (rad) for a head orientation (rad), whose yaw and arm gaps are not checked.

        Raises Refused: BAD_VALUE, OUT_OF_REACH.
        """
        if self._tilts_too_far(pitch, roll):
            raise self._refusals.of_tilt(pitch, roll)
        return self._neck.inverse(yaw, pitch, roll)

    def arms_for(self, pose: Arms, start: Arms, velocity: Arms, speed: Arms) -> Arms:
        """Return the arm angles (rad) for a head orientation (yaw, pitch, roll in rad).

        start, velocity, speed: as for `check_motion`; alternatives are checked with them.
        Raises Refused (BAD_VALUE, OUT_OF_REACH, YAW_LIMIT) if no motion can reach this orientation.
        """
        _, pitch, roll = pose
        if self._tilts_too_far(pitch, roll):
            margin = TILT
        else:
            arms = self._neck.inverse(*pose)
            if not self._too_far(arms, start):
                return arms
            margin = YAW  # `check_motion` finds other violations of the yaw limit
        motion = PlannedMotion(start, velocity, start, speed, straight=True)
        raise self._refusals.of_pose(margin, pose, motion)

    def check_motion(
        self, start: Arms, velocity: Arms, target: Arms, speed: Arms, *, straight: bool
    ) -> Trajectory:
        """Return the trajectory of a motion after checking all limits over its whole path.

        start, velocity: present set point (rad) and velocity (rad/s) of the arms. target: rad. speed (rad/s), straight:
        as for `trajectory.plan`. A motion may start beyond a limit if it leads back.
        Raises Refused: BAD_VALUE, NOT_CALIBRATED, SPEED_LIMIT, ARM_GAP, YAW_LIMIT, OUT_OF_REACH.
        """
        self.check_speed(speed)
        self._check_start(start, velocity)
        self._check_finite(target)
        motion = PlannedMotion(start, velocity, target, speed, straight)
        if self._too_far(target, start):
            raise self._too_far_refusal(motion)
        if self._beyond_counter(target):
            raise refusals.too_far(target, self._count_max)
        trajectory = motion.trajectory(self.acceleration)
        try:
            violation = self._checker.first_violation(trajectory)
        except BeatrixError:
            raise self._refusals.of_start(start) from None
        if violation is not None:
            raise self._refusals.of_motion(violation, motion)
        return trajectory

    def _accepts_as_sent(self, motion: PlannedMotion) -> bool:
        """Return whether a motion keeps all limits with the speeds rounded as in a frame."""
        if self._too_far(motion.target, motion.start) or self._beyond_counter(motion.target):
            return False
        speed = self._gear.quarters_to_speed(self._gear.speed_to_quarters(motion.speed))
        trajectory = replace(motion, speed=speed).trajectory(self.acceleration)
        try:
            return self._checker.first_violation(trajectory) is None
        except BeatrixError:
            return False

    def _tilts_too_far(self, pitch: float, roll: float) -> bool:
        """Return whether a head orientation (rad) exceeds the tilt limit; False for NaN and infinity."""
        return math.isfinite(pitch + roll) and tilt_of(pitch, roll) > self.tilt_max + _POSE_ROUNDING

    def _too_far(self, arms: Arms, start: Arms = (0.0, 0.0, 0.0)) -> bool:
        """Return whether an arm is further from home than in any allowed pose, and further than at the start.

        Every arm of an allowed pose is within half a turn of the head's yaw.
        """
        return max(map(abs, arms)) > max(self._arm_max, *map(abs, start))

    def _beyond_counter(self, arms: Arms) -> bool:
        return max(map(abs, self._gear.to_steps(arms))) > _FURTHEST_STEPS

    def _too_far_refusal(self, motion: PlannedMotion) -> Refused:
        """Return a refusal with the longest allowed motion found towards the goal as the alternative."""
        x, y, z = (max(-self._arm_max, min(self._arm_max, angle)) for angle in motion.target)
        refusal = refusals.too_far_for_any_pose(motion.target, self._arm_max)
        return with_alternative(refusal, self._refusals.for_arms((x, y, z), motion))

    def _check_finite(self, arms: Sequence[float]) -> None:
        if not all(map(math.isfinite, arms)):
            raise refusals.bad_field("position", "Every angle of an arm must be a finite number.")

    def _check_start(self, start: Arms, velocity: Arms) -> None:
        """Raise Refused (NOT_CALIBRATED) for positions and velocities that are an error of the board."""
        if not (_within(start, _FURTHEST_START) and _within(velocity, self.speed_max * _FASTEST_START)):
            raise refusals.not_calibrated()


def _within(values: Arms, bound: float) -> bool:
    """Return whether all absolute values are at most `bound`; False for NaN."""
    x, y, z = values
    return abs(x) <= bound and abs(y) <= bound and abs(z) <= bound


def with_alternative(refusal: Refused, alternative: Alternative | None) -> Refused:
    """Return the refusal with this alternative, if there is one, in its detail and sentence."""
    if refusal.detail is None or alternative is None:
        return refusal
    return Refused(refusal.reason, detail=replace(refusal.detail, alternative=alternative))
