"""Play a choreography: by the clock, where the robots do not wait for each other, or in lockstep."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import contextmanager
from typing import NamedTuple, Protocol

from msgspec.structs import replace

from beatrix_zenoh.client.choreography import Choreography, Step
from beatrix_zenoh.client.motion import Motion
from beatrix_zenoh.client.queries import checked_wait
from beatrix_zenoh.client.robot import Robot
from beatrix_zenoh.client.stopping import StopEvents
from beatrix_zenoh.client.twin.motion import ended, runs, stopped
from beatrix_zenoh.client.twin.plan import Plan
from beatrix_zenoh.client.twin.twin import Twin
from beatrix_zenoh.contract._generated.messages import MotionQuery, PoseQuery, Reason, Source
from beatrix_zenoh.contract.errors import WrongUsage, naming

POLL_S = 0.01
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
    """Play a choreography on one robot, or on both with a preview of each pose.

    By the clock, each robot begins a pose at its time, but not before it has reached its previous pose; the robots do
    not wait for each other. The hardware begins each pose `lead_s` (s) after the simulation. In lockstep a pose begins
    at its time, but not before both robots have reached the previous pose.

    `check` is called 100 times a second, in lockstep only before each pose; if it raises, playing ends. If one robot
    fails, both are stopped and playing ends. Ctrl-C stops both; the KeyboardInterrupt names their positions.

    Raises:
        WrongUsage: `lead_s` is not a valid time, or is given with lockstep or for one robot.
        Refused, Interrupted, NoAnswer: the error of the first motion that failed.
    """
    lead_s = checked_wait("lead_s", lead_s)
    if lead_s and (lockstep or isinstance(robots, Robot)):
        raise WrongUsage(
            Reason.BAD_VALUE,
            "lead_s is allowed only for both robots without lockstep: leave lead_s out.",
        )
    if isinstance(robots, Robot):
        _play_alone(robots, choreography, progress, check)
    elif lockstep:
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


def _play_alone(
    robot: Robot, choreography: Choreography, progress: Progress, check: Callable[[], None]
) -> None:
    part = _Player(robot)
    begin_s = time.monotonic()
    for title, pose in choreography.steps:
        part.waiting.append(_WaitingPose(begin_s + pose.at, request(pose), title, pose))
    with stopping([part]):
        while not part.free:
            check()
            if (due := part.advance()) is not None:
                progress(due.title, due.pose)
            time.sleep(POLL_S)


def _play_timed(
    twin: Twin,
    choreography: Choreography,
    progress: Progress,
    check: Callable[[], None],
    lead_s: float,
) -> None:
    """Preview each pose, begin it at its time on the simulation, and after the lead on the hardware."""
    twin.check_ready()
    sim, hw = _Player(twin.sim), _Player(twin.hw)
    begin_s = time.monotonic()
    coming = deque(
        _WaitingPose(begin_s + pose.at, request(pose, lead_s), title, pose)
        for title, pose in choreography.steps
    )
    preview: Future[Plan] | None = None
    # A preview takes about 0.1 s; a thread of its own makes it, so that it does not delay the hardware.
    with ThreadPoolExecutor(1, "beatrix-preview") as previews, stopping([sim, hw]):
        while coming or not (sim.free and hw.free):
            check()
            if coming and sim.free and preview is None:
                preview = previews.submit(twin.preview_query, coming[0].query)
            if preview is not None and preview.done():
                preview.result()
                preview = None
                sim.waiting.append(coming.popleft())
            if (due := sim.advance()) is not None:
                progress(due.title, due.pose)
                hw.waiting.append(due._replace(at_s=time.monotonic() + lead_s))
            hw.advance()
            time.sleep(POLL_S)
