"""What a motion of both robots depends on: their states, and the lead, which holds the hardware back.

The states are those of publications or, if these are too old, of a query.
"""

from __future__ import annotations

import contextlib
import queue
import threading
import time
from collections.abc import Callable
from typing import NamedTuple

from beatrix_zenoh.bus import ProcessBound
from beatrix_zenoh.client.degrees import ArmAngles, Reading, RobotInfo
from beatrix_zenoh.client.monitor import Monitor, Presence, RobotState
from beatrix_zenoh.client.robot_base import RobotBase
from beatrix_zenoh.client.session import Client
from beatrix_zenoh.client.stopping import StopEvents
from beatrix_zenoh.contract import refusals
from beatrix_zenoh.contract._generated.messages import Fault, Reason, Status
from beatrix_zenoh.contract.errors import Interrupted, NoAnswer, Refused, naming
from beatrix_zenoh.contract.names import SIDES, TEACHER

POLL_S = 0.02
LATE_S = 1.5
"""A motion that is overdue by more than this (s) is not sent to the hardware: its program was suspended."""
NEW_S = 0.1
"""Largest age (s) of published positions, which arrive every 20 ms."""
TICK_S = 0.03
"""A node publishes positions every 20 ms, and a changed status with them. Positions that arrive this long after the
reply to a request, and the status that arrived before them, therefore show the effect of the request."""
WAIT_S = 0.15
"""Longest wait (s) for a new state before the robot is queried."""
POLL_S = 0.004


class PlanPosition(NamedTuple):
    """Commanded arm angles of a robot (deg), number of its calibrations, and time (s, the source's monotonic clock)."""

    arms: ArmAngles
    calibrations: int
    t: float


class TwinState(ProcessBound):
    """Published state of both robots: one subscription to positions and one to status, opened at the first use.

    Several threads may use it.
    """

    def __init__(self, client: Client, name: str) -> None:
        self._client, self._name = client, name
        self._lock = threading.Lock()
        self._monitor: Monitor | None = None
        self._infos: dict[str, RobotInfo] = {}

    def status(self, robot: RobotBase) -> Status:
        """Return the status of a robot; raises NoAnswer as `Robot.status` does."""
        state = self._published(robot)
        return robot.status() if state is None or state.status is None else state.status

    def positions(self, robot: RobotBase) -> Reading:
        """Return the positions of a robot, in degrees; raises NoAnswer as `Robot.positions` does."""
        state = self._published(robot)
        reading = None if state is None else state.reading
        return robot.positions() if reading is None else reading

    def plan_position(self, robot: RobotBase) -> PlanPosition:
        """Return the position of a robot for a plan; raises NoAnswer as `Robot.positions` does."""
        state = self._published(robot)
        reading = None if state is None else state.reading
        if state is None or reading is None or state.status is None:
            return query_plan_position(robot)
        return PlanPosition(reading.commanded, state.status.calibrations, reading.t)

    def info(self, robot: RobotBase) -> RobotInfo:
        """Return the info of a robot, queried at the first call; raises NoAnswer as `Robot.info` does."""
        if robot.side not in self._infos:
            self._infos[robot.side] = robot.info()
        return self._infos[robot.side]

    def check_may_move(self, robot: RobotBase) -> None:
        """Raise unless this seat may move a robot; a query confirms a refusal.

        Raises:
            Refused, NoAnswer: as `may_move`; the message begins with the robot's name.
        """
        self._check(robot, may_move)

    def check_may_switch(self, robot: RobotBase) -> None:
        """Like `check_may_move`, but check whether this seat may switch a robot; raises the errors of `may_switch`."""
        self._check(robot, may_switch)

    def _check(self, robot: RobotBase, may: Callable[[Status, str], None]) -> None:
        seat = self._client.settings.who
        with naming(str(robot)):
            try:
                may(self.status(robot), seat)
            except (Refused, NoAnswer):
                may(robot.status(), seat)

    def check_present(self) -> None:
        """Raise NoAnswer if a robot has no liveliness token; sends no query."""
        monitor = self._monitor
        if monitor is None:
            return
        present = monitor.present()
        for side in SIDES:
            if (self._name, side) not in present:
                raise NoAnswer(
                    Reason.NODE_LOST,
                    f"{self._name} ({side}) is no longer online. Start it, make it ready, and preview again.",
                )

    def _published(self, robot: RobotBase) -> RobotState | None:
        """Return a published state that is newer than the last reply to a request; None if none comes within WAIT_S."""
        deadline_s = time.monotonic() + WAIT_S
        with self._lock:
            if self._monitor is None:
                self._monitor = Monitor(self._client, self._name)
            while True:
                state = self._monitor.robot(*robot.place)
                if state.presence in (Presence.ABSENT, Presence.LOST):
                    return None
                if state.status is not None and self._new(state, robot):
                    return state
                if time.monotonic() > deadline_s:
                    return None
                time.sleep(POLL_S)

    def _new(self, state: RobotState, robot: RobotBase) -> bool:
        age_s = state.positions_age_s
        if age_s is None or age_s > NEW_S:
            return False
        replied_s = self._client.replied_s.get(robot.place)
        return replied_s is None or time.monotonic() - age_s >= replied_s + TICK_S

    def close(self) -> None:
        """End the subscriptions."""
        with self._lock:
            if self._monitor is not None:
                self._monitor.close()


