"""The lease of one robot, and the seats that wait for it. No I/O; callers pass the time.

A seat holds the robot in one of two ways:

* by moving it: from the start of a motion until LINGER_S after its end;
* by taking it: until the seat gives the robot back, its session ends, the teacher takes the robot or ends the lease, or
  the seat is idle for IDLE_S while another seat waits. Each lease that is taken has a number of its own, the fencing
  token: a request that names the number of an earlier lease is refused.

Either way its turn is over TURN_S after another seat has begun to wait, or after its turn began if that is later, and
a taken robot also after the time that the seat has asked for. The teacher's turn has no end (decision 67).
"""

from __future__ import annotations

import math
from typing import NamedTuple

from beatrix_zenoh.contract import refusals
from beatrix_zenoh.contract.names import TEACHER
from beatrix_zenoh.contract.refusals import LINGER_S
from beatrix_zenoh.node.callers import NO_CALLER, Caller
from beatrix_zenoh.node.pauses import QUIET_S

IDLE_S = 60.0
"""Time after which a taken robot with an idle holder goes to a waiting seat."""
TURN_S = 120.0
"""Default length of a turn while another seat waits: a program of a lesson needs at most 90 s."""
SHORTEST_TURN_S, LONGEST_TURN_S = 5.0, 3600.0
WAITING_MAX = 64
"""Largest number of waiting seats."""


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


class Terms(NamedTuple):
    """What a seat has asked for with its lease."""

    longest_s: float = 0.0
    """time after which the lease ends, even if no seat waits; 0: none"""
    speed: float = 0.0
    """top speed of every arm in motions of the seat (rad/s); 0: none"""


NO_TERMS = Terms()


class Waiting(NamedTuple):
    """A waiting seat."""

    caller: Caller
    terms: Terms


class AskedTerms:
    """The terms of a seat, from the grant of its lease until the session that has asked for them gives it back or ends.

    They outlive the lease: another program of the seat may give the robot back, and must not be faster then. The lease
    of another seat replaces them.
    """

    def __init__(self) -> None:
        self.now = NO_TERMS
        self._asker = NO_CALLER

    def grant(self, caller: Caller, terms: Terms) -> None:
        """Record the terms of a lease; if another session of the seat has asked for some, the stricter of both."""
        if caller == self._asker or caller.seat != self._asker.seat or self.now == NO_TERMS:
            self._asker, self.now = caller, terms
            return
        pairs = zip(self.now, terms, strict=True)
        self.now = Terms(*(min(filter(None, pair), default=0.0) for pair in pairs))

    def end(self, caller: Caller) -> None:
        """End the terms if this session has asked for them."""
        if caller == self._asker:
            self._asker, self.now = NO_CALLER, NO_TERMS

    def speed(self, seat: str) -> float:
        """Return the top speed (rad/s) that a seat has asked for with its lease; 0: none."""
        return self.now.speed if seat and seat == self._asker.seat else 0.0


class Turn:
    """The turn of a seat: since when it lasts, and since when another seat waits for its end."""

    def __init__(self) -> None:
        self.limit_s = TURN_S
        """Length of a turn while another seat waits (s)."""
        self.contested_s = math.inf
        """Time since which a seat waits (s)."""
        self.began_s = 0.0
        self.seat = ""
        """Seat whose turn it is, by its motion or because it has taken the robot; empty: none."""
        self.over = ""
        """Seat whose turn has ended by its time; the node resets this when it has stopped the seat's motion."""

    def begin(self, seat: str, now_s: float) -> None:
        """Record whose turn it is; another seat begins a new one."""
        if seat != self.seat:
            self.seat, self.began_s = seat, now_s

    def end_s(self, *, waiting: bool, longest_s: float) -> float:
        """Return the time at which the turn ends (s), infinity if it does not; `longest_s`: its own limit, 0: none."""
        if self.seat in ("", TEACHER):
            return math.inf
        contested_s = max(self.began_s, self.contested_s) + self.limit_s if waiting else math.inf
        return min(contested_s, self.began_s + longest_s if longest_s else math.inf)


