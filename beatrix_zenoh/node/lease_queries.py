"""Lease queries: a seat takes the robot and gives it back; the teacher freezes it, limits its speed, mutes seats."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from functools import partial
from typing import Final, NamedTuple

from msgspec.structs import replace

from beatrix_zenoh.bus import Incoming, Sessions, query_forms
from beatrix_zenoh.contract import names
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import (
    Detail,
    EventKind,
    LeaseAction,
    LeaseQuery,
    LeaseReply,
    Reason,
)
from beatrix_zenoh.contract.errors import BeatrixError, Refused, wrong_usage
from beatrix_zenoh.node.access import Access, Operation
from beatrix_zenoh.node.callers import Caller
from beatrix_zenoh.node.controller import MotionController, StopCause
from beatrix_zenoh.node.interfaces import Component, StatusFields
from beatrix_zenoh.node.leases import LONGEST_TURN_S, NO_TERMS, SHORTEST_TURN_S, TURN_S, Terms
from beatrix_zenoh.node.requests import RequestHandle, Requests, check_own_key

OF_SEATS: Final = (LeaseAction.TAKE, LeaseAction.WAIT, LeaseAction.GIVE_BACK)
"""What every seat may ask for; the rest is for the teacher."""


class LeaseState(NamedTuple):
    """The holder of the robot and the waiting seats."""

    holder: str
    """seat; empty: the robot is free"""
    lease: int
    """number of the lease that the holder has taken; 0: the robot is free, or a seat holds it only by its motion"""
    waiting: list[str]
    """seats, the next first"""
    turn_s: int = 0
    """time until the turn of the holder ends (s, rounded up); 0: no end is set"""


def standing(access: Access, now_s: float) -> LeaseState:
    """Return the holder of the robot and the waiting seats."""
    with access.lock:
        holder, number = access.lease.holder(now_s), access.lease.number(now_s)
        left_s = access.lease.left_s(now_s)
        turn_s = math.ceil(left_s) if math.isfinite(left_s) else 0
        return LeaseState(holder, number, access.lease.waiting(), turn_s)


def take(access: Access, caller: Caller, now_s: float, *, wait: bool = False, terms: Terms = NO_TERMS) -> int:
    """Let the caller take the robot; return the number of its lease, 0 if it now waits in the queue.

    Raises:
        Refused: as `Access.authorize`; NOT_HOLDER only without `wait`; BUSY if too many seats wait.
    """
    with access.lock:
        try:
            access.authorize(Operation.LEASE, caller, now_s)
        except Refused as error:
            if not wait or error.reason is not Reason.NOT_HOLDER:
                raise
            access.lease.wait(caller, now_s, terms)
            return 0
        return access.lease.take(caller, now_s, terms)


def mute(access: Access, seat: str, now_s: float) -> None:
    """Mute a seat; end its lease and its place in the queue."""
    with access.lock:
        access.teacher.muted |= {seat}
        access.lease.end(seat)
        if access.lease.motion.holder(now_s) == seat:
            access.lease.motion.release(now_s)


def end_turn(access: Access, now_s: float) -> str:
    """End the lease of the holder, also that by its motion; return the seat that holds the robot now."""
    with access.lock:
        access.lease.ended_by_teacher = access.lease.number(now_s)
        access.lease.end(access.lease.holder(now_s))
        access.lease.motion.release(now_s)
        return access.lease.holder(now_s)


def _turn_s(longest_s: float) -> float:
    """Return the length of a turn (s) in a query; 0: none. Raises WrongUsage (BAD_VALUE)."""
    if longest_s and not SHORTEST_TURN_S <= longest_s <= LONGEST_TURN_S:
        raise wrong_usage(
            f"A turn of {longest_s:g} s is not possible: give {SHORTEST_TURN_S:g} to {LONGEST_TURN_S:g} s.",
        )
    return longest_s


class LeaseHandler(Component):
    """Answers lease queries; each is carried out on the controller's thread."""

    def __init__(self, requests: Requests, controller: MotionController, keep: Callable[[], None]) -> None:
        """`keep` keeps the decisions of the teacher after each of them."""
        self._requests, self._controller, self._keep = requests, controller, keep
        self._access = controller.access
        self._key = keys.lease(requests.name, requests.side, "*")

    def start(self, sessions: Sessions) -> None:
        sessions.serve(self._key, self._query)

    def contribute(self, status: StatusFields) -> None:
        status.values |= standing(self._access, time.monotonic())._asdict()
        with self._access.lock:
            turn = self._access.lease.turn
            over, turn.over = turn.over, ""
        if over:
            self._requests.queue.post(lambda: self._end_motion_of(over), lambda _: None)

    def _end_motion_of(self, seat: str) -> None:
        """Stop a motion of a seat whose turn is over; called on the controller's thread."""
        if self._drives(seat) or (seat == names.OLD_PROGRAMS and self._controller.text_moves):
            self._stop(StopCause.TURN_OVER)

    # -- on Zenoh's thread ----------------------------------------------------------------------------

    def _query(self, incoming: Incoming) -> None:
        handle = self._requests.handle(incoming, self._key, "", EventKind.LEASE)
        try:
            names.check_seat(handle.caller.seat)
            check_own_key(incoming.key, self._key)
            query = query_forms.read(incoming.raw, LeaseQuery)
        except BeatrixError as error:
            self._decline(handle, error)
            return
        handle = replace(handle, action=query.action.value)
        self._requests.queue.post(lambda: self._run(query, handle), partial(self._decline, handle))

    def _decline(self, handle: RequestHandle, error: BeatrixError) -> None:
        handle.end(self._reply(error.reason, error.message, handle.caller, error.detail))

    # -- on the controller's thread -------------------------------------------------------------------

    def _run(self, query: LeaseQuery, handle: RequestHandle) -> None:
        try:
            if query.action not in OF_SEATS:
                self._access.authorize(Operation.GOVERN, handle.caller, time.monotonic())
                text = self._govern(query)
                self._keep()
            elif query.action is LeaseAction.GIVE_BACK:
                text = self._give_back(handle.caller)
            else:
                wait = query.action is LeaseAction.WAIT
                text = self._take(handle.caller, wait=wait, terms=self._terms(query))
        except BeatrixError as error:
            self._decline(handle, error)
            return
        handle.end(self._reply(Reason.OK, text, handle.caller))

    def _terms(self, query: LeaseQuery) -> Terms:
        self._controller.planner.check_limit(query.speed)
        return Terms(_turn_s(query.longest_s), query.speed)

    def _take(self, caller: Caller, *, wait: bool, terms: Terms) -> str:
        """Let the caller take the robot or wait for it; return the new state as a sentence.

        If the teacher takes the robot, stop a motion of another seat or of an old program.
        """
        access, controller = self._access, self._controller
        take(access, caller, time.monotonic(), wait=wait, terms=terms)
        now = standing(access, time.monotonic())
        if caller.seat in now.waiting:
            place = now.waiting.index(caller.seat) + 1
            return f"{now.holder} holds the robot; you are number {place} of {len(now.waiting)} in the queue."
        if controller.driven and not (controller.follows or self._drives(caller.seat)):
            controller.stop(StopCause.TAKEN)
        return f"{caller.seat} holds the robot until it is given back."

    def _give_back(self, caller: Caller) -> str:
        """End the lease of the caller; from the teacher, the turn of the seat that holds or moves the robot."""
        access, now_s = self._access, time.monotonic()
        holder = standing(access, now_s).holder
        if caller.seat == names.TEACHER and holder not in ("", names.TEACHER):
            following = end_turn(access, now_s)
            if self._controller.running is None or self._drives(holder):
                self._stop(StopCause.SKIPPED)
            return f"The turn of {holder} has ended; {following or 'no seat'} holds the robot now."
        with access.lock:
            given_back = access.lease.give_back(caller)
        if given_back:
            return "The lease or the place in the queue has ended."
        return "This seat neither holds the robot nor waits for it."

    def _govern(self, query: LeaseQuery) -> str:
        """Carry out a request that only the teacher may send; return the new state as a sentence."""
        access, controller, planner = self._access, self._controller, self._controller.planner
        if query.action in (LeaseAction.MUTE, LeaseAction.UNMUTE):
            return self._mute(query.seat, on=query.action is LeaseAction.MUTE)
        if query.action is LeaseAction.TURN:
            with access.lock:
                access.lease.turn.limit_s = _turn_s(query.longest_s) or TURN_S
                return f"While seats wait, a turn lasts at most {access.lease.turn.limit_s:.0f} s."
        if query.action is LeaseAction.LIMIT:
            planner.limit_speed(query.speed)
            text = "The speed limit of the teacher has ended; the robot's own limit applies."
            if planner.speed_limit:
                text = f"The arms turn at most {math.degrees(planner.speed_limit):.0f}°/s."
            if controller.running is None or not planner.exceeds_limit(controller.running.goal):
                return text
            controller.stop(StopCause.TOO_FAST)
            return f"{text} A faster motion was stopped."
        access.teacher.frozen = query.action is LeaseAction.FREEZE
        if query.action is LeaseAction.UNFREEZE:
            return "Every seat may move the robot again."
        if controller.driven and not self._drives(names.TEACHER):
            controller.stop(StopCause.FROZEN)
        return "The robot is frozen: only the teacher may move it."

    def _mute(self, seat: str, *, on: bool) -> str:
        """Mute or unmute a seat; return the new state as a sentence; raises Refused or WrongUsage (BAD_VALUE)."""
        access = self._access
        if names.check_seat(seat) == names.TEACHER:
            raise wrong_usage("The teacher cannot be muted. Give the seat of a student.")
        if not on:
            with access.lock:
                access.teacher.muted -= {seat}
            return f"{seat} is not muted and may move the robot."
        mute(access, seat, time.monotonic())
        if self._drives(seat):
            self._stop(StopCause.MUTED)
        return f"{seat} is muted: it only watches, and its STOP stops no other seat."

    def _stop(self, cause: StopCause) -> None:
        if self._controller.driven:
            self._controller.stop(cause)

    def _drives(self, seat: str) -> bool:
        running = self._controller.running
        return running is not None and running.caller.seat == seat

    def _reply(self, reason: Reason, text: str, caller: Caller, detail: Detail | None = None) -> LeaseReply:
        now = standing(self._access, time.monotonic())
        return LeaseReply(
            result=reason is Reason.OK,
            reason=reason,
            message=text,
            lease=now.lease if now.holder == caller.seat else 0,
            holder=now.holder,
            waiting=now.waiting,
            detail=detail,
        )
