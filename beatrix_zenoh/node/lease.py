"""The lease of one robot: its holder and the waiting seats. No I/O; callers pass the time.

A seat holds the robot in one of two ways:

* by moving it: from the start of a motion until LINGER_S after its end;
* by taking it: until the seat gives the robot back, its session ends, the teacher takes the robot or ends the lease, or
  the seat is idle for IDLE_S while another seat waits. Each lease that is taken has a number of its own, the fencing
  token: a request that names the number of an earlier lease is refused.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from beatrix_zenoh.contract import refusals
from beatrix_zenoh.contract.names import TEACHER
from beatrix_zenoh.contract.refusals import LINGER_S

QUIET_S = 3.0
"""Time without motion requests after which a stopped seat may move again. It is longer than a program usually pauses
between motions."""
IDLE_S = 60.0
"""Time after which a taken robot with an idle holder goes to a waiting seat."""
WAITING_MAX = 64
"""Largest number of waiting seats."""


class Caller(NamedTuple):
    """The sender of a request: its seat (empty: none given) and its Zenoh session (empty: unknown)."""

    seat: str
    session: str


NO_CALLER = Caller("", "")


class MotionLease:
    """The lease of a seat by its motion, until LINGER_S after the end of the motion."""

    def __init__(self) -> None:
        self._mover = NO_CALLER
        self._rested_s: float | None = None
        """time at which the last motion ended (monotonic clock, s); None while it runs"""
        self._released = False
        self._before: tuple[Caller, float | None, bool] = NO_CALLER, None, False

    def holder(self, now_s: float) -> str:
        """Return the seat that holds the robot by its motion; empty if there is none."""
        over = self._rested_s is not None and now_s - self._rested_s >= LINGER_S
        return "" if over or self._released else self._mover.seat

    def wait_s(self, now_s: float) -> float | None:
        """Return the time (s) until the robot is free; None while the motion runs."""
        return None if self._rested_s is None else LINGER_S - (now_s - self._rested_s)

    def begin(self, caller: Caller) -> None:
        """Record that a motion of the caller begins."""
        self._before = self._mover, self._rested_s, self._released
        self._mover, self._rested_s, self._released = caller, None, False

    def undo_begin(self) -> None:
        """Undo `begin`: restore the previous holder, because the motion did not begin."""
        self._mover, self._rested_s, self._released = self._before

    def rested(self, now_s: float) -> None:
        """Record that the motion has ended."""
        if self._mover.seat and self._rested_s is None:
            self._rested_s = now_s

    def release(self, now_s: float) -> None:
        """Free the robot at once; `driver` still returns the caller that moved it."""
        self.rested(now_s)
        self._released = True

    def runs(self, caller: Caller) -> bool:
        """Return whether a motion of this caller is running; False if its session is unknown."""
        return bool(caller.session) and self._mover == caller and self._rested_s is None

    def moves(self, seat: str) -> bool:
        """Return whether a motion of this seat is running."""
        return self._mover.seat == seat and self._rested_s is None

    def driver(self, now_s: float) -> Caller | None:
        """Return the caller whose motion is running or ended less than QUIET_S ago, also after `release`."""
        recent = self._rested_s is None or now_s - self._rested_s < QUIET_S
        return self._mover if self._mover.seat and recent else None


class Lease:
    """The lease of one robot, by a motion or because a seat has taken the robot, and the queue of waiting seats."""

    def __init__(self) -> None:
        self.motion = MotionLease()
        self._taker = NO_CALLER
        self._used_s = 0.0
        """Time of the last request of the taker (s)."""
        self._number = 0
        self._waiting: dict[str, Caller] = {}

    def holder(self, now_s: float) -> str:
        """Grant a free robot to the first waiting seat; return the seat that holds the robot, empty if none does."""
        self._hand_over(now_s)
        return self._taker.seat or self.motion.holder(now_s)

    def number(self, now_s: float) -> int:
        """Return the number of the present lease; 0 if the robot is not taken."""
        self._hand_over(now_s)
        return self._number if self._taker.seat else 0

    def waiting(self) -> list[str]:
        """Return the waiting seats, the next one first."""
        return list(self._waiting)

    def check(self, caller: Caller, number: int, now_s: float) -> None:
        """Check that no other seat holds the robot, and that the lease `number` of a request (0: none) has not ended.

        The teacher is accepted even while another seat holds the robot. A request of the seat that has taken the robot
        restarts its idle time.

        Raises:
            Refused: NOT_HOLDER.
        """
        holder = self.holder(now_s)
        if number and (number != self._number or not self._taker.seat):
            raise refusals.lease_ended(number, holder)
        if holder not in ("", caller.seat) and caller.seat != TEACHER:
            if self._taker.seat:
                raise refusals.taken_by(holder)
            raise refusals.driven_by(holder, self.motion.wait_s(now_s))
        if caller.seat == self._taker.seat:
            self._used_s = now_s

    def take(self, caller: Caller, now_s: float) -> int:
        """Grant the robot to a caller that has passed `check`; return the number of its lease.

        A session that takes the robot again keeps its lease; another session of the same seat gets a new one.
        """
        if caller != self._taker:
            self._grant(caller, now_s)
        self._used_s = now_s
        return self._number

    def wait(self, caller: Caller) -> None:
        """Append the caller to the queue, or replace the waiting caller of its seat.

        Raises:
            Refused: BUSY, the queue is full.
        """
        if caller.seat not in self._waiting and len(self._waiting) >= WAITING_MAX:
            raise refusals.queue_full(WAITING_MAX)
        self._waiting[caller.seat] = caller

    def give_back(self, seat: str) -> bool:
        """End the lease of a seat (teacher: any lease) and its place in the queue; return whether either existed."""
        return self.end(self._taker.seat if seat == TEACHER and self._taker.seat else seat)

    def end(self, seat: str) -> bool:
        """End the lease of a seat and its place in the queue; return whether either existed."""
        waited = self._waiting.pop(seat, None) is not None
        held = bool(seat) and seat == self._taker.seat
        if held:
            self._taker = NO_CALLER
        return held or waited

    def router_changed(self, now_s: float, *, connected: bool) -> None:
        """Stop the idle time of the holder while no seat can send requests; restart it when the router is back."""
        self._used_s = now_s if connected else math.inf

    def session_ended(self, caller: Caller) -> None:
        """End the lease of a session that has ended, and its place in the queue."""
        if self._taker == caller:
            self._taker = NO_CALLER
        if self._waiting.get(caller.seat) == caller:
            del self._waiting[caller.seat]

    def _hand_over(self, now_s: float) -> None:
        """Grant a free robot, or one with an idle holder, to the first waiting seat, if there is one."""
        if not self._waiting:
            return
        idle = now_s - self._used_s >= IDLE_S and not self.motion.moves(self._taker.seat)
        if self._taker.seat and not idle:
            return
        first = next(iter(self._waiting.values()))
        if self.motion.holder(now_s) in ("", first.seat, self._taker.seat):
            self._grant(first, now_s)

    def _grant(self, caller: Caller, now_s: float) -> None:
        self._waiting.pop(caller.seat, None)
        self._taker, self._used_s = caller, now_s
        self._number += 1
