"""The decisions of a simulation that follows: what it does next, and what its status says. No I/O, no clock.

The firmware brakes before its target, so a target at the hardware's place would be reached late: at 60 deg/s the arms
brake over the last 10 deg. The target is therefore the place at which the hardware would rest if it braked now, and the
speed is that of the hardware, corrected in proportion to the distance between the two.

`Parting` finds out that hardware and simulation are in different places although both have the same set points.
"""

from __future__ import annotations

import math
from collections import deque
from dataclasses import dataclass
from typing import Final, NamedTuple

from beatrix_zenoh.contract._generated.messages import FollowState, Positions, Status
from beatrix_zenoh.contract.names import ARMS
from beatrix_zenoh.motion.gear import Arms
from beatrix_zenoh.motion.limits import MotionLimits
from beatrix_zenoh.node.planner import tuple3

GAIN: Final = 10.0
"""Correction of the speed per distance (1/s)."""
AHEAD_S: Final = 0.1
"""Time (s) by which a target is ahead of an arm that does not brake, so that the simulation does not brake before the
next set point arrives: five periods of publication, because on a busy computer some arrive late."""
LAG_S: Final = 0.02
"""Intended lag (s) behind the received set points. The simulation hears of a brake up to a period of publication late;
without a lag it would overshoot meanwhile."""
SLOWEST: Final = math.radians(1.0)
"""Lowest speed (rad/s) of an arm, which is also that of an arm that has to wait for the hardware."""
AT_REST: Final = math.radians(0.2)
"""An arm below this velocity (rad/s) rests."""
SETTLING: Final = math.radians(20.0)
"""Lowest speed (rad/s) towards the place of a hardware that rests."""


class SetPoint(NamedTuple):
    """Set points (rad) of the arms and their velocities (rad/s)."""

    place: Arms
    velocity: Arms


class Course(NamedTuple):
    """Targets (rad) of the arms, and their top speeds (rad/s)."""

    target: Arms
    speed: Arms


def resting_place(point: SetPoint, acceleration: float) -> Arms:
    """Return the places (rad) at which the arms would rest if they braked now with this acceleration (rad/s2)."""
    (x, y, z), (u, v, w) = point.place, point.velocity
    braked = 2 * acceleration
    return x + u * abs(u) / braked, y + v * abs(v) / braked, z + w * abs(w) / braked


def advanced(point: SetPoint, by_s: float) -> SetPoint:
    """Return the set points after `by_s` (s) at constant velocity."""
    (x, y, z), (u, v, w) = point.place, point.velocity
    return SetPoint((x + u * by_s, y + v * by_s, z + w * by_s), point.velocity)


def distance(one: Arms, other: Arms) -> float:
    """Return the largest distance (rad) between the same arms."""
    return max(abs(a - b) for a, b in zip(one, other, strict=True))


def course_to(
    hardware: SetPoint, before: Arms, own: SetPoint, limits: MotionLimits, ahead_s: float = AHEAD_S
) -> Course:
    """Return the motion that keeps the simulation at the hardware.

    Args:
        hardware: its set points now.
        before: its velocities (rad/s) in the previous sample.
        own: set points of the simulation now.
        limits: those of the simulation's arms.
        ahead_s: time by which targets are ahead (s).
    """
    acceleration, speed_max = limits.acceleration, limits.speed_max
    rest = resting_place(hardware, acceleration)
    behind = advanced(hardware, -LAG_S).place
    target, speed = [], []
    for i in range(3):
        velocity, away = hardware.velocity[i], behind[i] - own.place[i]
        if abs(velocity) < AT_REST:
            target.append(hardware.place[i])
            speed.append(min(speed_max, max(SETTLING, GAIN * abs(away))))
            continue
        brakes = abs(velocity) < abs(before[i])
        end = rest[i] + (0.0 if brakes else velocity * ahead_s)
        towards = math.copysign(1.0, end - own.place[i])
        target.append(end)
        speed.append(min(speed_max, max(SLOWEST, (velocity + GAIN * away) * towards)))
    return Course((target[0], target[1], target[2]), (speed[0], speed[1], speed[2]))


ARM_APART: Final = math.radians(0.5)
"""Allowed distance (rad) of two arms at rest, less than a full step of a motor (0.69 deg)."""
HEAD_APART: Final = math.radians(1.0)
"""Allowed distance (rad) of two heads at rest in yaw, pitch and roll; near the limit of the tilt 0.5 deg of an arm make
up to twice as much."""
LATE_S: Final = 0.1
"""Allowed lag (s) in motion: the distance may be larger by the way of this time."""
LASTS_S: Final = 0.5
"""Time (s) for which the places must differ, or agree again."""
SAID_S: Final = 1.0
"""Shortest time (s) between two sentences while the places differ, because each is published with the status."""
ADVICE: Final = "Stop the hardware and look at it; then calibrate it."


