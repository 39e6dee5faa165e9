"""Access rules of one robot: lease, pause after STOP, emergency latch. No I/O; callers pass the time.

`Access.authorize` decides about every request to act on the robot, from clients and old programs, in this order:

1. STOP and EMERGENCY_STOP are allowed for every client; those of a muted seat end only its own motion.
2. Requests of a session that has ended are refused. Only the teacher may freeze the robot, limit its speed and mute
   seats. All requests of a muted seat are refused.
3. Under the emergency latch motions, ENABLE and CALIBRATE are refused. If the teacher has set it, only the teacher may
   RESET.
4. While the robot is frozen, motions, ENABLE, DISABLE, CALIBRATE and RESET of all seats except the teacher are refused.
5. RESET is allowed.
6. A request with the number of an ended lease is refused. While a seat holds the robot, requests of all other seats
   except the teacher are refused.
7. While a simulation follows the hardware, motions and CALIBRATE are refused.
8. After STOP a motion is refused until the arms rest, and a motion of the stopped seat until its pause is over.
"""

from __future__ import annotations

import threading
from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum, auto
from functools import wraps
from typing import Concatenate, ParamSpec, TypeVar

from beatrix_zenoh.contract import refusals
from beatrix_zenoh.contract._generated.messages import Detail, Reason
from beatrix_zenoh.contract.errors import Refused
from beatrix_zenoh.contract.names import OLD_PROGRAMS, TEACHER
from beatrix_zenoh.node.callers import NO_CALLER, Caller
from beatrix_zenoh.node.known_sessions import KnownSessions
from beatrix_zenoh.node.leases import RobotLease
from beatrix_zenoh.node.pauses import Pauses

TEXT_SESSION = "text-port"
"""Used as the session of programs of 2023, which have no Zenoh session."""

P = ParamSpec("P")
R = TypeVar("R")


class Operation(Enum):
    """The kinds of requests that the access rules distinguish."""

    MOVE = auto()
    ENABLE = auto()
    DISABLE = auto()
    CALIBRATE = auto()
    RESET = auto()
    LEASE = auto()
    FOLLOW = auto()
    """Let a simulation follow the hardware, or end this."""
    GOVERN = auto()
    """Freeze the robot, limit its speed, or mute a seat."""
    STOP = auto()
    EMERGENCY_STOP = auto()


ALWAYS = (Operation.STOP, Operation.EMERGENCY_STOP)
MOVING = (Operation.MOVE, Operation.FOLLOW, Operation.ENABLE, Operation.CALIBRATE)
"""Actions that are refused under the emergency latch."""
FROZEN = (*MOVING, Operation.DISABLE, Operation.RESET)
"""Actions that are refused while the robot is frozen; DISABLE too, because without motor power the head may sink."""


@dataclass
class Teacher:
    """What the teacher has decided about the robot."""

    frozen: bool = False
    """whether only the teacher may move the robot"""
    muted: frozenset[str] = frozenset()
    """seats that only watch"""
    latch: bool = False
    """whether the teacher has pressed EMERGENCY_STOP, so that only the teacher may clear the latch"""

    def check(self, action: Operation, seat: str, *, latched: bool) -> None:
        """Check mute, latch and freeze; raises Refused (MUTED, TEACHER_ONLY, EMERGENCY or FROZEN)."""
        others = seat != TEACHER
        if seat in self.muted:
            raise refusals.muted(seat)
        if action is Operation.RESET and self.latch and others:
            raise Refused(Reason.TEACHER_ONLY, detail=Detail(needs=["RESET"]))
        if action in MOVING and latched:
            raise refusals.emergency_latched(TEACHER if self.latch and others else "")
        if action in FROZEN and self.frozen and others:
            raise Refused(Reason.FROZEN)


