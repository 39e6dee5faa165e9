"""The SDK: one robot, simulated or real. Synchronous; angles in degrees."""

from __future__ import annotations

import math
import threading
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from numbers import Real
from typing import Self

from beatrix_zenoh import codec, names
from beatrix_zenoh._generated import keys
from beatrix_zenoh._generated.messages import (
    Command,
    CommandQuery,
    CommandReply,
    Info,
    MotionQuery,
    MotionReply,
    PoseQuery,
    Positions,
    Reason,
    Status,
    Vector3,
)
from beatrix_zenoh.client import Client, Conversation
from beatrix_zenoh.errors import BeatrixError, Interrupted, NoAnswer, Refused, WrongUsage
from beatrix_zenoh.readings import Reading, reading
from beatrix_zenoh.settings import resolve

MARGIN_S = 3.0
"""How much longer than announced a motion may take before its end counts as lost."""
SILENT = "{} did not say that the motion has ended: it is frozen, has gone, or this computer is very busy."
STREAM_LENGTH = 3000
"""Positions a stream keeps for a slow reader: one minute."""


class Motion:
    """A motion under way."""

    def __init__(self, robot: Robot, conversation: Conversation, accepted: MotionReply) -> None:
        self._robot, self._conversation = robot, conversation
        self.duration = accepted.duration
        """Seconds the robot announced."""
        self._end: MotionReply | None = None

    def __repr__(self) -> str:
        return f"<motion of {self._robot}: {self._end.message if self._end else f'{self.duration:.1f} s'}>"

    def poll(self, timeout_s: float) -> MotionReply | None:
        """The final reply, None if it has not come within `timeout_s`."""
        if self._end is None:
            try:
                self._end = self._conversation.next(MotionReply, timeout_s)
            except NoAnswer as error:
                if error.reason is not Reason.TIMED_OUT:
                    raise
                return None
            self._conversation.close()
        return self._end

    def wait(self) -> MotionReply:
        """Return when the head is there. Ctrl-C stops the robot; the KeyboardInterrupt says where.

        Raises:
            Interrupted: it ended elsewhere: stopped, replaced, lost.
            NoAnswer: the robot has gone.
        """
        try:
            end = self.poll(self.duration + MARGIN_S)
        except KeyboardInterrupt as interrupt:
            raise KeyboardInterrupt(f"{self._robot}: {self._robot.stop().message}") from interrupt
        if end is None:
            raise NoAnswer(Reason.TIMED_OUT, SILENT.format(self._robot))
        if not end.result:
            raise Interrupted(end.reason, end.message)
        return end


class PositionStream:
    """Published positions as they come; the oldest are dropped when nobody takes them."""

    def __init__(self) -> None:
        self._news = threading.Condition()
        self._waiting: deque[Positions] = deque(maxlen=STREAM_LENGTH)

    def receive(self, payload: bytes) -> None:
        """Hand over one publication."""
        positions = codec.decode(payload, Positions)
        with self._news:
            self._waiting.append(positions)
            self._news.notify()

    def take(self, timeout_s: float) -> list[Positions]:
        """All that has come since the last call; waits up to `timeout_s` for the first."""
        with self._news:
            self._news.wait_for(lambda: bool(self._waiting), timeout=timeout_s)
            taken = list(self._waiting)
            self._waiting.clear()
            return taken