class Places(NamedTuple):
    """Measured angles (rad) and velocities (rad/s) of the arms, and yaw, pitch, roll (rad) of the head."""

    arms: Arms
    velocity: Arms
    head: Arms

    @classmethod
    def of(cls, positions: Positions) -> Places:
        """Return the places of a message."""
        head = positions.head_measured or positions.head
        return cls(tuple3(positions.position), tuple3(positions.velocity), (head.yaw, head.pitch, head.roll))

    def after(self, by_s: float) -> Places:
        """Return the places after `by_s` (s) at constant velocity; the head stays."""
        (x, y, z), (u, v, w) = self.arms, self.velocity
        return self._replace(arms=(x + u * by_s, y + v * by_s, z + w * by_s))


class Parting:
    """Compares places until they differ, or agree again, for LASTS_S."""

    def __init__(self) -> None:
        self.text = ""
        """how the places differ, as a sentence; empty: they agree"""
        self._changed_s: float | None = None
        self._said_s = float("-inf")

    def reset(self) -> None:
        """Forget everything, because the set points differ."""
        self.text, self._changed_s = "", None

    def compare(self, now_s: float, simulation: Places, hardware: Places) -> None:
        """Compare the places at `now_s` (s, of any clock)."""
        different = describe(simulation, hardware)
        if bool(different) == bool(self.text):
            self._changed_s = None
            if now_s - self._said_s >= SAID_S:
                self.text, self._said_s = different, now_s
            return
        if self._changed_s is None:
            self._changed_s = now_s
        if now_s - self._changed_s >= LASTS_S:
            self.text, self._said_s, self._changed_s = different, now_s, None


def describe(simulation: Places, hardware: Places) -> str:
    """Return how the places differ, as a sentence; empty if they agree."""
    fastest = max(map(abs, (*simulation.velocity, *hardware.velocity)))
    allowed = ARM_APART + LATE_S * fastest
    apart = [abs(one - other) for one, other in zip(simulation.arms, hardware.arms, strict=True)]
    arms = [
        f"the {name} arm of the hardware is {math.degrees(angle):.1f}° away"
        for name, angle in zip(ARMS, apart, strict=True)
        if angle > allowed
    ]
    if arms:
        return f"Hardware and simulation have parted: {'; '.join(arms)}. {ADVICE}"
    heads = max(
        abs(math.remainder(one - other, math.tau))
        for one, other in zip(simulation.head, hardware.head, strict=True)
    )
    if heads > HEAD_APART + 2 * LATE_S * fastest:
        return (
            f"Hardware and simulation have parted: their arms agree, but their heads are {math.degrees(heads):.1f}° "
            "apart. Start both with the same robot file; if they have it, look at the rods."
        )
    return ""


SILENT_S: Final = 0.5
"""Time (s) without positions after which the hardware counts as lost."""
NEAR: Final = math.radians(3.0)
"""At this distance (rad) the simulation has reached the hardware."""
FAR: Final = math.radians(12.0)
"""At this distance (rad) the hardware has jumped, or the simulation was late: it approaches along a checked path."""
MOVED: Final = math.radians(1.0)
"""A target that has moved by this angle (rad) needs another path."""
PATH_S: Final = 0.1
"""Shortest time (s) between two paths."""
RETRY_S: Final = 1.0
"""Time (s) after which a refused path is planned again."""
AGE_MAX_S: Final = 0.1
"""Longest time (s) for which the hardware is taken to move on without a sample."""
SAMPLES: Final = 50
"""Number of the newest samples, one second, whose smallest delay gives the offset between the clocks."""

FASTEST: Final = math.radians(360.0)
"""No arm turns at this velocity (rad/s): such positions do not come from a robot."""

TOO_FAST: Final = "The hardware publishes impossible velocities. The simulation holds its place and waits."
NO_SET_POINTS: Final = "The hardware publishes no positions. The simulation holds its place and waits."
NO_STATUS: Final = "The state of the hardware is not known yet. The simulation holds its place and waits."


class HardwareSample(NamedTuple):
    """Positions of the hardware, as received at `arrived_s` (monotonic clock of this computer)."""

    arrived_s: float
    t_s: float
    """monotonic clock of the hardware's computer"""
    commanded: SetPoint
    places: Places

    @classmethod
    def of(cls, positions: Positions, arrived_s: float) -> HardwareSample:
        """Return the sample of a message."""
        commanded = SetPoint(tuple3(positions.commanded), tuple3(positions.velocity))
        return cls(arrived_s, positions.t_mono_ns / 1e9, commanded, Places.of(positions))


@dataclass(frozen=True)
class Step:
    """The next motion; `straight`: along a path that must be checked."""

    course: Course
    straight: bool
    careful: Course | None = None
    """the motion to send if the firmware refuses the course: its target is not ahead of the hardware"""