class RobotLease:
    """The lease of one robot, by a motion or because a seat has taken the robot, and the queue of waiting seats."""

    def __init__(self) -> None:
        self.motion, self.turn = MotionLease(), Turn()
        self._taker = NO_CALLER
        self.terms = AskedTerms()
        self._used_s = 0.0
        """Time of the last request of the taker (s)."""
        self._number = 0
        self.ended_by_teacher = 0
        """Number of the last lease that the teacher has ended; 0: none."""
        self._waiting: dict[str, Waiting] = {}

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

    def left_s(self, now_s: float) -> float:
        """Return the time until the turn of the holder ends (s); infinity: no end is set."""
        self._hand_over(now_s)
        return max(0.0, self._turn_end_s() - now_s)

    def _turn_end_s(self) -> float:
        longest_s = self.terms.now.longest_s if self._taker.seat else 0.0
        return self.turn.end_s(waiting=bool(self._waiting), longest_s=longest_s)

    def check(self, caller: Caller, number: int, now_s: float) -> None:
        """Check that no other seat holds the robot, and that the lease `number` of a request (0: none) has not ended.

        The teacher is accepted even while another seat holds the robot. A request of the seat that has taken the robot
        restarts its idle time.

        Raises:
            Refused: NOT_HOLDER.
        """
        holder = self.holder(now_s)
        if number and (number != self._number or not self._taker.seat):
            raise refusals.lease_ended(number, holder, by_teacher=number == self.ended_by_teacher)
        if holder not in ("", caller.seat) and caller.seat != TEACHER:
            if self._taker.seat:
                raise refusals.taken_by(holder)
            raise refusals.driven_by(holder, self.motion.wait_s(now_s))
        if caller.seat == self._taker.seat:
            self._used_s = now_s

    def take(self, caller: Caller, now_s: float, terms: Terms = NO_TERMS) -> int:
        """Grant the robot to a caller that has passed `check`; return the number of its lease.

        A session that takes the robot again keeps its lease; another session of the same seat gets a new one, with the
        stricter of both terms. Neither begins a new turn.
        """
        if caller.seat == TEACHER and self._taker.seat not in ("", TEACHER):
            self.ended_by_teacher = self._number
        if caller != self._taker:
            self._grant(Waiting(caller, terms), now_s)
        self._used_s = now_s
        return self._number

    def wait(self, caller: Caller, now_s: float, terms: Terms = NO_TERMS) -> None:
        """Append the caller to the queue, or replace the waiting caller of its seat.

        Raises:
            Refused: BUSY, the queue is full.
        """
        if caller.seat not in self._waiting and len(self._waiting) >= WAITING_MAX:
            raise refusals.queue_full(WAITING_MAX)
        if not self._waiting:
            self.turn.contested_s = now_s
        self._waiting[caller.seat] = Waiting(caller, terms)

    def give_back(self, caller: Caller) -> bool:
        """End the lease of a seat (teacher: any lease) and its place in the queue; return whether either existed."""
        self.terms.end(caller)
        seat = caller.seat
        return self.end(self._taker.seat if seat == TEACHER and self._taker.seat else seat)

    def end(self, seat: str) -> bool:
        """End the lease of a seat and its place in the queue; return whether either existed."""
        waited = self._waiting.pop(seat, None) is not None
        held = bool(seat) and seat == self._taker.seat
        if held:
            self._taker = NO_CALLER
        return held or waited

    def router_changed(self, now_s: float, *, connected: bool) -> None:
        """Stop idle time and turn of the holder while no seat can send requests; restart both when the router is back."""
        self._used_s = self.turn.began_s = now_s if connected else math.inf

    def session_ended(self, caller: Caller) -> None:
        """End the lease of a session that has ended, and its place in the queue."""
        self.terms.end(caller)
        if self._taker == caller:
            self._taker = NO_CALLER
        waiting = self._waiting.get(caller.seat)
        if waiting is not None and waiting.caller == caller:
            del self._waiting[caller.seat]

    def _hand_over(self, now_s: float) -> None:
        """End a turn whose time is over; grant a free robot, or one with an idle holder, to the first waiting seat."""
        holder = self._taker.seat or self.motion.holder(now_s)
        self.turn.begin(holder, now_s)
        if now_s >= self._turn_end_s():
            self.turn.over, self.turn.seat, self._taker = holder, "", NO_CALLER
            if self.motion.holder(now_s) == holder:
                self.motion.release(now_s)
        if not self._waiting:
            return
        idle = now_s - self._used_s >= IDLE_S and not self.motion.moves(self._taker.seat)
        if self._taker.seat and not idle:
            return
        first = next(iter(self._waiting.values()))
        if self.motion.holder(now_s) in ("", first.caller.seat, self._taker.seat):
            self._grant(first, now_s)

    def _grant(self, to: Waiting, now_s: float) -> None:
        self._waiting.pop(to.caller.seat, None)
        self.turn.begin(to.caller.seat, now_s)
        self.terms.grant(to.caller, to.terms)
        self._taker, self._used_s = to.caller, now_s
        self._number += 1
