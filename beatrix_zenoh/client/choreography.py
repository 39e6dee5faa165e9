"""Choreographies: motion files with speeds, whose poses begin at given times, and playing them on one robot or both."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import contextmanager
from importlib import resources
from pathlib import Path
from typing import Final, NamedTuple, Protocol

import msgspec
from msgspec.structs import replace

from beatrix_zenoh.client import motion_file, own_gestures
from beatrix_zenoh.client.degrees import HeadAngles, checked_seconds, motion_query, pose_query
from beatrix_zenoh.client.motion import Motion
from beatrix_zenoh.client.motion_file import FORM, SPEED, MotionFile, WrongLine
from beatrix_zenoh.client.robot import Robot
from beatrix_zenoh.client.stopping import StopEvents
from beatrix_zenoh.client.twin import Plan, Twin
from beatrix_zenoh.client.twin_motion import ended, runs, stopped
from beatrix_zenoh.contract._generated.messages import MotionQuery, PoseQuery, Source
from beatrix_zenoh.contract.errors import naming, wrong_usage

SHIPPED = resources.files("beatrix_zenoh") / "choreographies"
EMOTIONS: Final = {
    "happy": "😀",
    "surprised": "😲",
    "curious": "😏",
    "afraid": "😨",
    "sad": "😢",
    "bored": "😒",
    "sleepy": "😴",
    "angry": "😠",
}
"""Gestures that show an emotion, in the order of the wheel of the window, and their emoji."""
GESTURES: Final = ("yes", "no", "hello", "dance", *EMOTIONS)
"""Shipped choreographies that last a few seconds, and begin and end at home."""
POLL_S = 0.01
"""Period (s) in which playing by the clock looks at both robots."""


class Pose(msgspec.Struct, frozen=True):
    """A pose of the head (deg), its time (s after the start) and speed (deg/s)."""

    at: float
    yaw: float
    pitch: float
    roll: float
    speed: float

    def query(self) -> PoseQuery:
        """Return the request for this pose; its speed is that of the fastest arm."""
        return pose_query(self.yaw, self.pitch, self.roll, relative=False, speed=self.speed)

    def __str__(self) -> str:
        return f"yaw {self.yaw:+g}°, pitch {self.pitch:+g}°, roll {self.roll:+g}°"


class ArmPose(msgspec.Struct, frozen=True):
    """A position of the arms (deg), its time (s after the start) and speed (deg/s)."""

    at: float
    short: float
    middle: float
    long: float
    speed: float

    def query(self) -> MotionQuery:
        """Return the request for this position; its speed is that of each arm."""
        return motion_query(self.short, self.middle, self.long, relative=False, speed=self.speed)

    def __str__(self) -> str:
        return f"arms short {self.short:+g}°, middle {self.middle:+g}°, long {self.long:+g}°"


Step = Pose | ArmPose


class Choreography(msgspec.Struct, frozen=True):
    """A sequence of poses, each with the name of its gesture."""

    steps: list[tuple[str, Step]]
    source: str = ""
    """the name in error messages; empty: no file"""
    lines: tuple[int, ...] = ()
    """the line of each step in the file; empty: no file"""

    def at_speed(self, speed: float) -> Choreography:
        """Return this choreography with one speed (deg/s) for all steps; raises WrongUsage unless it is above 0."""
        speed = checked_speed(speed)
        return self._with_speeds(lambda _: speed)

    def at_most(self, speed: float) -> Choreography:
        """Return this choreography with no speed above `speed` (deg/s); raises WrongUsage unless it is above 0."""
        most = checked_speed(speed)
        return self._with_speeds(lambda speed: min(speed, most))

    def _with_speeds(self, change: Callable[[float], float]) -> Choreography:
        steps = [(title, replace(pose, speed=change(pose.speed))) for title, pose in self.steps]
        return replace(self, steps=steps)

    def where(self, index: int) -> str:
        """Return the place of a step for error messages: file, line or number, and time."""
        line = f"line {self.lines[index]}" if self.lines else f"step {index + 1}"
        source = f"{self.source}, " if self.source else ""
        return f"{source}{line} (t = {self.steps[index][1].at:.2f} s)"


def shipped(name: str) -> Choreography:
    """Return a choreography that comes with the package: one of `GESTURES`, or `demo`."""
    return choreography(motion_file.parse((SHIPPED / f"{name}.csv").read_text(encoding="utf-8"), name))


def load(name: Path | str) -> Choreography:
    """Read a choreography from a file; without such a file the shipped one, or the user's gesture, of this name.

    Raises:
        WrongUsage: BAD_VALUE; the message names the wrong line.
    """
    path = Path(name)
    if not path.exists():
        if (SHIPPED / f"{path}.csv").is_file():
            return shipped(str(path))
        path = own_gestures.file_of(str(name)) or path
    try:
        return choreography(motion_file.read(path))
    except OSError as error:
        names = ", ".join(sorted(entry.name.removesuffix(".csv") for entry in SHIPPED.iterdir()))
        raise wrong_usage(
            f"{path} cannot be read: {error.strerror}. Name a file, a gesture of yours in {own_gestures.folder()}, "
            f"or a shipped choreography: {names}.",
        ) from error


def choreography(read: MotionFile) -> Choreography:
    """Return the choreography in a motion file; raises WrongUsage (BAD_VALUE) for a path or a missing speed."""
    if not read.with_speed:
        raise wrong_usage(
            f"{read.source} has no column {SPEED}, so it is a path: play it with `beatrix replay`.",
        )
    speed, title = read.points[0].speed, Path(read.source).stem
    steps: list[tuple[str, Step]] = []
    if speed is None:
        raise WrongLine(
            read.points[0].line,
            f"{read.source}, line {read.points[0].line}: {SPEED} is empty in the first point. Give "
            f"a number of degrees/s; in later lines an empty cell keeps the speed. {FORM}",
        )
    for point in read.points:
        speed, title = point.speed or speed, point.figure or title
        at, place = point.t, point.place
        if isinstance(place, HeadAngles):
            steps.append((title, Pose(at, *place, speed)))
        else:
            steps.append((title, ArmPose(at, *place, speed)))
    return Choreography(steps, read.source, tuple(point.line for point in read.points))


def checked_speed(speed: float) -> float:
    """Return the speed (deg/s); raise WrongUsage unless it is above 0 and fits into a message."""
    pose_query(0, 0, 0, relative=False, speed=speed)
    if speed <= 0:
        raise wrong_usage(f"speed is {speed:g}: give a number of degrees/s above 0.")
    return speed


Progress = Callable[[str, Step], None]
"""Called with the name of the gesture and the pose that begins."""


def play(
    robots: Twin | Robot,
    choreography: Choreography,
    progress: Progress = lambda _title, _pose: None,
    *,
    lead_s: float = 0.0,
    lockstep: bool = False,
    check: Callable[[], None] = lambda: None,
) -> None:
    """Play a choreography on one robot, or on both robots of a `Twin` with a preview of each pose.

    By the clock, each robot begins a pose at its time, but not before it has reached its previous pose; the robots do
    not wait for each other. The hardware begins each pose `lead_s` (s) after the simulation. In lockstep a pose begins
    at its time, but not before both robots have reached the previous pose.

    `check` is called 100 times a second, in lockstep only before each pose; if it raises, playing ends. If one robot
    fails, both are stopped and playing ends. Ctrl-C stops both; the KeyboardInterrupt names their positions.

    Raises:
        WrongUsage: `lead_s` is not a valid time, or is given with lockstep or for one robot.
        Refused, Interrupted, NoAnswer: the error of the first motion that failed.
    """
    lead_s = checked_seconds("lead_s", lead_s, zero=True)
    if lead_s and (lockstep or isinstance(robots, Robot)):
        raise wrong_usage(
            "lead_s is allowed only for both robots without lockstep: leave lead_s out.",
        )
    if lockstep and not isinstance(robots, Robot):
        _play_lockstep(robots, choreography, progress, check)
    else:
        _play_timed(robots, choreography, progress, check, lead_s)


def _play_lockstep(
    twin: Twin, choreography: Choreography, progress: Progress, check: Callable[[], None]
) -> None:
    begin_s = time.monotonic()
    for title, pose in choreography.steps:
        plan = twin.preview_query(request(pose))
        time.sleep(max(0.0, begin_s + pose.at - time.monotonic()))
        check()
        progress(title, pose)
        plan.commit()


def request(pose: Step, lead_s: float | None = None) -> MotionQuery | PoseQuery:
    """Return the request for a pose of a choreography; `lead_s`: as `lead` of the request."""
    return replace(pose.query(), source=Source.PLAY, lead=lead_s)


class _WaitingPose(NamedTuple):
    """A pose and the time when it is due (s, monotonic clock)."""

    at_s: float
    query: MotionQuery | PoseQuery
    title: str
    pose: Step


class _Player:
    """Plays poses on one robot, one after the other."""

    def __init__(self, robot: Robot) -> None:
        self.robot = robot
        self.motion: Motion | None = None
        self.waiting: deque[_WaitingPose] = deque()
        self.stops = StopEvents(robot)

    @property
    def free(self) -> bool:
        """Whether the robot has reached its last pose and no pose waits."""
        return self.motion is None and not self.waiting

    def advance(self) -> _WaitingPose | None:
        """Begin the next pose if its time has come, and return it.

        Raises:
            Interrupted: STOP was pressed, even while no motion ran; or as `ended`.
            Refused, NoAnswer: as `Robot.begin`.
        """
        self.stops.check()
        if self.motion is not None and ended(self.robot, self.motion, 0.0):
            self.motion = None
        if self.motion is not None or not self.waiting or time.monotonic() < self.waiting[0].at_s:
            return None
        due = self.waiting.popleft()
        with naming(str(self.robot)):
            self.motion = self.robot.begin(due.query)
        return due

    def close(self) -> None:
        """End the subscription to STOP events."""
        self.stops.close()


class MovedRobot(Protocol):
    """A robot that this program moves."""

    robot: Robot
    motion: Motion | None

    def close(self) -> None:
        """End the subscriptions of this object."""


@contextmanager
def stopping(parts: Sequence[MovedRobot]) -> Iterator[None]:
    """Stop all moving robots if the block raises; close all parts at the end."""
    try:
        yield
    except BaseException as error:
        moving = [part.robot for part in parts if part.motion is not None and runs(part.motion)]
        failure = stopped(error, moving)
        if failure is error:
            raise
        raise failure from error
    finally:
        for part in parts:
            part.close()


def _play_timed(
    robots: Twin | Robot,
    choreography: Choreography,
    progress: Progress,
    check: Callable[[], None],
    lead_s: float,
) -> None:
    """Begin each pose at its time; on both robots preview it, and begin it on the hardware after the lead."""
    if isinstance(robots, Robot):
        twin, first, others = None, _Player(robots), []
    else:
        robots.check_ready()
        twin, first, others = robots, _Player(robots.sim), [_Player(robots.hw)]
    begin_s, lead = time.monotonic(), lead_s if others else None
    coming = deque(
        _WaitingPose(begin_s + pose.at, request(pose, lead), title, pose)
        for title, pose in choreography.steps
    )
    preview: Future[Plan] | None = None
    # A preview takes about 0.1 s; a thread of its own makes it, so that it does not delay the hardware.
    with ThreadPoolExecutor(1, "beatrix-preview") as previews, stopping([first, *others]):
        while coming or not all(part.free for part in (first, *others)):
            check()
            if coming and first.free and preview is None and twin is not None:
                preview = previews.submit(twin.preview_query, coming[0].query)
            if coming and (twin is None or (preview is not None and preview.done())):
                if preview is not None:
                    preview.result()
                preview = None
                first.waiting.append(coming.popleft())
            if (due := first.advance()) is not None:
                progress(due.title, due.pose)
                for other in others:
                    other.waiting.append(due._replace(at_s=time.monotonic() + lead_s))
            for other in others:
                other.advance()
            time.sleep(POLL_S)
