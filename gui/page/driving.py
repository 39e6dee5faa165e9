"""The session, the lease and the requests of a page that drives a robot, on a thread of their own."""

from __future__ import annotations

import math
import threading
import time
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Final

from beatrix_zenoh import threads
from beatrix_zenoh.client import Client, Motion, Robot
from beatrix_zenoh.client.session import Place
from beatrix_zenoh.client.stopping import publish_stop
from beatrix_zenoh.contract._generated.messages import MotionQuery, PoseQuery, Reason, Source, Vector3
from beatrix_zenoh.contract.errors import BeatrixError, Refused
from beatrix_zenoh.contract.names import ARMS
from beatrix_zenoh.settings import Settings
from gui.page.messages import ROTATIONS, Hold, Outcome, refused

DEAD_MAN_S: Final = 0.4
"""Longest time without a heartbeat of the page; then a moving robot is stopped. Pages send ten heartbeats a second."""
AHEAD_S: Final = 0.5
"""Time to each goal of a jog, longer than network delays; without a new goal the jog ends by itself."""
BRAKE_S: Final = 0.12
"""Like AHEAD_S, for the last goal of a jog: an arm at 40 deg/s needs 0.11 s to come to rest."""
SMALLEST_DEG: Final = 0.5
"""Shortest motion of a jog near a limit."""
WAITING_MAX: Final = 4
"""Largest number of queued requests of a driver."""
QUEUE_S: Final = 3600.0
"""Longest wait in the queue of the robot."""
LIMITS: Final = (Reason.OUT_OF_REACH, Reason.ARM_GAP, Reason.YAW_LIMIT)
NO_ERROR: Final = (Reason.REPLACED, Reason.STOPPED)
"""Reasons for the end of a motion that are not reported, because a user has caused them."""

Report = Callable[[Outcome], object]
"""Takes the outcome of a request. Called on any thread."""


@dataclass(frozen=True)
class Task:
    """A command or motion for the thread of a driver."""

    control: str
    work: Callable[[], str]
    """sends the request and returns a sentence; empty: nothing to report"""