class Follower:
    """The state of one simulation that follows; all times are of this computer's monotonic clock (s)."""

    def __init__(self, now_s: float) -> None:
        self._begun_s = now_s
        self._sample: HardwareSample | None = None
        self._before: Arms = (0.0, 0.0, 0.0)
        self._delays: deque[float] = deque(maxlen=SAMPLES)
        self._unready = NO_STATUS
        """why the set points of the hardware mean nothing; empty: they are valid"""
        self._reached = False
        self._planned: Arms | None = None
        self._plan_due_s = now_s
        self._refusal = ""
        self._parting = Parting()

    # -- what is received ---------------------------------------------------------------------------

    def hear(self, sample: HardwareSample) -> None:
        """Record the newest positions of the hardware."""
        last = self._sample
        if last is not None and sample.arrived_s - last.arrived_s > SILENT_S:
            # Another node may publish now, on another computer, and its home may be lost.
            self._delays.clear()
            self._unready = NO_STATUS
        self._before = (0.0, 0.0, 0.0) if last is None else last.commanded.velocity
        self._sample = sample
        self._delays.append(sample.arrived_s - sample.t_s)

    def hear_status(self, status: Status) -> None:
        """Record whether the set points of the hardware are valid."""
        self._unready = why_unready(status)

    # -- what follows from it -----------------------------------------------------------------------

    def waits_for(self, now_s: float) -> str:
        """Return why the simulation cannot follow now, as a sentence; empty if it can."""
        sample = self._sample
        if sample is None or now_s - sample.arrived_s > SILENT_S:
            return self._unready if sample is None and now_s < self._begun_s + SILENT_S else NO_SET_POINTS
        if max(map(abs, sample.commanded.velocity)) > FASTEST:
            return TOO_FAST
        return self._unready

    def state(self, now_s: float) -> FollowState:
        """Return the state of following."""
        if self.waits_for(now_s) or self._refusal:
            return FollowState.WAITING
        if not self._reached:
            return FollowState.APPROACHING
        return FollowState.PARTED if self._parting.text else FollowState.FOLLOWING

    def warnings(self, now_s: float) -> list[str]:
        """Return the sentences for the status."""
        return [text for text in (self.waits_for(now_s) or self._refusal or self._parting.text,) if text]

    def step(self, now_s: float, own: SetPoint, limits: MotionLimits) -> Step | None:
        """Return the next motion, None to continue the last one; `own`: set points of the simulation now."""
        sample = self._sample
        if sample is None or self.waits_for(now_s):
            return None
        hardware = advanced(sample.commanded, self._age_s(now_s))
        away = distance(hardware.place, own.place)
        if away < (FAR if self._reached else NEAR):
            self._reached, self._planned, self._refusal = True, None, ""
            ahead, careful = (
                course_to(hardware, self._before, own, limits, ahead_s) for ahead_s in (AHEAD_S, 0.0)
            )
            return Step(ahead, straight=False, careful=careful)
        self._reached = False
        self._parting.reset()
        return self._path(now_s, hardware, limits)

    def _path(self, now_s: float, hardware: SetPoint, limits: MotionLimits) -> Step | None:
        """Return a path to the place at which the hardware would rest, if the last path does not lead there."""
        target = resting_place(hardware, limits.acceleration)
        if now_s < self._plan_due_s or (
            self._planned is not None and distance(target, self._planned) < MOVED
        ):
            return None
        self._planned, self._plan_due_s = target, now_s + PATH_S
        speed = min(limits.speed_max, limits.default_speed + max(map(abs, hardware.velocity)))
        return Step(Course(target, (speed, speed, speed)), straight=True)

    def accepted(self) -> None:
        """Record that the last path is within the limits."""
        self._refusal = ""

    def refused(self, now_s: float, message: str) -> None:
        """Record why the simulation cannot take the last path; it is planned again after RETRY_S."""
        self._refusal = f"The simulation cannot move to the place of the hardware: {message}"
        self._planned, self._plan_due_s = None, now_s + RETRY_S

    def compare(self, now_s: float, own: Places) -> None:
        """Compare the measured places of the simulation at `now_s` with those of the hardware."""
        sample = self._sample
        if sample is not None and self._reached and not self.waits_for(now_s):
            self._parting.compare(now_s, own, sample.places.after(self._age_s(now_s)))

    def hold(self) -> None:
        """Forget the path: the simulation holds its place until the hardware is back."""
        self._reached, self._planned, self._refusal = False, None, ""
        self._parting.reset()

    def _age_s(self, now_s: float) -> float:
        """Return the age (s) of the newest sample, apart from the smallest delay of the last second."""
        sample = self._sample
        if sample is None:
            return 0.0
        return min(AGE_MAX_S, max(0.0, now_s - sample.t_s - min(self._delays)))


def why_unready(status: Status) -> str:
    """Return why the set points in this state of the hardware mean nothing, as a sentence; empty if they are valid."""
    if not status.board.connected:
        return "The board of the hardware is not connected. The simulation holds its place and waits."
    if not status.enabled:
        return "The motors of the hardware are off. The simulation holds its place and waits."
    if not status.calibrated:
        return "The hardware is not calibrated. The simulation holds its place and waits."
    return ""
