"""Lease queries: a seat takes the robot and gives it back; the teacher freezes it and limits its speed."""

from __future__ import annotations

import math
import time
from typing import Final, NamedTuple

from beatrix_zenoh import names
from beatrix_zenoh._generated import keys
from beatrix_zenoh._generated.messages import Detail, EventKind, LeaseAction, LeaseQuery, LeaseReply, Reason
from beatrix_zenoh.bus import Incoming, Sessions, query_forms
from beatrix_zenoh.errors import BeatrixError, Refused
from beatrix_zenoh.node.access import Access, Action
from beatrix_zenoh.node.component import Component, Context, StatusFields
from beatrix_zenoh.node.lease import Caller
from beatrix_zenoh.node.own_key import check_own_key
from beatrix_zenoh.node.replies import StopCause
from beatrix_zenoh.node.request_handle import RequestHandle, request_handle
from beatrix_zenoh.node.request_queue import Task

GOVERNS: Final = (LeaseAction.FREEZE, LeaseAction.UNFREEZE, LeaseAction.LIMIT)


class Standing(NamedTuple):
    """The holder of the robot, the waiting seats, and whether the robot is frozen."""

    holder: str
    """seat; empty: the robot is free"""
    lease: int
    """number of the lease that the holder has taken; 0: the robot is free, or a seat holds it only by its motion"""
    waiting: tuple[str, ...]
    """seats, the next first"""
    frozen: bool


def standing(access: Access, now_s: float) -> Standing:
    """Return the holder of the robot, the waiting seats, and whether the robot is frozen."""
    with access.lock:
        holder, number = access.lease.holder(now_s), access.lease.number(now_s)
        return Standing(holder, number, tuple(access.lease.waiting()), access.frozen)


def take(access: Access, caller: Caller, now_s: float, *, wait: bool = False) -> int:
    """Let the caller take the robot; return the number of its lease, 0 if it now waits in the queue.

    Raises:
        Refused: as `Access.authorize`; NOT_HOLDER only without `wait`; BUSY if too many seats wait.
    """
    with access.lock:
        try:
            access.authorize(Action.LEASE, caller, now_s)
        except Refused as error:
            if not wait or error.reason is not Reason.NOT_HOLDER:
                raise
            access.lease.wait(caller)
            return 0
        return access.lease.take(caller, now_s)


def give_back(access: Access, caller: Caller) -> bool:
    """Return the result of `Lease.give_back` for the caller's seat, called with the lock held."""
    with access.lock:
        return access.lease.give_back(caller.seat)


class LeaseHandler(Component):
    """Answers lease queries; each is carried out on the controller's thread."""

    def __init__(self, context: Context) -> None:
        self._context = context
        self._key = keys.lease(context.name, context.twin, "*")

    def start(self, sessions: Sessions) -> None:
        sessions.serve(self._key, self._query)

    def contribute(self, status: StatusFields) -> None:
        now = standing(self._context.access, time.monotonic())
        status.values["holder"] = now.holder
        status.values["lease"] = now.lease
        status.values["waiting"] = list(now.waiting)
        status.values["frozen"] = now.frozen
        status.values["speed_limit"] = self._context.planner.speed_limit

    # -- on Zenoh's thread ----------------------------------------------------------------------------

    def _query(self, incoming: Incoming) -> None:
        handle = request_handle(incoming, self._key, "", self._context.events, EventKind.LEASE)
        try:
            names.check_seat(handle.caller.seat)
            check_own_key(incoming.key, self._key)
            query = query_forms.read(incoming.raw, LeaseQuery)
        except BeatrixError as error:
            self._decline(handle, error)
            return
        handle = request_handle(
            incoming, self._key, query.action.value, self._context.events, EventKind.LEASE
        )

        def decline(error: BeatrixError) -> None:
            self._decline(handle, error)

        self._context.queue.post(Task(lambda: self._run(query, handle), decline))

    def _decline(self, handle: RequestHandle, error: BeatrixError) -> None:
        handle.end(self._reply(error.reason, error.message, handle.caller, error.detail))

    # -- on the controller's thread -------------------------------------------------------------------

    def _run(self, query: LeaseQuery, handle: RequestHandle) -> None:
        try:
            if query.action in GOVERNS:
                text = self._govern(query, handle.caller)
            elif query.action is LeaseAction.GIVE_BACK:
                held = give_back(self._context.access, handle.caller)
                text = (
                    "The lease or the place in the queue has ended."
                    if held
                    else "This seat neither holds the robot nor waits for it."
                )
            else:
                text = self._take(handle.caller, wait=query.action is LeaseAction.WAIT)
        except BeatrixError as error:
            self._decline(handle, error)
            return
        handle.end(self._reply(Reason.OK, text, handle.caller))

    def _take(self, caller: Caller, *, wait: bool) -> str:
        """Let the caller take the robot or wait for it; return the new state as a sentence.

        If the teacher takes the robot, stop a motion of another seat or of an old program.
        """
        access, controller = self._context.access, self._context.controller
        take(access, caller, time.monotonic(), wait=wait)
        now = standing(access, time.monotonic())
        if caller.seat in now.waiting:
            place = now.waiting.index(caller.seat) + 1
            return f"{now.holder} holds the robot; you are number {place} of {len(now.waiting)} in the queue."
        if controller.driven and not self._drives(caller.seat):
            controller.stop(StopCause.TAKEN)
        return f"{caller.seat} holds the robot until it is given back."

    def _govern(self, query: LeaseQuery, caller: Caller) -> str:
        """Carry out a request that only the teacher may send; return the new state as a sentence."""
        access, controller, planner = self._context.access, self._context.controller, self._context.planner
        access.authorize(Action.GOVERN, caller, time.monotonic())
        if query.action is LeaseAction.LIMIT:
            planner.limit_speed(query.speed)
            if not planner.speed_limit:
                return "The speed limit of the teacher has ended; the robot's own limit applies."
            text = f"The arms turn at most {math.degrees(planner.speed_limit):.0f}°/s."
            if controller.running is None or not planner.exceeds_limit(controller.running.goal):
                return text
            controller.stop(StopCause.TOO_FAST)
            return f"{text} A faster motion was stopped."
        access.freeze(on=query.action is LeaseAction.FREEZE)
        if query.action is LeaseAction.UNFREEZE:
            return "Every seat may move the robot again."
        if controller.driven and not self._drives(names.TEACHER):
            controller.stop(StopCause.FROZEN)
        return "The robot is frozen: only the teacher may move it."

    def _drives(self, seat: str) -> bool:
        running = self._context.controller.running
        return running is not None and running.caller.seat == seat

    def _reply(self, reason: Reason, text: str, caller: Caller, detail: Detail | None = None) -> LeaseReply:
        now = standing(self._context.access, time.monotonic())
        return LeaseReply(
            result=reason is Reason.OK,
            reason=reason,
            message=text,
            lease=now.lease if now.holder == caller.seat else 0,
            holder=now.holder,
            waiting=list(now.waiting),
            detail=detail,
        )