class Driver:
    """Drives one robot for one page.

    The arms move only while heartbeats arrive: a jog consists of goals that are half a second ahead, one for each
    heartbeat, and the server stops every motion if `silent` exceeds DEAD_MAN_S.
    """

    def __init__(
        self, settings: Settings, place: Place, report: Report, ended: Callable[[str], None]
    ) -> None:
        """Start a thread that connects, takes the robot or waits for it, and sends the requests.

        Args:
            settings: router and seat.
            place: name and side of the robot.
            report: takes the outcome of each request.
            ended: called once with the reason when the driver has ended by itself.
        """
        self.seat, self.place = settings.who, place
        self.lease = 0
        """Number of the lease; 0: the driver waits for the robot."""
        self.client: Client | None = None
        self.stopped = False
        """Whether the robot was stopped because the page is silent or hidden."""
        self._confirmed = False
        self._settings, self._report, self._ended = settings, report, ended
        self._wake = threading.Condition()
        self._waiting: deque[Task] = deque()
        self._jog: tuple[Hold, float] | None = None
        """The jog to continue, and the time to its next goal (s)."""
        self._last_hold: Hold | None = None
        self._over = 0
        """All presses up to this number have ended."""
        self._stops = 0
        self._closed = False
        self._running: Motion | None = None
        self._beat_s = time.monotonic()
        threads.start(self._run, f"web-{self.seat}")

    # -- the server's thread; only `close` waits -----------------------------------------------------

    def beat(self) -> None:
        """Record a heartbeat of the page, and clear `stopped`."""
        self._beat_s = time.monotonic()
        self.stopped = False

    def silent(self) -> float:
        """Return the time since the last heartbeat (s)."""
        return time.monotonic() - self._beat_s

    def lost(self, lease: int, holder: str) -> bool:
        """Return whether a status shows that the lease has ended; a status from before the lease does not."""
        if lease == self.lease:
            self._confirmed = bool(lease)
        return self._confirmed and (lease, holder) != (self.lease, self.seat)

    @property
    def busy(self) -> bool:
        """Whether the robot moves, or is about to move, for this page."""
        return self._running is not None or self._jog is not None or bool(self._waiting)

    def hold(self, hold: Hold) -> None:
        """Begin or continue the jog of a held button; do nothing if this press has ended."""
        self._put_jog(hold, AHEAD_S)

    def release(self, press: int) -> None:
        """End the jog of a press."""
        jog = self._last_hold
        if jog is not None and jog.press == press:
            self._put_jog(jog, BRAKE_S)
            self._over = max(self._over, press)

    def _put_jog(self, hold: Hold, ahead_s: float) -> None:
        with self._wake:
            if hold.press > self._over:
                self._last_hold = hold
                self._jog = hold, ahead_s
                self._wake.notify()

    def put(self, control: str, work: Callable[[], str]) -> None:
        """Queue a request, which ends a jog; report a refusal if the queue is full. For the arguments see `Task`."""
        with self._wake:
            self._end_jog()
            full = len(self._waiting) >= WAITING_MAX
            if not full:
                self._waiting.append(Task(control, work))
                self._wake.notify()
        if full:
            self._report(
                refused(
                    control,
                    f"{WAITING_MAX} requests are waiting: send the next one after the robot has answered.",
                )
            )

    def drop(self) -> None:
        """Drop waiting requests and end the jog; held buttons must be pressed again."""
        with self._wake:
            self._stops += 1
            self._waiting.clear()
            self._end_jog()

    def _end_jog(self) -> None:
        self._jog = None
        if self._last_hold is not None:
            self._over = max(self._over, self._last_hold.press)

    def close(self) -> None:
        """End the session: the robot stops its motion, and the lease ends.

        Waits for the router; may be called twice.
        """
        with self._wake:
            self._closed = True
            self._wake.notify()
            client = self.client
        self.drop()
        if client is not None:
            client.close()

    # -- the driver's thread -------------------------------------------------------------------------

    def _run(self) -> None:
        try:
            self._drive()
        except BeatrixError as error:
            if not self._closed:
                self._ended(error.message)
        finally:
            self.close()

    def _drive(self) -> None:
        client = Client(self._settings, source=Source.PAGE)
        with self._wake:
            self.client = client
            closed = self._closed
        if closed:  # `close` was called before there was a client
            client.close()
            return
        self._robot = Robot(*self.place, client=client)
        self.lease = self._robot.lease(wait_s=QUEUE_S).number
        self._report(Outcome("drive", ok=True))
        while (task := self._next()) is not None:
            try:
                if text := task.work():
                    self._report(Outcome(task.control, ok=True, text=text))
            except BeatrixError as error:
                self.drop()
                self._report(refused(task.control, error.message))

    def _next(self) -> Task | None:
        """Wait for the next request and return it, queued ones before jogs; None after `close`."""
        with self._wake:
            self._wake.wait_for(lambda: self._closed or self._waiting or self._jog)
            if self._closed:
                return None
            if self._waiting:
                return self._waiting.popleft()
            jog, self._jog = self._jog, None
        assert jog is not None
        hold, ahead_s = jog
        return Task(hold.part, partial(self._step, hold, ahead_s))

    def _step(self, hold: Hold, ahead_s: float) -> str:
        """Send one goal of a jog; near a limit a shorter one. Raises Refused if no goal is accepted."""
        while True:
            try:
                self._begin(hold.part, jog_query(hold, ahead_s))
                return ""
            except Refused as error:
                ahead_s /= 2
                if error.reason not in LIMITS or hold.speed * ahead_s < SMALLEST_DEG:
                    raise

    def begin(self, control: str, query: MotionQuery | PoseQuery) -> None:
        """Queue a motion."""
        self.put(control, partial(self._begin, control, query))

    def _begin(self, control: str, query: MotionQuery | PoseQuery) -> str:
        stops = self._stops
        motion = self._robot.begin(query)
        self._running = motion
        if self._stops != stops:  # STOP was sent meanwhile and may have arrived before the motion: repeat it
            publish_stop(self._robot.client, self.place)
        motion.add_done_callback(partial(self._done, control))
        return motion.accepted.message

    def _done(self, control: str, motion: Motion) -> None:
        if self._running is motion:
            self._running = None
        error = motion.exception(0.0)
        if error is not None and error.reason not in NO_ERROR and not self._closed:
            self._report(refused(control, error.message))

    def command(self, command: str) -> None:
        """Queue one of COMMANDS."""
        self.put(command, lambda: COMMANDS[command](self._robot))


def jog_query(hold: Hold, ahead_s: float) -> MotionQuery | PoseQuery:
    """Return the motion from the present set point for `ahead_s` at the speed of a jog."""
    speed, angle = math.radians(hold.speed), math.radians(hold.sign * hold.speed * ahead_s)
    if hold.part in ROTATIONS:
        yaw, pitch, roll = (angle if hold.part == part else 0.0 for part in ROTATIONS)
        return PoseQuery(absolute=False, yaw=yaw, pitch=pitch, roll=roll, speed=speed)
    x, y, z = (angle if hold.part == part else 0.0 for part in ARMS)
    return MotionQuery(absolute=False, position=Vector3(x, y, z), speed=Vector3(speed, speed, speed))


def home_query(speed_deg_s: float) -> MotionQuery:
    """Return the motion of all arms to 0 degrees."""
    speed = math.radians(speed_deg_s)
    return MotionQuery(position=Vector3(0.0, 0.0, 0.0), speed=Vector3(speed, speed, speed))


def make_ready(robot: Robot) -> str:
    """Enable and calibrate the robot as far as needed."""
    robot.make_ready()
    return "Motors on, home declared."


def disable(robot: Robot) -> str:
    """Switch the motors off."""
    robot.disable()
    return "Motors off."


def reset(robot: Robot) -> str:
    """Clear the latch of the emergency stop."""
    robot.reset()
    return "Reset. The motors are off."


COMMANDS: Final[dict[str, Callable[[Robot], str]]] = {"ready": make_ready, "disable": disable, "reset": reset}
"""Functions that send the commands of a page and return a sentence."""
