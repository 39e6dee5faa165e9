"""The per-arm topics of 2023: one number moves one arm; a refusal is reported as a warning and an event."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

from beatrix_zenoh.bus import Received, Sessions
from beatrix_zenoh.contract import codec, refusals
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import MotionQuery, MotionReply, Reason, Source, Vector3
from beatrix_zenoh.contract.errors import BeatrixError
from beatrix_zenoh.contract.names import ARM_TOPICS, ARMS
from beatrix_zenoh.node import motions, replies
from beatrix_zenoh.node.component import Component
from beatrix_zenoh.node.context import Context
from beatrix_zenoh.node.lease import Caller
from beatrix_zenoh.node.request_handle import RequestHandle, check_own_key
from beatrix_zenoh.node.request_queue import Task

CALLER: Final = Caller(ARM_TOPICS, "")


class ArmTopics(Component):
    """Subscribes to the target angles of the three arms and begins motions to them."""

    def __init__(self, context: Context) -> None:
        self._context = context

    def start(self, sessions: Sessions) -> None:
        sessions.subscribe(keys.arm_target(self._context.name, self._context.side, "*"), self._target)

    def _target(self, target: Received) -> None:
        """Queue the motion to a received target angle, on Zenoh's thread."""
        key, payload = target.key, target.payload
        parts = keys.parse(key)
        arm = "" if parts is None else parts.arm
        task = Task(lambda: self._run(key, arm, payload), lambda _: None)
        self._context.queue.post_latest(f"arm/{arm}", task)

    def _run(self, key: str, arm: str, payload: bytes) -> None:
        """Decode a target angle and begin the motion to it, on the controller's thread."""
        handle = RequestHandle(
            CALLER, f"{arm} target", self._context.events, send=self._warn, source=Source.ARM_TOPIC
        )
        try:
            check_own_key(key, keys.arm_target(self._context.name, self._context.side, arm))
            if arm not in ARMS:
                raise refusals.bad_field(arm, f"There is no arm {arm!r}.", ARMS)
            self._move(ARMS.index(arm), codec.number(payload), handle)
        except BeatrixError as error:
            handle.end(replies.motion_refusal(error, self._context.controller.arms()))

    def _warn(self, reply: object) -> None:
        """Warn in the status if the motion was refused or interrupted, because a put has no reply."""
        if isinstance(reply, MotionReply) and reply.reason not in (Reason.OK, Reason.REPLACED):
            self._context.diagnostics.warn(f"{ARM_TOPICS}: {reply.message}", reply.reason)

    def _move(self, arm: int, angle: float, handle: RequestHandle) -> None:
        """Turn one arm to an angle (rad); the others keep the targets of a running motion of this seat, or stay."""
        controller = self._context.controller
        running = controller.running
        own = running is not None and running.caller == CALLER
        target = list(running.goal.exact if running is not None and own else controller.base())
        target[arm] = angle
        query = MotionQuery(position=Vector3(*target), source=Source.ARM_TOPIC)
        motions.begin(controller, query, replace(handle, query=query))