def query_plan_position(robot: RobotBase) -> PlanPosition:
    """Query the position of a robot for a plan; raises NoAnswer as `Robot.positions` does."""
    reading = robot.positions()
    return PlanPosition(reading.commanded, robot.status().calibrations, reading.t)


def may_move(status: Status, seat: str) -> None:
    """Raise unless a seat may move a robot with this status; a freeze and a pause are not checked.

    Raises:
        Refused: EMERGENCY, NOT_ENABLED, NOT_CALIBRATED or NOT_HOLDER.
        NoAnswer: BOARD_LOST or CONTRACT_MISMATCH.
    """
    check_board(status)
    refusals.check_ready(
        emergency=status.fault is Fault.EMERGENCY, enabled=status.enabled, calibrated=status.calibrated
    )
    check_holder(status, seat)


def may_switch(status: Status, seat: str) -> None:
    """Raise unless a seat may switch or calibrate a robot with this status.

    Raises:
        Refused: NOT_HOLDER.
        NoAnswer: BOARD_LOST or CONTRACT_MISMATCH.
    """
    check_board(status)
    check_holder(status, seat)


def check_board(status: Status) -> None:
    """Raise NoAnswer unless the robot is connected to its board."""
    if not status.board.connected:
        reason = Reason.CONTRACT_MISMATCH if status.fault is Fault.CONTRACT_MISMATCH else Reason.BOARD_LOST
        raise NoAnswer(reason, " ".join(status.warnings[:1]) or status.fault.text)


def check_holder(status: Status, seat: str) -> None:
    """Raise Refused if another seat holds the robot, unless this seat is the teacher."""
    if status.holder not in ("", seat) and seat != TEACHER:
        if status.lease:
            raise refusals.taken_by(status.holder)
        raise refusals.driven_by(status.holder, None if status.moving else refusals.LINGER_S)


class Lead:
    """Decides once whether a motion is sent to the hardware, and when; several threads and signal handlers may use it.

    The first caller of `claim` decides: the thread that sends the motion, or one that keeps it from being sent.
    """

    def __init__(self, lead_s: float) -> None:
        """Hold the hardware back for `lead_s` (s) from `begin` on."""
        self.lead_s = lead_s
        self.sent = False
        """Whether the motion was sent to the hardware."""
        self._due_s: float | None = None
        self._claimed = threading.Lock()
        """Acquired once and never released. It is a lock because acquiring it without waiting is atomic, also between
        a signal handler and the thread that it interrupts."""
        self._wakeups: queue.SimpleQueue[None] = queue.SimpleQueue()
        self._check_both: Callable[[], None] = lambda: None
        self._check_present: Callable[[], None] = lambda: None
        self._stops: tuple[StopEvents, ...] = ()

    def claim(self) -> bool:
        """Return True for the first call, whose caller alone decides about the hardware; False for each further one."""
        return self._claimed.acquire(blocking=False)

    @property
    def countdown_s(self) -> float:
        """Seconds until the motion is sent to the hardware; 0 if it was sent or will not be sent."""
        if self._claimed.locked():
            return 0.0
        return self.lead_s if self._due_s is None else max(0.0, self._due_s - time.monotonic())

    def watch(
        self, check_both: Callable[[], None], check_present: Callable[[], None], stops: tuple[StopEvents, ...]
    ) -> None:
        """Have both robots checked during the lead; an exception of a check ends the motion.

        Args:
            check_both: called just before the motion is sent to the hardware.
            check_present: called continuously, because a robot that was not online may have been replaced.
            stops: STOP events of both robots since the simulation and the hardware were at rest.
        """
        self._check_both, self._check_present, self._stops = check_both, check_present, stops

    def begin(self) -> None:
        """Start the lead: the simulation has begun."""
        self._due_s = time.monotonic() + self.lead_s

    def send_now(self) -> bool:
        """End the lead now; return False if it has not begun, or the motion was sent or held before."""
        if self._due_s is None or self._claimed.locked():
            return False
        self._due_s = min(self._due_s, time.monotonic())
        self.wake()
        return True

    def wake(self) -> None:
        """End the current `wait`, or else the next one."""
        self._wakeups.put(None)

    def wait(self) -> None:
        """Wait one step, at most until the motion is due."""
        with contextlib.suppress(queue.Empty):
            self._wakeups.get(timeout=max(0.001, min(self._left_s(), POLL_S)))

    def due(self) -> bool:
        """Return whether the motion is now to be sent to the hardware, after all checks.

        Raises:
            Interrupted: STOP was pressed, or this program was suspended for too long.
            BeatrixError: a check of `watch` failed.
        """
        for stops in self._stops:
            stops.check(" before the motion was sent to the hardware")
        self._check_present()
        left_s = self._left_s()
        if left_s < -LATE_S:
            raise Interrupted(
                Reason.STOPPED,
                f"This program was suspended for {-left_s:.1f} s: the motion is too late for the hardware and was not sent.",
            )
        if left_s > 0 or self._claimed.locked():
            return False
        self._check_both()
        return True

    def _left_s(self) -> float:
        return (self._due_s or 0.0) - time.monotonic()

    def close(self) -> None:
        """End the subscriptions to STOP events."""
        for stops in self._stops:
            stops.close()
