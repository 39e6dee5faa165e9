"""The component that lets a simulation follow the hardware of its name, and answers the queries that switch it."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Callable
from typing import Final

from msgspec.structs import replace

from beatrix_zenoh.bus import Incoming, Received, Sessions, query_forms
from beatrix_zenoh.contract import codec, names
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import (
    EventKind,
    FollowQuery,
    FollowState,
    Positions,
    Reason,
    Status,
)
from beatrix_zenoh.contract.errors import BeatrixError, Refused
from beatrix_zenoh.node import Component, StatusFields
from beatrix_zenoh.node.access import Operation
from beatrix_zenoh.node.callers import Caller
from beatrix_zenoh.node.controller import MotionController, StopCause
from beatrix_zenoh.node.events import new_event
from beatrix_zenoh.node.requests import RequestHandle, Requests, check_own_key, command_refusal, command_reply
from beatrix_zenoh.node.snapshot import Snapshot
from sim_node.following.arms import OwnArms, follows
from sim_node.following.follower import NO_STATUS, Follower, HardwareSample

CHECK_S: Final = 0.1
"""Period (s) of the check whether the simulation may still follow, and whether the hardware is silent."""
FOLLOWS: Final = (
    "The simulation follows the hardware and takes no motions of its own until `beatrix follow off` or STOP."
)
ENDED: Final = "The simulation does not follow the hardware; it carries out its own motions."


class FollowHandler(Component):
    """Moves the simulation to the set points of the hardware, on the controller's thread."""

    def __init__(
        self, requests: Requests, controller: MotionController, snapshot: Snapshot, *, at_start: bool
    ) -> None:
        """`at_start`: follow from the start on, as soon as the simulation is ready."""
        self._controller, self._snapshot, self._at_start = controller, snapshot, at_start
        self._requests, self._queue, self._events = requests, requests.queue, requests.events
        self._access = controller.access
        self._key = keys.follow(requests.name, "*")
        self._ends: list[Callable[[], None]] = []
        """what ends the subscriptions"""
        self._sessions: Sessions | None = None
        self._follower: Follower | None = None
        self._arms = OwnArms(controller, snapshot)
        self._sample: HardwareSample | None = None
        self._was_ready = self._holds = False
        self._state = FollowState.OFF
        self._warnings: list[str] = []

    def start(self, sessions: Sessions) -> None:
        self._sessions = sessions
        sessions.serve(self._key, self._query)
        if self._at_start:
            self._access.following = True
            self._queue.post_event(lambda: self._begin(sessions))

    def contribute(self, status: StatusFields) -> None:
        # STOP ends following at once, before this component notices it.
        following = self._access.following
        status.values["following"] = self._state if following else FollowState.OFF
        if following:
            status.values["motion"] = 0
            status.warnings += self._warnings

    def close(self) -> None:
        """End the subscriptions."""
        for end in self._ends:
            end()
        self._ends = []

    # -- on Zenoh's threads -------------------------------------------------------------------------

    def _query(self, incoming: Incoming) -> None:
        handle = self._requests.handle(incoming, self._key, "FOLLOW", EventKind.COMMAND)

        def decline(error: BeatrixError) -> None:
            handle.end(command_refusal(error, self._controller.arms()))

        try:
            names.check_seat(handle.caller.seat)
            check_own_key(incoming.key, self._key)
            query = query_forms.read(incoming.raw, FollowQuery)
        except BeatrixError as error:
            decline(error)
            return
        self._queue.post(lambda: self._run(query, handle), decline)

    def _hear_positions(self, received: Received) -> None:
        with contextlib.suppress(BeatrixError):  # it does not come from a node of this version
            positions = codec.decode(received.payload, Positions)
            self._sample = HardwareSample.of(positions, time.monotonic())
            self._queue.post_latest("follow", self._step)

    def _hear_status(self, received: Received) -> None:
        def hear() -> None:
            if self._follower is not None:
                self._follower.hear_status(status)

        with contextlib.suppress(BeatrixError):
            status = codec.decode(received.payload, Status)
            self._queue.post_event(hear)

    # -- switching, on the controller's thread ------------------------------------------------------

    def _run(self, query: FollowQuery, handle: RequestHandle) -> None:
        action = "FOLLOW" if query.follow else "FOLLOW off"
        handle = replace(handle, action=action, source=query.source)
        controller = self._controller
        try:
            text = self._switch(handle.caller, on=query.follow)
        except BeatrixError as error:
            handle.end(command_refusal(error, controller.arms()))
            return
        handle.end(command_reply(Reason.OK, text, controller.arms()))

    def _switch(self, caller: Caller, *, on: bool) -> str:
        """Begin or end following; return the new state as a sentence; raises BeatrixError."""
        self._check_allowed()
        begins = on and self._follower is None and self._sessions is not None
        try:
            if begins:
                self._access.following = True  # before `authorize`: a STOP after it must not be overwritten
            self._authorize(caller, begins=begins)
        except BeatrixError:
            self._access.following = self._follower is not None and self._access.following
            raise
        if not on:
            self._end("")
            return ENDED
        if begins and self._sessions is not None:
            self._begin(self._sessions)
        return FOLLOWS

    def _authorize(self, caller: Caller, *, begins: bool) -> None:
        controller = self._controller
        resting = not controller.moving
        self._access.authorize(Operation.FOLLOW, caller, time.monotonic(), resting=resting)
        if begins:
            if controller.driven or not resting:
                raise Refused(Reason.NOT_AT_REST)
            controller.board.ready_telemetry()

    def _begin(self, sessions: Sessions) -> None:
        self._follower, self._arms = Follower(time.monotonic()), OwnArms(self._controller, self._snapshot)
        self._sample, self._was_ready, self._holds = None, False, False
        self._state, self._warnings = FollowState.WAITING, []
        name = self._requests.name
        self._ends = [
            sessions.subscribe(keys.positions(name, "hw"), self._hear_positions),
            sessions.subscribe(keys.status(name, "hw"), self._hear_status),
        ]
        self._check(self._follower)

    def _end(self, why: str) -> None:
        """End following, with a warning if there is a reason to state."""
        if self._follower is None:
            return
        controller = self._controller
        self._follower, self._access.following = None, False
        self.close()
        self._brake()  # the next motion begins where the arms come to rest
        controller.follows = False
        if why:
            text = f"The simulation no longer follows the hardware: {why}"
            self._events.add(new_event(kind=EventKind.WARNING, message=text))

    # -- following, on the controller's thread ------------------------------------------------------

    def _check(self, follower: Follower) -> None:
        """Check every CHECK_S whether the simulation may follow, and what it waits for."""
        self._check_allowed()
        if self._follower is follower:
            now_s = time.monotonic()
            self._hold_if_waiting(follower, now_s)
            self._show(follower, now_s)
            self._queue.post_later(now_s + CHECK_S, lambda: self._check(follower))

    def _hold_if_waiting(self, follower: Follower, now_s: float) -> bool:
        """Stop the arms if the simulation has to wait for the hardware; return whether it has to."""
        held, self._holds = self._holds, bool(follower.waits_for(now_s))
        if self._holds:
            follower.hold()
            if not held:
                self._brake()
        return self._holds

    def _brake(self) -> None:
        """Stop the arms if they follow; the telemetry may not show yet that they move."""
        if self._controller.follows:
            self._controller.stop(StopCause.STOP)
            self._arms = OwnArms(self._controller, self._snapshot)  # the same motion may be needed again

    def _check_allowed(self) -> None:
        """End following if the simulation was stopped or is no longer ready to move."""
        if self._follower is None:
            return
        if not follows(self._access):
            frozen = self._access.teacher.frozen
            self._end("the teacher has frozen it." if frozen else "STOP of the simulation was pressed.")
            return
        try:
            self._controller.board.ready_telemetry()
            self._was_ready = True
        except BeatrixError as error:
            if self._was_ready:
                self._end(error.message)

    def _step(self) -> None:
        """Carry out the motion that follows from the newest positions of the hardware."""
        self._check_allowed()
        follower, sample = self._follower, self._sample
        if follower is None or sample is None or not self._was_ready:
            return
        follower.hear(sample)
        now_s = time.monotonic()
        own = None if self._hold_if_waiting(follower, now_s) else self._arms.set_point(now_s)
        step = None if own is None else follower.step(now_s, own, self._controller.planner.limits)
        if step is not None:
            try:
                self._arms.move(step)
                follower.accepted()
            except BeatrixError as error:
                follower.refused(now_s, error.message)
                self._brake()  # the last path no longer leads to the hardware
        follower.compare(*self._arms.measured())
        self._show(follower, now_s)

    def _show(self, follower: Follower, now_s: float) -> None:
        """Set the state and the warnings of the status, and record their changes as events."""
        state, warnings = follower.state(now_s), follower.warnings(now_s)
        following = ["The simulation follows the hardware."]
        said = warnings if state in (FollowState.WAITING, FollowState.PARTED) else following
        news = state is not self._state or (state is FollowState.WAITING and warnings != self._warnings)
        if news and state is not FollowState.APPROACHING and said != [NO_STATUS]:
            self._events.add(new_event(kind=EventKind.WARNING, message=said[0]))
        self._state, self._warnings = state, warnings
