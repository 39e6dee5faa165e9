"""What a motion of both robots depends on: their states, and the lead, which holds the hardware back."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Sequence
from typing import NamedTuple

from beatrix_zenoh.client.degrees import ArmAngles
from beatrix_zenoh.client.robot_base import RobotBase
from beatrix_zenoh.client.stopping import StopEvents
from beatrix_zenoh.contract import refusals
from beatrix_zenoh.contract._generated.messages import Fault, Reason, Status
from beatrix_zenoh.contract.errors import Interrupted, NoAnswer, naming
from beatrix_zenoh.contract.names import TEACHER

POLL_S = 0.02
LATE_S = 1.5
"""A motion that is overdue by more than this (s) is not sent to the hardware: its program was suspended."""


class PlanPosition(NamedTuple):
    """Commanded arm angles of a robot (deg), number of its calibrations, and time (s, the source's monotonic clock)."""

    arms: ArmAngles
    calibrations: int
    t: float


def plan_position(robot: RobotBase) -> PlanPosition:
    """Query the position of a robot for a plan; raises NoAnswer as `Robot.positions` does."""
    reading = robot.positions()
    return PlanPosition(reading.commanded, robot.status().calibrations, reading.t)


def check_seat(robot: RobotBase, *, moves: bool) -> None:
    """Raise unless this seat may switch or, with `moves`, move a robot; the message begins with the robot's name.

    Raises:
        BeatrixError: as `may_move`, or as `Robot.status`.
    """
    with naming(str(robot)):
        may_move(robot.status(), robot.client.settings.who, moves=moves)


def may_move(status: Status, seat: str, *, moves: bool = True) -> None:
    """Raise unless a seat may switch or, with `moves`, move a robot with this status; freeze and pause are not checked.

    Raises:
        Refused: NOT_HOLDER, unless this seat is the teacher; with `moves` EMERGENCY, NOT_ENABLED or NOT_CALIBRATED.
        NoAnswer: BOARD_LOST or CONTRACT_MISMATCH.
    """
    if not status.board.connected:
        reason = Reason.CONTRACT_MISMATCH if status.fault is Fault.CONTRACT_MISMATCH else Reason.BOARD_LOST
        raise NoAnswer(reason, " ".join(status.warnings[:1]) or status.fault.text)
    if moves:
        refusals.check_ready(
            emergency=status.fault is Fault.EMERGENCY, enabled=status.enabled, calibrated=status.calibrated
        )
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
        self._check_both: Callable[[], None] = lambda: None
        self._stops: Sequence[StopEvents] = ()

    def claim(self) -> bool:
        """Return True for the first call, whose caller alone decides about the hardware; False for each further one."""
        return self._claimed.acquire(blocking=False)

    @property
    def countdown_s(self) -> float:
        """Seconds until the motion is sent to the hardware; 0 if it was sent or will not be sent."""
        if self._claimed.locked():
            return 0.0
        return self.lead_s if self._due_s is None else max(0.0, self._due_s - time.monotonic())

    def watch(self, check_both: Callable[[], None], stops: Sequence[StopEvents]) -> None:
        """Have both robots checked during the lead; an exception of a check ends the motion.

        Args:
            check_both: called just before the motion is sent to the hardware.
            stops: checked continuously, and closed at the end.
        """
        self._check_both, self._stops = check_both, stops

    def begin(self) -> None:
        """Start the lead: the simulation has begun."""
        self._due_s = time.monotonic() + self.lead_s

    def send_now(self) -> bool:
        """End the lead now; return False if it has not begun, or the motion was sent or held before."""
        if self._due_s is None or self._claimed.locked():
            return False
        self._due_s = min(self._due_s, time.monotonic())
        return True

    def wait(self) -> None:
        """Wait one step, at most until the motion is due."""
        time.sleep(max(0.001, min(self._left_s(), POLL_S)))

    def due(self) -> bool:
        """Return whether the motion is now to be sent to the hardware, after all checks.

        Raises:
            Interrupted: STOP was pressed, or this program was suspended for too long.
            BeatrixError: a check of `watch` failed.
        """
        for stops in self._stops:
            stops.check()
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
        """End the subscriptions."""
        for stops in self._stops:
            stops.close()
        self._check_both = lambda: None  # it holds the plan, which holds the motion before it
