"""Refusals of motions: the exceeded limit, the place and value of the violation, and an accepted alternative."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Final

from msgspec.structs import replace

from beatrix_zenoh.contract._generated.messages import Alternative, Detail, Head, Limit, Reason, Vector3
from beatrix_zenoh.contract.errors import BeatrixError, Refused
from beatrix_zenoh.motion.gear import Arms
from beatrix_zenoh.motion.limits.alternatives import furthest, in_single, nearest_pose, typed_speed
from beatrix_zenoh.motion.limits.path_check import GAP, TILT, PathChecker, Violation
from beatrix_zenoh.motion.rotation import tilt_of
from beatrix_zenoh.motion.trajectory import PlannedMotion, Trajectory

_SAMPLES: Final = 24
_PAIRS: Final = (["short", "middle"], ["middle", "long"], ["long", "short"])


class RefusalBuilder:
    """Builds the refusals of one robot's motions and poses."""

    def __init__(
        self,
        checker: PathChecker,
        acceleration: float,
        slowest: float,
        accepts: Callable[[PlannedMotion], bool],
    ) -> None:
        """`acceleration`: rad/s2; `slowest`: lowest speed of an arm (rad/s); `accepts`: whether a motion keeps all limits."""
        self._neck, self._bounds, self._checker = checker.neck, checker.bounds, checker
        self._acceleration, self._slowest, self._accepts = acceleration, slowest, accepts

    def of_rest(self, index: int, arms: Arms) -> Refused:
        """Return the refusal of arm angles (rad) at which a head at rest exceeds the limit of this index."""
        return self._refused(index, arms, at_goal=True)

    def of_tilt(self, pitch: float, roll: float) -> Refused:
        """Return the refusal of a head orientation (rad) that tilts too far, for a motion with an unknown start."""
        return self._refused(TILT, (0.0, 0.0, 0.0), value=tilt_of(pitch, roll), at_goal=True)

    def of_pose(self, index: int, pose: Arms, motion: PlannedMotion) -> Refused:
        """Return the refusal of a head orientation (rad) that exceeds the limit of this index.

        motion: start and speeds of the motion to this orientation; the goal of `motion` is not used.
        """
        value = tilt_of(pose[1], pose[2]) if index == TILT else pose[0]
        return self._refused(
            index, motion.start, value=value, at_goal=True, alternative=self.for_pose(pose, motion)
        )

    def of_motion(self, violation: Violation, motion: PlannedMotion) -> Refused:
        """Return the refusal of a motion that leaves the limits."""
        index, at_goal = self._exceeded_limit(violation, motion)
        arms = motion.target
        if not at_goal:
            trajectory = motion.trajectory(self._acceleration)
            arms = max(_after(violation, trajectory), key=lambda arms: self._excess(index, arms))
        alternative = self._alternative(motion, at_goal=at_goal)
        return self._refused(index, arms, at_goal=at_goal, violation=violation, alternative=alternative)

    def of_start(self, start: Arms) -> Refused:
        """Return the refusal of any motion while no head orientation is possible at the present arm angles (rad)."""
        detail = Detail(
            limit=Limit.TILT, unit="rad", at_goal=False, leaves_s=0.0, leaves_arms=Vector3(*start)
        )
        return Refused(Reason.OUT_OF_REACH, detail=detail)

    def for_pose(self, pose: Arms, motion: PlannedMotion) -> Alternative | None:
        """Return the accepted head orientation found nearest to `pose` (rad), None if there is none."""
        try:
            start = self._neck.forward(motion.start)
        except BeatrixError:
            return None

        def motion_to(head: Arms) -> PlannedMotion:
            return replace(motion, target=self._neck.inverse(*head))

        goal = nearest_pose(pose, self._bounds.tilt_max, self._bounds.yaw_max)
        head = furthest(start, goal, lambda head: self._accepts(motion_to(head)))
        if head is None:
            return None
        arms = in_single(motion_to(head).target)
        alone = PlannedMotion(motion.start, motion.velocity, arms, motion.speed, straight=False)
        return Alternative(head=Head(*head), arms=Vector3(*arms) if self._accepts(alone) else None)

    def for_arms(self, goal: Arms, motion: PlannedMotion) -> Alternative | None:
        """Return the accepted position of the arms found furthest towards `goal` (rad), None if there is none."""
        arms = furthest(motion.start, goal, lambda arms: self._accepts(replace(motion, target=arms)))
        return None if arms is None else Alternative(arms=Vector3(*arms))

    def _exceeded_limit(self, violation: Violation, motion: PlannedMotion) -> tuple[int, bool]:
        """Return the index of the limit to name, and whether the goal exceeds it.

        A gap has priority: a goal with close arms usually tilts too far as well, but users see the close arms.
        """
        at_goal = self._checker.exceeded(motion.target, motion.start)
        if not at_goal:
            return violation.index, False
        if max(at_goal) >= GAP or violation.index not in at_goal:
            return max(at_goal), True
        return violation.index, True

    def _alternative(self, motion: PlannedMotion, *, at_goal: bool) -> Alternative | None:
        if not motion.straight:
            if not at_goal and (speed := self._speed(motion)) is not None:
                return Alternative(speed=Vector3(*speed))
            return self.for_arms(motion.target, motion)
        try:
            pose = self._neck.forward(motion.target)
        except BeatrixError:
            return None
        return self.for_pose(pose, motion)

    def _speed(self, motion: PlannedMotion) -> Arms | None:
        """Return speeds (rad/s) in proportion to the paths of the arms; None if the motion still leaves the limits."""
        x, y, z = (typed_speed(speed, self._slowest, math.inf) for speed in motion.proportional_speed())
        speed = in_single((x, y, z))
        return speed if self._accepts(replace(motion, speed=speed)) else None

    def _refused(
        self,
        index: int,
        arms: Arms,
        *,
        at_goal: bool,
        value: float | None = None,
        violation: Violation | None = None,
        alternative: Alternative | None = None,
    ) -> Refused:
        """Return the refusal for the limit of this index at these arm angles (rad); `value`: rad, None to compute it."""
        bounds = self._bounds
        if index == TILT:
            reason, limit, low, high = Reason.OUT_OF_REACH, Limit.TILT, None, bounds.tilt_max
        elif index < GAP:
            reason, limit, low, high = Reason.YAW_LIMIT, Limit.YAW, -bounds.yaw_max, bounds.yaw_max
        else:
            reason, limit, low, high = Reason.ARM_GAP, Limit.ARM_GAP, bounds.gap_min, None
        detail = Detail(
            limit=limit,
            value=self._value(index, arms) if value is None else value,
            low=low,
            high=high,
            unit="rad",
            arms=_PAIRS[index - GAP] if index >= GAP else [],
            at_goal=at_goal,
            leaves_s=None if violation is None else violation.t,
            leaves_arms=None if violation is None else Vector3(*violation.arms),
            alternative=alternative,
        )
        return Refused(reason, detail=detail)

    def _value(self, index: int, arms: Arms) -> float | None:
        """Return tilt, yaw or gap (rad); None if no head orientation is possible."""
        if index >= GAP:
            return self._neck.gaps(arms)[index - GAP]
        try:
            yaw, pitch, roll = self._neck.forward(arms)
        except BeatrixError:
            return None
        return tilt_of(pitch, roll) if index == TILT else yaw

    def _excess(self, index: int, arms: Arms) -> float:
        """Return a number that grows with the violation of the limit of this index."""
        value = self._value(index, arms)
        if value is None:
            return math.inf
        return -value if index >= GAP else abs(value)


def _after(violation: Violation, trajectory: Trajectory) -> list[Arms]:
    span = trajectory.duration - violation.t
    return [trajectory.at(violation.t + span * i / _SAMPLES)[0] for i in range(_SAMPLES + 1)]