@dataclass
class LastStop:
    """The last STOP or EMERGENCY_STOP."""

    presser: Caller = NO_CALLER
    """its seat or session may be unknown"""
    sent: bool = True
    """whether the board has acknowledged it, has refused it or has not answered"""
    resting: bool = True
    """whether a motion was authorised since the arms rest"""

    @property
    def seat(self) -> str:
        """The seat that has stopped the arms; empty: unknown, or a motion was authorised since then."""
        return "" if self.resting else self.presser.seat


def _locked(method: Callable[Concatenate[Access, P], R]) -> Callable[Concatenate[Access, P], R]:
    """Return `method`, wrapped so that it holds the lock of Access while it runs."""

    @wraps(method)
    def under_lock(self: Access, /, *args: P.args, **kwargs: P.kwargs) -> R:
        with self.lock:
            return method(self, *args, **kwargs)

    return under_lock


class Access:
    """Access state of one robot; thread-safe, but hold `lock` while using `lease`. All times are monotonic (s)."""

    def __init__(self) -> None:
        self.lock = threading.RLock()
        self.lease, self._pauses = RobotLease(), Pauses()
        self.last_stop = LastStop()
        self.begun = 0
        """Counts each motion when it is authorised, and again when it begins: while it stays equal, none can begin."""
        self._latched_s: float | None = None
        self.teacher = Teacher()
        self.following = False
        """Whether this simulation follows the hardware; STOP ends it."""
        self._sessions = KnownSessions()

    @_locked
    def authorize(
        self, action: Operation, caller: Caller, now_s: float, *, resting: bool = True, lease: int = 0
    ) -> None:
        """Raise Refused unless the caller may request the action now.

        `resting`: whether the arms rest; `lease`: number of the lease in the request, 0 if none. A motion request
        during a pause restarts the pause, even if the request is refused for another reason.

        Raises:
            Refused: CLIENT_LOST, TEACHER_ONLY, MUTED, EMERGENCY, FROZEN, NOT_HOLDER, FOLLOWING or STOPPED, in this
                order.
        """
        if action in ALWAYS:
            return
        began_s = self._sessions.heard(caller, now_s)
        pause = self._pauses.restart(caller, now_s, began_s) if action is Operation.MOVE else None
        if self._sessions.has_ended(caller):
            raise Refused(Reason.CLIENT_LOST)
        if action is Operation.GOVERN:
            if caller.seat != TEACHER:
                raise Refused(Reason.TEACHER_ONLY, detail=Detail(holder=caller.seat))
            return
        self.teacher.check(action, caller.seat, latched=self.latched)
        if action is Operation.RESET:
            return
        self.lease.check(caller, lease, now_s)
        if self.following and action in (Operation.MOVE, Operation.CALIBRATE):
            raise Refused(Reason.FOLLOWING)
        if action not in (Operation.MOVE, Operation.FOLLOW):
            return
        # Accept a motion of a program of 2023 after its own STOP: the firmware delays the motion until the arms rest.
        stop = self.last_stop
        if not stop.resting and not stop.presser.session == caller.session == TEXT_SESSION:
            if not (stop.sent and resting):
                raise refusals.coming_to_rest(stop.seat)
            stop.resting = True
        if pause is not None:
            raise pause
        self.begun += 1

    @_locked
    def take(self, caller: Caller) -> None:
        """Make the authorised caller the holder, just before its motion is sent to the board.

        Raises:
            Refused: MUTED, EMERGENCY, FROZEN or STOPPED, if this was so after `authorize`.
        """
        self.teacher.check(Operation.MOVE, caller.seat, latched=self.latched)
        if not self.last_stop.resting and caller.session != TEXT_SESSION:
            raise refusals.coming_to_rest(self.last_stop.seat)
        self.begun += 1
        self.lease.motion.begin(caller)

    @_locked
    def undo_take(self) -> None:
        """Undo the last `take`: restore the previous holder."""
        self.lease.motion.undo_begin()

    @_locked
    def rested(self, now_s: float) -> None:
        """Record the end of the holder's motion; the lease by this motion ends LINGER_S later."""
        self.lease.motion.rested(now_s)

    @_locked
    def release(self, now_s: float) -> None:
        """End the lease by motion, because its client or the router was lost."""
        self.lease.motion.release(now_s)

    @_locked
    def stop_pressed(self, presser: Caller, now_s: float, *, emergency: bool = False) -> None:
        """Record a STOP or EMERGENCY_STOP; the seat or the session of `presser` may be unknown.

        Motions are refused until `stop_sent` was called and the arms rest; EMERGENCY_STOP also sets the latch.
        The seat whose motion is running, or ended less than QUIET_S ago, must pause.

        Raises:
            Refused: MUTED, the teacher has muted the seat, and no motion of it is running.
        """
        if presser.seat in self.teacher.muted and not self.lease.motion.moves(presser.seat):
            raise refusals.muted(presser.seat, stop=True)
        self.last_stop = LastStop(presser, sent=False, resting=False)
        self.following = False
        heard_s = self._sessions.heard(presser, now_s)
        self._pauses.begin(self.lease.motion.driver(now_s), presser, now_s, heard_s)
        if emergency:
            self._latched_s = now_s
            self.teacher.latch |= presser.seat == TEACHER

    @_locked
    def stop_sent(self, now_s: float) -> None:
        """Record that the board has acknowledged STOP, has refused it or has not answered.

        Also pause the seat of a motion that overtook STOP; under the latch, end the lease by motion.
        """
        self.last_stop.sent = True
        presser = self.last_stop.presser
        heard_s = self._sessions.heard(presser, now_s)
        self._pauses.begin(self.lease.motion.driver(now_s), presser, now_s, heard_s)
        if self._latched_s is not None:
            self.lease.motion.release(now_s)

    @property
    def latched(self) -> bool:
        """Whether EMERGENCY_STOP is latched."""
        return self._latched_s is not None

    @_locked
    def latch(self, now_s: float, *, teacher: bool = False) -> None:
        """Set the latch: the board reports EMERGENCY_STOP, perhaps of an earlier node, or has not carried out RESET.

        `teacher`: it is the teacher's.
        """
        if self._latched_s is None:
            self._latched_s = now_s
        self.teacher.latch |= teacher

    @_locked
    def reset(self, received_s: float) -> None:
        """Clear the latch for a RESET that was received at `received_s`.

        Raises:
            Refused: EMERGENCY, if EMERGENCY_STOP was pressed after `received_s`.
        """
        if self._latched_s is not None and received_s < self._latched_s:
            raise refusals.emergency_latched()
        self._latched_s, self.teacher.latch = None, False

    @_locked
    def session_changed(self, caller: Caller, now_s: float, *, alive: bool) -> bool:
        """Record that a client's session has begun, returned or ended; return whether a running motion lost its client.

        `now_s` is the time at which its token arrived or disappeared. A session that has ended keeps its lease and its
        place in the queue until `give_up_sessions` ends them, because the router may have been lost.

        The end counts only for this seat with this session. In a class the router lets each client declare tokens of
        its own seat only, so no client can end the session of another seat.
        """
        if alive or not caller.session:
            self._sessions.began(caller, now_s)
            return False
        self._sessions.ended(caller, now_s)
        return self.lease.motion.runs(caller)

    @_locked
    def router_changed(self, now_s: float, *, connected: bool) -> None:
        """Record that the router was lost or is connected again; without a router no session ends."""
        self._sessions.router_changed(now_s, connected=connected)
        self.lease.router_changed(now_s, connected=connected)

    @_locked
    def give_up_sessions(self, now_s: float) -> bool:
        """End the leases and places of sessions that have been missing for too long.

        Return whether a running motion lost its client.
        """
        given_up = self._sessions.given_up(now_s)
        for caller in given_up:
            self.lease.session_ended(caller)
        return any(self.lease.motion.runs(caller) for caller in given_up)

    @_locked
    def old_program_began(self) -> None:
        """End the pause of programs of 2023: a program has opened the port, so the stopped one has ended."""
        self._pauses.end(OLD_PROGRAMS)
