"""The SDK: one robot, simulated or real. Synchronous; angles in degrees."""

from __future__ import annotations

import math

from msgspec import structs

from beatrix_zenoh.client.degrees import (
    DAY_S,
    Kinematics,
    Preview,
    bearing,
    checked_place,
    checked_seconds,
    preview_of,
    true_or_false,
)
from beatrix_zenoh.client.lease import Lease
from beatrix_zenoh.client.motion import MARGIN_S, Motion, Movable
from beatrix_zenoh.client.request import Request, accepted, ask
from beatrix_zenoh.client.robot_base import RobotWithRoom
from beatrix_zenoh.client.stopping import SentStop, publish_stop
from beatrix_zenoh.contract import refusals
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import (
    Command,
    CommandQuery,
    CommandReply,
    Fault,
    FollowQuery,
    MotionQuery,
    MotionReply,
    PoseQuery,
    PreviewReply,
    Source,
)
from beatrix_zenoh.contract._generated.robot import ALLOWED
from beatrix_zenoh.contract.errors import BeatrixError, Refused, wrong_usage

LONGEST_WAY_DEG = 720.0
"""Upper bound of one arm's travel: the head turns 180 deg to each side, and arms stay between their neighbours."""
PREVIEW_S = 10.0
"""Time limit (s) of a preview."""
SLOWEST_DEFAULT = math.radians(ALLOWED["limits"]["speed_default"].low)


class ShownReply(CommandReply, frozen=True, kw_only=True):
    """A reply that a notebook or Python's prompt shows as its sentence, with angles in degrees."""

    def __repr__(self) -> str:
        return self.message


