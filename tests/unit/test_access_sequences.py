"""No sequence of requests continues a stopped stream, enables latched motors, or gives a robot two holders."""

from __future__ import annotations

import math

import pytest
from access_callers import ANA, ANA_AGAIN, BEN, BEN_AGAIN, BOSS, NO_SESSION, OLD, refusal
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, invariant, precondition, rule

from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.errors import Refused
from beatrix_zenoh.contract.names import TEACHER
from beatrix_zenoh.node.access import Access, Operation
from beatrix_zenoh.node.callers import Caller
from beatrix_zenoh.node.known_sessions import RETURN_S
from beatrix_zenoh.node.lease_queries import mute, standing, take
from beatrix_zenoh.node.leases import TURN_S
from beatrix_zenoh.node.pauses import QUIET_OLD_PROGRAM_S, QUIET_S

# Counting coverage triples the time of these tests; test_access.py covers the same code.
pytestmark = pytest.mark.no_cover

CALLERS = st.sampled_from([ANA, ANA_AGAIN, BEN, BEN_AGAIN, BOSS, OLD, NO_SESSION])
RETURNING = st.frozensets(st.sampled_from(["ana", "ben", TEACHER]))
"""Seats whose sessions return after a restart of the router."""


class Sequences(RuleBasedStateMachine):
    """Requests of several seats and sessions in any order, compared with a simple model."""

    def __init__(self) -> None:
        super().__init__()
        self.access = Access()
        self.now_s = 0.0
        self.motors_on = False
        self.moving: Caller | None = None
        self.latched = False
        self.stopped_streams: dict[Caller, float] = {}
        """Callers whose motion was ended by another session's STOP, and the time of their last request for a motion."""
        self.new_programs: set[Caller] = set()
        self.stopped_twice: set[str] = set()
        """Seats of which another seat has stopped a program that was started after STOP."""

    @rule(seconds=st.sampled_from([0.01, 0.4, 1.0, 2.0, 3.1, 5.1]))
    def time_passes(self, seconds: float) -> None:
        self.now_s += seconds
        if self.access.give_up_sessions(self.now_s):
            self._lose_client()

    def _lose_client(self) -> None:
        self.access.release(self.now_s)
        self.moving = None

    def _begin_motion(self, caller: Caller) -> Refused | None:
        """Begin a motion of the caller; return the refusal, if there is one."""
        try:
            self.access.authorize(Operation.MOVE, caller, self.now_s, resting=self.moving is None)
            self.access.take(caller)
        except Refused as refused:
            return refused
        self.moving = caller
        return None

    @rule(caller=CALLERS)
    def move(self, caller: Caller) -> None:
        quiet_s = QUIET_OLD_PROGRAM_S if caller is OLD else QUIET_S
        requested_s = self.stopped_streams.get(caller)
        paused = requested_s is not None and self.now_s - requested_s < quiet_s
        before = self.moving
        if self._begin_motion(caller) is None:
            assert not paused, "a stopped stream continues"
            assert not self.latched, "a motion under the latch"
            assert caller.seat not in self.access.teacher.muted, "a muted seat moves"
            if before is not None and before.seat != caller.seat:
                assert TEACHER in (caller.seat, before.seat), "two seats hold the robot"
            assert caller.seat == TEACHER or not self.access.teacher.frozen, "a frozen robot moves"
            self.stopped_streams.pop(caller, None)
        elif requested_s is not None:
            self.stopped_streams[caller] = self.now_s if paused else requested_s

    @rule(seat=st.sampled_from(["ana", "ben", TEACHER]), token_first=st.booleans())
    def a_new_program_moves(self, seat: str, token_first: bool) -> None:
        """A program that starts now is refused after STOP only if another seat has stopped two programs of its seat."""
        caller = Caller(seat, f"new{len(self.new_programs)}")
        self.now_s += 0.01
        if token_first:
            self.access.session_changed(caller, self.now_s, alive=True)
        self.new_programs.add(caller)
        refused = self._begin_motion(caller)
        if refused is not None and refused.detail is not None and refused.reason is Reason.STOPPED:
            assert seat in self.stopped_twice, "a program that starts again is refused"

    @rule(caller=CALLERS)
    def enable(self, caller: Caller) -> None:
        self.motors_on |= refusal(self.access, caller, self.now_s, Operation.ENABLE) is Reason.OK

    @rule(caller=CALLERS, emergency=st.booleans())
    def stop(self, caller: Caller, emergency: bool) -> None:
        driving = self.moving
        try:
            self.access.stop_pressed(caller, self.now_s, emergency=emergency)
        except Refused:
            assert caller.seat in self.access.teacher.muted
            return
        assert caller.seat not in self.access.teacher.muted, (
            "the STOP of a muted seat, of which nothing moves"
        )
        self.access.stop_sent(self.now_s)
        self.access.rested(self.now_s)
        if driving is not None and (not caller.session or caller.session != driving.session):
            self.stopped_streams[driving] = self.now_s
            if driving in self.new_programs and caller.seat != driving.seat:
                self.stopped_twice.add(driving.seat)
        self.moving = None
        if emergency:
            self.latched, self.motors_on = True, False

    @rule(caller=CALLERS, wait=st.booleans())
    def take_lease(self, caller: Caller, wait: bool) -> None:
        holder = self.access.lease.holder(self.now_s)
        try:
            number = take(self.access, caller, self.now_s, wait=wait)
        except Refused:
            return
        if number:
            assert holder in ("", caller.seat) or caller.seat == TEACHER, (
                "the robot was taken from its holder"
            )
        else:
            assert caller.seat in standing(self.access, self.now_s).waiting

    @rule(caller=CALLERS)
    def give_back_lease(self, caller: Caller) -> None:
        self.access.lease.give_back(caller)

    @rule(seat=st.sampled_from(["ana", "ben"]), on=st.booleans())
    def mute(self, seat: str, on: bool) -> None:
        if not on:
            self.access.teacher.muted -= {seat}
            return
        mute(self.access, seat, self.now_s)
        assert self.access.lease.holder(self.now_s) != seat
        assert seat not in standing(self.access, self.now_s).waiting
        if self.moving is not None and self.moving.seat == seat:
            self.moving = None  # the node stops the motion

    @rule(on=st.booleans())
    def freeze(self, on: bool) -> None:
        self.access.teacher.frozen = on

    @precondition(lambda self: self.moving is not None)
    @rule()
    def arrive(self) -> None:
        self.access.rested(self.now_s)
        self.moving = None

    @rule()
    def reset(self) -> None:
        self.access.reset(self.now_s)
        self.latched = False

    @rule(caller=CALLERS.filter(lambda caller: caller is not OLD), alive=st.booleans())
    def session_changes(self, caller: Caller, alive: bool) -> None:
        """Programs of 2023 have no Zenoh session, so no token of theirs can change."""
        if self.access.session_changed(caller, self.now_s, alive=alive):
            assert self.moving == caller
            self._lose_client()

    @rule(away_s=st.sampled_from([0.05, 0.8, 100.0]), notice_first=st.booleans(), returning=RETURNING)
    def the_router_restarts(self, away_s: float, notice_first: bool, returning: frozenset[str]) -> None:
        """Seats of which all sessions return keep a lease that they have taken, and their places in the queue.

        The turn of the holder begins anew.
        """
        before = standing(self.access, self.now_s)
        sessions = [ANA, ANA_AGAIN, BEN, BEN_AGAIN, BOSS, *self.new_programs]
        if notice_first:
            self.access.router_changed(self.now_s, connected=False)
        for caller in sessions:
            self.access.session_changed(caller, self.now_s, alive=False)
        if not notice_first:
            self.access.router_changed(self.now_s + 0.01, connected=False)
        self._lose_client()
        self.time_passes(away_s)
        self.access.router_changed(self.now_s, connected=True)
        for caller in sessions:
            if caller.seat in returning:
                self.access.session_changed(caller, self.now_s, alive=True)
        self.time_passes(RETURN_S - 0.1)
        if before.lease:
            turn_s = math.ceil(TURN_S - RETURN_S + 0.1) if before.turn_s else 0
            assert standing(self.access, self.now_s) == before._replace(turn_s=turn_s)
        self.time_passes(0.2)
        if before.lease:
            stay = {OLD.seat, NO_SESSION.seat, *returning}
            queue = [seat for seat in (before.holder, *before.waiting) if seat in stay]
            after = standing(self.access, self.now_s)
            assert [after.holder, *after.waiting] == (queue or [""])
            assert (after.lease == before.lease) == (before.holder in stay)

    @invariant()
    def motors_are_off_under_the_latch(self) -> None:
        assert self.access.latched == self.latched
        assert not (self.latched and self.motors_on)

    @invariant()
    def the_moving_seat_holds_the_robot(self) -> None:
        now = standing(self.access, self.now_s)
        if self.moving is not None and not now.lease:
            assert now.holder == self.moving.seat

    @invariant()
    def a_seat_that_holds_the_robot_does_not_wait_for_it(self) -> None:
        now = standing(self.access, self.now_s)
        assert not now.lease or now.holder not in now.waiting
        assert now.holder or not now.waiting, "a free robot goes to the first waiting seat"


TestSequences = Sequences.TestCase