class Robot:
    """One robot: `Robot("bea1", twin="sim")`. Use it in a `with` block, or close it.

    Args:
        name: the robot; default BEATRIX_ROBOT, then beatrix.toml, then `user-host`. Whether it is on line shows
            the first question or motion.
        twin: `sim` or `hw`.
        connect: the router, default BEATRIX_CONNECT or tcp/127.0.0.1:7447.
        who: your seat, default BEATRIX_WHO or the user's name.
        timeout_s: how long to wait for an answer.
        client: a session to share; opened and closed by somebody else.

    Raises:
        NoAnswer: NO_ROUTER.
    """

    def __init__(
        self,
        name: str | None = None,
        twin: str = "sim",
        *,
        connect: str | None = None,
        who: str | None = None,
        timeout_s: float = 2.0,
        client: Client | None = None,
    ) -> None:
        if twin not in names.TWINS:
            raise Refused(Reason.BAD_VALUE, f"twin={twin!r}: choose 'sim' or 'hw'.")
        self._shared = client is not None
        self.client = Client(resolve(name, connect, who)) if client is None else client
        self.name = names.check_name(name or self.client.settings.robot)
        self.twin, self.timeout_s = twin, timeout_s

    def __str__(self) -> str:
        return f"{self.name} ({self.twin})"

    def __repr__(self) -> str:
        return f"<robot {self} at {self.client.bus.endpoint}>"

    # -- commands -------------------------------------------------------------------------------

    def enable(self) -> None:
        """Motors on."""
        self.command(Command.ENABLE)

    def disable(self) -> None:
        """Motors off; home is forgotten."""
        self.command(Command.ENABLE, value=False)

    def calibrate(self) -> None:
        """Declare the present position home: set the head upright first."""
        self.command(Command.CALIBRATE)

    def home(self) -> None:
        """Move all arms home; returns when there, and raises as `move`."""
        self.move(0, 0, 0)

    def stop(self) -> CommandReply:
        """Stop at once, whoever drives; returns when the arms rest."""
        return self.press_stop()()

    def press_stop(self) -> Callable[[], CommandReply]:
        """Send STOP; what is returned waits until the arms rest, and raises as `command`."""
        key = keys.stop(self.name, self.twin)
        conversation = Conversation(self.client, self.name, self.twin, key, None)

        def wait() -> CommandReply:
            with conversation:
                return self._checked(conversation.next(CommandReply, self.timeout_s))

        return wait

    def emergency_stop(self) -> CommandReply:
        """Motors off at once; the head falls. ENABLE and CALIBRATE afterwards."""
        return self.command(Command.EMERGENCY_STOP)

    def command(
        self, command: Command, *, value: bool = True, timeout_s: float | None = None
    ) -> CommandReply:
        """Any command; raises Refused with the robot's reason, NoAnswer if nobody answers."""
        key = keys.command(self.name, self.twin, self.client.settings.who)
        query = CommandQuery(command=command.value, value=value)
        timeout_s = self.timeout_s if timeout_s is None else timeout_s
        return self._checked(self.client.ask(self.name, self.twin, key, query, CommandReply, timeout_s))

    @staticmethod
    def _checked(reply: CommandReply) -> CommandReply:
        if not reply.result:
            raise Refused(reply.reason, reply.message)
        return reply

    # -- motions --------------------------------------------------------------------------------

    def look(
        self,
        yaw: float = 0.0,
        pitch: float = 0.0,
        roll: float = 0.0,
        *,
        relative: bool = False,
        speed: float | None = None,
        wait: bool = True,
    ) -> Motion:
        """Turn the head (deg: yaw left, pitch nose-down, roll right-ear-down positive).

        `speed` is that of the fastest arm, deg/s. Returns when there, or at once with wait=False.

        Raises:
            Refused: with the reason and what would be accepted; nothing has moved.
            Interrupted: the motion ended elsewhere.
        """
        return self._begin("pose", pose_query(yaw, pitch, roll, relative=relative, speed=speed), wait=wait)

    def move(
        self,
        short: float,
        middle: float,
        long: float,
        *,
        relative: bool = False,
        speed: float | None = None,
        wait: bool = True,
    ) -> Motion:
        """Turn the arms (deg, counter-clockwise from above positive); `speed` in deg/s for each; else as `look`."""
        query = motion_query(short, middle, long, relative=relative, speed=speed)
        return self._begin("motion", query, wait=wait)

    def _begin(self, road: str, query: MotionQuery | PoseQuery, *, wait: bool) -> Motion:
        waits = switch("wait", wait)
        motion = self.begin(road, query)
        if waits:
            motion.wait()
        return motion

    def begin(self, road: str, query: MotionQuery | PoseQuery) -> Motion:
        """Send a motion on `motion` or `pose` and return once it is accepted; raises Refused."""
        key_of = keys.motion if road == "motion" else keys.pose
        key = key_of(self.name, self.twin, self.client.settings.who)
        conversation = Conversation(self.client, self.name, self.twin, key, query)
        try:
            accepted = conversation.next(MotionReply, self.timeout_s)
        except BaseException:
            conversation.stop_if_accepted(keys.stop(self.name, self.twin))
            raise
        if not accepted.result:
            conversation.close()
            raise Refused(accepted.reason, accepted.message)
        return Motion(self, conversation, accepted)

    # -- state ----------------------------------------------------------------------------------

    def positions(self) -> Reading:
        """Where the robot is now, in degrees."""
        key = keys.positions(self.name, self.twin)
        return reading(self.client.ask(self.name, self.twin, key, None, Positions, self.timeout_s))

    def status(self) -> Status:
        """State of the robot: enabled, calibrated, who drives, what is wrong."""
        key = keys.status(self.name, self.twin)
        return self.client.ask(self.name, self.twin, key, None, Status, self.timeout_s)

    def info(self) -> Info:
        """Versions, limits and keys."""
        key = keys.info(self.name, self.twin)
        return self.client.ask(self.name, self.twin, key, None, Info, self.timeout_s)

    def stream(self) -> PositionStream:
        """Published positions (rad, 50 a second) from now on, until this robot is closed."""
        stream = PositionStream()
        self.client.bus.subscribe(keys.positions(self.name, self.twin), lambda _, data: stream.receive(data))
        return stream

    def close(self) -> None:
        """Leave the bus; a motion this robot object asked for and that still runs is stopped."""
        if not self._shared:
            self.client.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exc: object) -> None:
        self.close()