class Robot(RobotWithRoom, Movable[Motion, Preview]):
    """One robot: `Robot("bea1", side="sim")`. Use it in a `with` block, or close it.

    Args:
        name: the robot; default BEATRIX_ROBOT, beatrix.toml, the account's robot, then the only robot online. The
            first query or motion shows whether a robot of this name is online.
        side: `sim` or `hw`.
        connect: the router's endpoint; default BEATRIX_CONNECT, beatrix.toml, the account, then tcp/127.0.0.1:7447.
        who: your seat; default BEATRIX_WHO, beatrix.toml, the account's seat, then the user's name.
        timeout_s: longest wait for an answer (s).
        client: a session to share; the caller opens and closes it.

    Raises:
        WrongUsage: an argument or a setting is invalid.
        NoAnswer: NO_ROUTER or ACCOUNT_REFUSED; or no robot is named, and none is online.
        Refused: no robot is named, and several are online.
    """

    # -- commands -------------------------------------------------------------------------------

    def enable(self) -> None:
        """Switch the motors on."""
        self.command(Command.ENABLE)

    def disable(self) -> None:
        """Switch the motors off; the calibration is lost."""
        self.command(Command.ENABLE, value=False)

    def calibrate(self) -> None:
        """Declare the present position home: set the head upright first."""
        self.command(Command.CALIBRATE)

    def make_ready(self) -> None:
        """Enable and calibrate the robot as far as needed: set the head upright first.

        Raises:
            Refused: EMERGENCY if the emergency stop is latched (check the robot, then `reset`), or the robot's reason.
        """
        status = self.status()
        if status.fault is Fault.EMERGENCY:
            raise refusals.emergency_latched()
        if not status.enabled:
            self.enable()
        if not (status.enabled and status.calibrated):
            self.calibrate()

    def reset(self) -> None:
        """Clear the latch of the emergency stop; the motors stay off."""
        self.command(Command.RESET)

    def home(self) -> None:
        """Move all arms home and wait; raises Refused, NoAnswer or Interrupted as `look`."""
        self.move(0, 0, 0)

    def stop(self) -> CommandReply:
        """Stop the robot, even if another seat moves it; return when the arms rest."""
        answer = SentStop(self.client, self.place, self.timeout_s).answer()
        if isinstance(answer, BeatrixError):
            raise answer
        return ShownReply(**structs.asdict(answer))

    def emergency_stop(self) -> CommandReply:
        """Switch the motors off at once; the head falls. Then set it upright, and call `reset` and `make_ready`."""
        return self.command(Command.EMERGENCY_STOP)

    def command(
        self, command: Command, *, value: bool = True, timeout_s: float | None = None
    ) -> CommandReply:
        """Send any command; raises Refused with the robot's reason, or NoAnswer after `timeout_s` (s)."""
        key = keys.command(self.name, self.side, self.client.settings.who)
        query = CommandQuery(
            command=command.value, value=true_or_false("value", value), source=self.client.source
        )
        timeout_s = self.timeout_s if timeout_s is None else checked_seconds("timeout_s", timeout_s)
        return accepted(ask(self.client, self.place, key, query, ShownReply, timeout_s))

    def lease(self, wait_s: float = 0.0) -> Lease:
        """Take the robot: only this seat and the teacher may move it until the lease is closed or this program ends.

        `wait_s` is the longest wait (s) for a robot that another seat holds.

        Raises:
            Refused: NOT_HOLDER if another seat holds the robot, or the robot's reason, such as FROZEN.
        """
        return Lease(self, checked_seconds("wait_s", wait_s, zero=True))

    def follow(self, on: bool = True) -> CommandReply:  # noqa: FBT001, FBT002 - `follow(False)` reads well
        """Let the simulation of this name follow the hardware, or end this.

        While it follows, its own motions and previews are refused; see `status().following`. STOP of the simulation
        also ends it. Raises Refused with the simulation's reason, or NoAnswer.
        """
        query = FollowQuery(follow=true_or_false("on", on), source=self.client.source)
        key = keys.follow(self.name, self.client.settings.who)
        return accepted(ask(self.client, (self.name, "sim"), key, query, CommandReply, self.timeout_s))

    def kinematics(self) -> Kinematics:
        """Query geometry and limits of the robot, and return its kinematics in degrees; raises NoAnswer."""
        return Kinematics(self.info())

    # -- motions --------------------------------------------------------------------------------

    def look_at(
        self, x: float, y: float, z: float, *, speed: float | None = None, wait: bool = True
    ) -> Motion:
        """Turn the head so that the eyes look at a place: x forward, y left, z up of the neck's centre (m).

        The point between the eyes looks there, with roll 0. `speed` and `wait` are those of `look`, and so are the
        errors; raises WrongUsage (BAD_VALUE), too, for a place within the head.
        """
        yaw, pitch = bearing(*checked_place(x, y, z))
        return self.look(yaw, pitch, speed=speed, wait=wait)

    def preview_query(self, query: MotionQuery | PoseQuery) -> Preview:
        """Preview a motion (rad, rad/s); raises the errors of `preview`."""
        if self.side != "sim":
            text = (
                f"Hardware has no preview: use Robot({self.name!r}).preview(...), which asks its simulation."
            )
            raise wrong_usage(text)
        return preview_of(self.try_out(query))

    def try_out(self, query: MotionQuery | PoseQuery) -> PreviewReply:
        """Try a motion (rad, rad/s) on a copy of the simulation of this name; raises Refused or NoAnswer."""
        key = keys.preview(self.name, self.client.settings.who)
        return accepted(ask(self.client, (self.name, "sim"), key, query, PreviewReply, PREVIEW_S))

    def _carry_out(self, query: MotionQuery | PoseQuery, *, wait: bool) -> Motion:
        motion = self.begin(query)
        if wait:
            motion.wait()
        return motion

    def begin(self, query: MotionQuery | PoseQuery) -> Motion:
        """Send a motion and return when the robot has accepted it; raises Refused or NoAnswer."""
        if self.lease_number and not query.lease:
            query = structs.replace(query, lease=self.lease_number)
        if query.source is Source.ZENOH:
            query = structs.replace(query, source=self.client.source)
        key_of = keys.motion if isinstance(query, MotionQuery) else keys.pose
        key = key_of(self.name, self.side, self.client.settings.who)
        lasts_s = max(self.timeout_s, self._longest_s(query) + MARGIN_S)
        request = Request(self.client, self.place, key, query, lasts_s)
        try:
            reply = accepted(request.next(MotionReply, self.timeout_s))
        except Refused:
            request.close()
            raise
        except BaseException:
            request.if_accepted(lambda: publish_stop(self.client, self.place))
            raise
        return Motion(str(self), request, reply, self.stop, self.client.dispatcher)

    def _longest_s(self, query: MotionQuery | PoseQuery) -> float:
        """Return an upper bound of a motion's time (s), because Zenoh keeps memory for a query until its timeout."""
        if query.speed is None:
            slowest = SLOWEST_DEFAULT  # no robot file and no teacher allows a slower one
        elif isinstance(query.speed, float):
            slowest = query.speed
        else:
            slowest = min(query.speed.x, query.speed.y, query.speed.z)
        return min(DAY_S, math.radians(LONGEST_WAY_DEG) / slowest) if slowest > 0 else 0.0
