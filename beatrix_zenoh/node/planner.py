"""Planning: convert queries to checked goals in the units of the firmware."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import lru_cache

import msgspec
from msgspec import structs

from beatrix_zenoh.contract._generated.messages import (
    Alternative,
    Detail,
    Limit,
    MotionQuery,
    PoseQuery,
    Reason,
    Vector3,
)
from beatrix_zenoh.contract._generated.robot import RobotData
from beatrix_zenoh.contract._generated.serial import Move, MoveStraight, Telemetry
from beatrix_zenoh.contract.errors import Refused
from beatrix_zenoh.contract.names import ARMS
from beatrix_zenoh.motion.gear import Arms, Gear
from beatrix_zenoh.motion.kinematics import Neck
from beatrix_zenoh.motion.limits import SLOWEST_LIMIT_DEG, MotionLimits, with_alternative
from beatrix_zenoh.motion.trajectory import Trajectory


class Goal(msgspec.Struct, frozen=True):
    """A checked motion: arm angles `target` (rad); for the firmware `steps` (microsteps) and speeds `quarters`.

    `quarters` are quarter microsteps per second.
    """

    target: Arms
    steps: tuple[int, int, int]
    quarters: tuple[int, int, int]
    straight: bool
    trajectory: Trajectory
    exact: Arms
    """the requested arm angles (rad); `target` is the nearest position in whole microsteps"""
    pose: Arms | None
    """the requested yaw, pitch and roll (rad); None for a motion of the arms"""
    kept: tuple[bool, bool, bool] = (False, False, False)
    """whether yaw, pitch, roll are those from before the motion, because a relative pose did not turn them"""
    turns: bool = True
    """whether an arm turns; False if all arms rest at `steps` already"""

    @property
    def duration(self) -> float:
        """Time (s) until the arms rest."""
        return self.trajectory.duration if self.turns else 0.0

    def frame(self, motion: int) -> Move | MoveStraight:
        """Return the frame that begins the motion to this goal, with the number `motion`."""
        if self.straight:
            return MoveStraight(motion, self.steps, self.quarters[0])
        return Move(motion, self.steps, self.quarters)


class Planner:
    """Converts queries of one robot to checked goals: kinematics, gear and limits."""

    def __init__(self, robot: RobotData) -> None:
        self.robot = robot
        self.gear = Gear(robot.drive)
        self.neck = Neck(robot.geometry)
        self.limits = MotionLimits(robot)
        self._limits_at = lru_cache(maxsize=8)(self._make_limits)
        self.speed_limit = 0.0
        """Limit (rad/s) that the teacher has set for every arm; 0: none."""
        self._turn_speed = 0.0

    def limit_speed(self, speed: float) -> None:
        """Limit the speed of every arm to `speed` (rad/s), also in motions without a speed; 0 ends the limit.

        Raises:
            Refused: SPEED_LIMIT, `speed` is lower than SLOWEST_LIMIT_DEG or higher than the robot allows.
        """
        self.check_limit(speed)
        # Undo the rounding of messages to single precision, so that status and texts show the limit as it was typed.
        self.speed_limit = math.radians(round(math.degrees(speed), 3))
        self._set_limits()

    def limit_turn(self, speed: float) -> None:
        """Limit the speed of every arm for the seat whose motion is planned next, to `speed` (rad/s); 0: no limit."""
        if speed != self._turn_speed:
            self._turn_speed = speed
            self._set_limits()

    def _set_limits(self) -> None:
        own = self.robot.limits
        most = min((limit for limit in (self.speed_limit, self._turn_speed) if limit), default=0.0)
        self.limits = self._limits_at(round(math.degrees(most), 3) if most else own.speed_max)

    def _make_limits(self, speed_max: float) -> MotionLimits:
        """Return the limits of the robot with this largest speed (deg/s); takes some milliseconds."""
        own = self.robot.limits
        limits = structs.replace(own, speed_max=speed_max, speed_default=min(own.speed_default, speed_max))
        return MotionLimits(structs.replace(self.robot, limits=limits))

    def check_limit(self, speed: float) -> None:
        """Check a limit of the speed (rad/s); 0 is none. Raises the error of `limit_speed`."""
        own = self.robot.limits
        low, high = math.radians(SLOWEST_LIMIT_DEG), math.radians(own.speed_max)
        if speed and not low * 0.999 <= speed <= high * 1.001:
            raise Refused(
                Reason.SPEED_LIMIT,
                detail=Detail(
                    limit=Limit.SPEED, value=speed, low=low, high=high, unit="rad/s", arms=list(ARMS)
                ),
            )

    def exceeds_limit(self, goal: Goal) -> bool:
        """Return whether a motion, which may have begun before the teacher set the limit, exceeds it."""
        fastest = max(self.gear.quarters_to_speed(goal.quarters))
        return 0 < self.speed_limit < fastest * 0.999

    def goal(self, query: MotionQuery | PoseQuery, telemetry: Telemetry, last: Goal | None = None) -> Goal:
        """Return the goal of a query, checked over the whole path from the state in the telemetry.

        Args:
            query: the motion; a relative one counts from the angles that `base` returns.
            telemetry: the present state of the board.
            last: goal of the last motion, unless something else has moved the arms or set home since; None: unknown.

        Raises:
            Refused: OUT_OF_REACH, ARM_GAP, YAW_LIMIT, SPEED_LIMIT or BAD_VALUE.
        """
        speed = self._speed_of(query)
        try:
            self.limits.check_speed(speed)
        except Refused as refusal:
            raise self._with_speed(refusal, query, telemetry, last, speed) from None
        return self._goal(query, telemetry, last, speed)

    def base(self, telemetry: Telemetry, last: Goal | None) -> Arms:
        """Return the arm angles (rad) that relative motions count from.

        These are the requested angles of the last motion if the arms stand at its goal, so that the parts of a
        microstep add up; otherwise, also while a motion runs, the present set point.
        """
        if last is not None and telemetry.position == last.steps:
            return last.exact
        return self.gear.to_rad(telemetry.position)

    def _goal(
        self, query: MotionQuery | PoseQuery, telemetry: Telemetry, last: Goal | None, speed: Arms
    ) -> Goal:
        start = self.gear.to_rad(telemetry.position)
        velocity = self.gear.to_rad(telemetry.velocity)
        quarters = self.gear.speed_to_quarters(speed)
        sent = self.gear.quarters_to_speed(quarters)  # check these: rounding changes paths of slow arms
        pose: Arms | None = None
        if isinstance(query, PoseQuery):
            pose = self._pose_of(query, telemetry, last)
            exact = self.limits.arms_for(pose, start, velocity, sent)
        else:
            exact = tuple3(query.position)
            if not query.absolute:
                exact = _sum(self.base(telemetry, last), exact)
        straight = pose is not None
        trajectory = self.limits.check_motion(start, velocity, exact, sent, straight=straight)
        steps = self.gear.to_steps(exact)
        turns = steps != telemetry.position or any(telemetry.velocity)
        return Goal(
            self.gear.to_rad(steps),
            steps,
            quarters,
            straight,
            trajectory,
            exact,
            pose,
            _kept(query),
            turns,
        )

    def _speed_of(self, query: MotionQuery | PoseQuery) -> Arms:
        """Return the speed of each arm (rad/s), the default if the query has none."""
        if isinstance(query.speed, Vector3):
            return tuple3(query.speed)
        speed = self.limits.default_speed if query.speed is None else query.speed
        return speed, speed, speed

    def _with_speed(
        self,
        refusal: Refused,
        query: MotionQuery | PoseQuery,
        telemetry: Telemetry,
        last: Goal | None,
        speed: Arms,
    ) -> Refused:
        """Complete and return the refusal of a speed.

        Name the limit of the turn or of the teacher, the lower one or both if they are equal, if it is below the robot's
        own, and the nearest allowed speed if the motion is accepted with it.
        """
        if refusal.reason is not Reason.SPEED_LIMIT or refusal.detail is None:
            return refusal
        limits = {"speed_limit": self.speed_limit, "turn_speed": self._turn_speed}
        # Rounded, because the limit of a turn has the single precision of messages.
        limits_deg = {name: round(math.degrees(limit), 3) for name, limit in limits.items() if limit}
        lowest = min(limits_deg.values(), default=math.inf)
        if math.degrees(max(speed)) > lowest and lowest < self.robot.limits.speed_max:
            field = " ".join(name for name, limit in limits_deg.items() if limit == lowest)
            refusal = Refused(refusal.reason, detail=structs.replace(refusal.detail, field=field))
        nearest = self.limits.nearest_speed(speed)
        try:
            self._goal(query, telemetry, last, nearest)
        except Refused:
            return refusal
        return with_alternative(refusal, Alternative(speed=vector(nearest)))

    def _pose_of(self, query: PoseQuery, telemetry: Telemetry, last: Goal | None) -> Arms:
        """Return yaw, pitch and roll (rad) of the goal; the base of a relative pose is that of `base`."""
        asked = query.yaw, query.pitch, query.roll
        if query.absolute:
            return asked
        if last is not None and last.pose is not None and telemetry.position == last.steps:
            return _sum(last.pose, asked)
        yaw, pitch, roll = self.limits.head_at(self.base(telemetry, last))
        if last is not None and last.pose is not None:
            # A held button sends a goal every moment. Between two goals the arms move on straight lines, not the head,
            # so without this it would drift by a degree about the other two axes.
            same = [was and not by for was, by in zip(last.kept, asked, strict=True)]
            yaw, pitch, roll = (
                goal if keeps else now
                for keeps, goal, now in zip(same, last.pose, (yaw, pitch, roll), strict=True)
            )
        return _sum((yaw, pitch, roll), asked)


def _kept(query: MotionQuery | PoseQuery) -> tuple[bool, bool, bool]:
    """Return whether a query is a relative pose that does not turn yaw, pitch, roll."""
    if query.absolute or not isinstance(query, PoseQuery):
        return False, False, False
    return not query.yaw, not query.pitch, not query.roll


def _sum(base: Arms, by: Arms) -> Arms:
    return base[0] + by[0], base[1] + by[1], base[2] + by[2]


def tuple3(value: Vector3) -> Arms:
    """Convert a Vector3 to a tuple."""
    return value.x, value.y, value.z


def vector(arms: Arms) -> Vector3:
    """Convert a tuple to a Vector3."""
    return Vector3(*arms)


def degrees(arms: Sequence[float]) -> str:
    """Format angles (rad) for the user: `5.0°, -2.1°, 0.0°`."""
    return ", ".join(f"{math.degrees(angle):z.1f}°" for angle in arms)