def stop_together(robots: Iterable[Robot]) -> Iterator[tuple[Robot, CommandReply | BeatrixError]]:
    """Press STOP on all before waiting for any; what each says, or why it says nothing."""
    pressed = [(robot, robot.press_stop()) for robot in robots]
    for robot, wait in pressed:
        try:
            yield robot, wait()
        except BeatrixError as error:
            yield robot, error


def pose_query(yaw: float, pitch: float, roll: float, *, relative: bool, speed: float | None) -> PoseQuery:
    """Degrees to a query; raises WrongUsage if one is no finite number, or `relative` no bool."""
    return PoseQuery(
        absolute=not switch("relative", relative),
        yaw=to_rad("yaw", yaw),
        pitch=to_rad("pitch", pitch),
        roll=to_rad("roll", roll),
        speed=None if speed is None else to_rad("speed", speed, "degrees/s"),
    )


def motion_query(
    short: float, middle: float, long: float, *, relative: bool, speed: float | None
) -> MotionQuery:
    """Degrees to a query; raises as `pose_query`."""
    each = None if speed is None else Vector3(*[to_rad("speed", speed, "degrees/s")] * 3)
    position = Vector3(to_rad("short", short), to_rad("middle", middle), to_rad("long", long))
    return MotionQuery(absolute=not switch("relative", relative), position=position, speed=each)


def to_rad(what: str, angle: float, unit: str = "degrees") -> float:
    """Degrees, or degrees/s, to rad; raises WrongUsage if it is no number that a message can hold."""
    if not isinstance(angle, Real) or isinstance(angle, bool):
        raise WrongUsage(Reason.BAD_VALUE, f"{what} is {angle!r}: give a number of {unit}.")
    try:
        number = float(angle)
    except OverflowError:  # a whole number of more than 308 digits
        number = math.inf
    if not math.isfinite(number):
        raise WrongUsage(Reason.BAD_VALUE, f"{what} is {number:g}: give a finite number of {unit}.")
    if not codec.fits(number):
        raise WrongUsage(Reason.BAD_VALUE, f"{what} is {number:g}: no message holds a number that large.")
    return math.radians(number)


def switch(what: str, on: bool) -> bool:  # noqa: FBT001
    """`on` itself; raises WrongUsage if it is no bool, for "no" would count as yes."""
    if isinstance(on, bool):
        return on
    raise WrongUsage(Reason.BAD_VALUE, f"{what} is {on!r}: give True or False.")
