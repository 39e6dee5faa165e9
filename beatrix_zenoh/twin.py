"""The SDK: both robots of one name. A motion is previewed, shown, and only then committed to both."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, NamedTuple, Self

from beatrix_zenoh import readiness
from beatrix_zenoh._generated import keys
from beatrix_zenoh._generated.messages import (
    FAULT_TEXT,
    Fault,
    Info,
    MotionQuery,
    MotionReply,
    PoseQuery,
    PreviewReply,
    Reason,
    Status,
)
from beatrix_zenoh.client import Client
from beatrix_zenoh.errors import BeatrixError, Interrupted, NoAnswer, Refused, naming
from beatrix_zenoh.lease import LINGER_S, TEACHER, driven
from beatrix_zenoh.readings import ArmAngles, Path, arm_angles, head_angles
from beatrix_zenoh.robot import MARGIN_S, SILENT, Motion, Robot, motion_query, pose_query, stop_together
from beatrix_zenoh.settings import resolve

if TYPE_CHECKING:
    from matplotlib.figure import Figure

PREVIEW_S = 10.0
TURN_S = 0.02
SAME_DEG = 0.1
"""A microstep is 0.086 deg."""


UNLIKE = (
    " Simulation and hardware run with different values: the hardware may move otherwise, or refuse. "
    "Start both with the same --robot-file."
)


class Stand(NamedTuple):
    """Where a robot stands, and from which home that is counted."""

    arms: ArmAngles
    calibrations: int


Start = tuple[Stand, Stand | None]
"""Simulation and hardware; None if there was no hardware to ask."""


class Plan:
    """A motion that was tried on the copy and has not moved anything yet."""

    def __init__(
        self,
        twin: Twin,
        road: str,
        query: MotionQuery | PoseQuery,
        preview: PreviewReply,
        start: Start,
        *,
        alike: bool,
    ) -> None:
        self._twin, self._road, self._query = twin, road, query
        self._start = start
        self.duration = preview.duration
        """Seconds until the arms rest."""
        self.verdict = preview.message
        """What the simulation thinks of it, and whether that holds for the hardware."""
        if (elsewhere := between(start)) > SAME_DEG:
            self.verdict += f" The hardware stands {elsewhere:.1f} deg elsewhere: its way there is another, and not previewed."
        if not alike:
            self.verdict += UNLIKE
        self.path = Path(
            preview.t,
            [arm_angles(arms) for arms in preview.arms],
            [head_angles(head) for head in preview.head],
        )
        self._settled = ""

    def commit(self) -> None:
        """Carry it out: the simulation first, then the hardware; returns when both are there.

        If one of them refuses or is stopped, the other is stopped too.

        Raises:
            Refused: one robot said no or may not move now, or one of them has moved since the preview.
            NoAnswer: one is not on line, or has lost its board.
            Interrupted: one robot ended elsewhere.
        """
        self._check_open()
        self._twin.check_ready()
        self._settled = "committed"
        now = stand(self._twin.sim), stand(self._twin.hw)
        for robot, was, is_ in zip((self._twin.sim, self._twin.hw), self._start, now, strict=True):
            if was is None or was.calibrations != is_.calibrations or apart(was.arms, is_.arms) > SAME_DEG:
                what = "was not on line at" if was is None else "has moved, or got another home, since"
                raise Refused(
                    Reason.REPLACED, f"{robot} {what} this preview, so its way is another: preview again."
                )
        self._twin.carry_out(self._road, self._query)

    def __repr__(self) -> str:
        return f"<plan for {self._twin.name}: {self._settled or self.verdict}>"

    def abort(self) -> None:
        """Drop it; nothing moves."""
        self._check_open()
        self._settled = "aborted"

    def _check_open(self) -> None:
        if self._settled:
            raise Refused(Reason.BAD_VALUE, f"This plan was {self._settled} already: preview a new one.")

    def plot(self) -> Figure:
        """A figure of the path; needs the extra `plot`."""
        from beatrix_zenoh import plot  # noqa: PLC0415  # matplotlib only where somebody plots

        return plot.path_figure(self.path)


class Twin:
    """Simulation and hardware of one name; arguments as of `Robot`."""

    def __init__(
        self,
        name: str | None = None,
        *,
        connect: str | None = None,
        who: str | None = None,
        timeout_s: float = 2.0,
    ) -> None:
        self.client = Client(resolve(name, connect, who))
        self.name = self.client.settings.robot
        self.sim = Robot(twin="sim", timeout_s=timeout_s, client=self.client)
        self.hw = Robot(twin="hw", timeout_s=timeout_s, client=self.client)

    def enable(self) -> None:
        """Motors of both on; of neither if one cannot be reached, or is driven by somebody else."""
        self._switch(Robot.enable)

    def disable(self) -> None:
        """Motors of both off."""
        each((self.sim, self.hw), Robot.disable)

    def calibrate(self) -> None:
        """Declare the present positions home; of neither if one cannot be reached, or is driven by somebody else."""
        self._switch(Robot.calibrate)

    def home(self) -> None:
        """Both home, previewed like any motion."""
        self.preview_arms(0, 0, 0).commit()

    def _switch(self, do: Callable[[Robot], None]) -> None:
        check_reachable((self.sim, self.hw), self.client.settings.who)
        each((self.sim, self.hw), do)

    def stop(self) -> None:
        """Stop both at once; raises as `Robot.stop`, after both have been asked."""
        for _, reply in list(stop_together((self.hw, self.sim))):
            if isinstance(reply, BeatrixError):
                raise reply

    def preview(
        self,
        yaw: float = 0.0,
        pitch: float = 0.0,
        roll: float = 0.0,
        *,
        relative: bool = False,
        speed: float | None = None,
    ) -> Plan:
        """Try a head motion (deg, deg/s as `Robot.look`) on a copy of the simulation.

        Raises:
            Refused: it would be refused, and why.
        """
        return self._preview("pose", pose_query(yaw, pitch, roll, relative=relative, speed=speed))

    def preview_arms(
        self,
        short: float,
        middle: float,
        long: float,
        *,
        relative: bool = False,
        speed: float | None = None,
    ) -> Plan:
        """Try an arm motion (deg, deg/s as `Robot.move`); raises as `preview`."""
        return self._preview("motion", motion_query(short, middle, long, relative=relative, speed=speed))

    def _preview(self, road: str, query: MotionQuery | PoseQuery) -> Plan:
        key = keys.preview(self.name, self.client.settings.who)
        start = self._start()
        if not query.absolute and (distance := between(start)) > SAME_DEG:
            raise Refused(
                Reason.BAD_VALUE,
                f"The robots stand {distance:.1f} deg apart, so a relative motion would leave them apart: bring both to "
                "one place first, with home or without relative.",
            )
        reply = self.client.ask(self.name, "sim", key, query, PreviewReply, PREVIEW_S)
        if not reply.result:
            raise Refused(reply.reason, f"{self.sim}: {reply.message}")
        plan = Plan(self, road, query, reply, start, alike=start[1] is None or self._alike())
        if start[1] is not None:
            plan.verdict += self._hindrance()
        return plan

    def _hindrance(self) -> str:
        """What keeps the hardware from moving just now, for people; empty if nothing does."""
        try:
            may_move(self.hw.status(), self.client.settings.who)
        except BeatrixError as error:
            return f" But the hardware may not move now: {error.message}"
        return ""

    def _alike(self) -> bool:
        with contextlib.suppress(NoAnswer):  # as in _start
            return not unlike(self.sim.info(), self.hw.info())
        return True

    def _start(self) -> Start:
        hardware: Stand | None = None
        # A preview needs the simulation only; commit will say who is missing.
        with contextlib.suppress(NoAnswer):
            hardware = stand(self.hw)
        return stand(self.sim), hardware

    def check_ready(self) -> None:
        """Raise unless both may move now: better than to set one off and stop it again.

        Raises:
            Refused: motors off, home unknown, or somebody else drives.
            NoAnswer: one is not on line, or has lost its board.
        """
        each((self.sim, self.hw), lambda robot: may_move(robot.status(), self.client.settings.who))

    def carry_out(self, road: str, query: MotionQuery | PoseQuery) -> None:
        """Send a motion to the simulation, then to the hardware; raises as `Plan.commit`."""
        begun: list[tuple[Robot, Motion]] = []
        try:
            for robot in (self.sim, self.hw):
                with naming(str(robot)):
                    begun.append((robot, robot.begin(road, query)))
            self._wait(begun)
        except BaseException as error:
            # What one robot does not do, the other must not finish; but who was replaced has nothing to stop.
            if isinstance(error, Interrupted) and error.reason is Reason.REPLACED:
                raise
            moving = [robot for robot, motion in reversed(begun) if runs(motion)]
            rests = [f"{robot}: {reply.message}" for robot, reply in stop_together(moving)]
            if isinstance(error, KeyboardInterrupt):
                raise KeyboardInterrupt("\n".join(rests)) from error
            if isinstance(error, BeatrixError) and rests:
                raise type(error)(error.reason, "\n".join([error.message, *rests])) from error
            raise

    @staticmethod
    def _wait(motions: list[tuple[Robot, Motion]]) -> None:
        deadline = time.monotonic() + max(motion.duration for _, motion in motions) + MARGIN_S
        while time.monotonic() < deadline:
            ends: list[MotionReply | None] = [motion.poll(TURN_S) for _, motion in motions]
            for (robot, _), end in zip(motions, ends, strict=True):
                if end is not None and not end.result:
                    raise Interrupted(end.reason, f"{robot}: {end.message}")
            if all(end is not None for end in ends):
                return
        silent = " and ".join(str(robot) for robot, motion in motions if motion.poll(0) is None)
        raise NoAnswer(Reason.TIMED_OUT, SILENT.format(silent))

    def close(self) -> None:
        """Leave the bus; motions under way are stopped by the robots."""
        self.client.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exc: object) -> None:
        self.close()


def runs(motion: Motion) -> bool:
    """It has not said that it has ended; a robot that has gone may still run."""
    try:
        return motion.poll(0) is None
    except NoAnswer:
        return True


def may_move(status: Status, who: str) -> None:
    """Raise unless a seat may move a robot of this status, as the robot itself would."""
    check_heard(status)
    readiness.check(
        emergency=status.fault is Fault.EMERGENCY, enabled=status.enabled, calibrated=status.calibrated
    )
    check_free(status, who)


def check_reachable(robots: Iterable[Robot], who: str) -> None:
    """Raise unless a seat may switch all of them: better than to switch one and not the other.

    Raises:
        Refused: somebody else drives.
        NoAnswer: one is not on line, or has lost its board.
    """

    def check(robot: Robot) -> None:
        status = robot.status()
        check_heard(status)
        check_free(status, who)

    each(robots, check)


def each(robots: Iterable[Robot], do: Callable[[Robot], None]) -> None:
    """One after the other; what one of them refuses begins with its name."""
    for robot in robots:
        with naming(str(robot)):
            do(robot)


def check_heard(status: Status) -> None:
    """Raise NoAnswer unless the robot hears its board."""
    if not status.board.connected:
        reason = Reason.CONTRACT_MISMATCH if status.fault is Fault.CONTRACT_MISMATCH else Reason.BOARD_LOST
        raise NoAnswer(reason, " ".join(status.warnings[:1]) or FAULT_TEXT[status.fault])


def check_free(status: Status, who: str) -> None:
    """Raise Refused if somebody else drives."""
    if status.holder not in ("", who) and who != TEACHER:
        raise driven(status.holder, f"until {LINGER_S:.0f} s after its motion has ended")


def stand(robot: Robot) -> Stand:
    """Asked of the robot now."""
    return Stand(robot.positions().commanded, robot.status().calibrations)


def unlike(one: Info, other: Info) -> bool:
    """They have different robot values, as far as both say."""
    return None not in (one.fingerprint, other.fingerprint) and one.fingerprint != other.fingerprint


def between(start: Start) -> float:
    """How far the robots stand from each other, deg; 0 without hardware."""
    simulation, hardware = start
    return 0.0 if hardware is None else apart(simulation.arms, hardware.arms)


def apart(one: ArmAngles, other: ArmAngles) -> float:
    """Largest difference of one arm, deg."""
    return max(abs(a - b) for a, b in zip(one, other, strict=True))
