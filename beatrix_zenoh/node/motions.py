"""Requests of motions: motion and pose queries, and the per-arm topics of 2023; their replies."""

from __future__ import annotations

from typing import Final

from msgspec.structs import replace

from beatrix_zenoh.bus import Incoming, Received, Sessions, query_forms
from beatrix_zenoh.contract import codec, names, refusals
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import (
    Detail,
    MotionQuery,
    MotionReply,
    Phase,
    PoseQuery,
    Reason,
    Source,
    Vector3,
)
from beatrix_zenoh.contract.errors import BeatrixError
from beatrix_zenoh.contract.names import ARM_TOPICS, ARMS
from beatrix_zenoh.motion.gear import Arms
from beatrix_zenoh.node.callers import Caller
from beatrix_zenoh.node.controller import MotionController
from beatrix_zenoh.node.interfaces import Component
from beatrix_zenoh.node.planner import Goal, vector
from beatrix_zenoh.node.requests import RequestHandle, Requests, check_own_key

RADIANS_HINT: Final = " (Over Zenoh angles are in rad: 10° = 0.1745 rad.)"
"""Added to a refusal if the query was text and a value is outside a limit."""
LIMIT_REASONS: Final = (Reason.OUT_OF_REACH, Reason.ARM_GAP, Reason.YAW_LIMIT, Reason.SPEED_LIMIT)


class MotionHandler(Component):
    """Answers motion and pose queries; a newer query on the same key replaces a waiting one."""

    def __init__(self, requests: Requests, controller: MotionController) -> None:
        self._requests, self._controller = requests, controller
        self._kinds: dict[str, tuple[str, type[MotionQuery | PoseQuery]]] = {
            "motion": (keys.motion(requests.name, requests.side, "*"), MotionQuery),
            "pose": (keys.pose(requests.name, requests.side, "*"), PoseQuery),
        }

    def start(self, sessions: Sessions) -> None:
        for action, (key, _) in self._kinds.items():
            sessions.serve(key, lambda incoming, action=action: self._query(incoming, action))  # type: ignore[misc]

    def _query(self, incoming: Incoming, action: str) -> None:
        """Queue the query, on Zenoh's thread.

        `_run` decodes it later, because in a flood most queries are replaced before they run.
        """
        key, _ = self._kinds[action]

        def decline(error: BeatrixError) -> None:
            self._decline(self._requests.handle(incoming, key, action), error)

        self._requests.queue.post_latest((action, incoming.key), lambda: self._run(incoming, action), decline)

    def _decline(self, handle: RequestHandle, error: BeatrixError) -> None:
        handle.end(motion_refusal(error, self._controller.arms()))

    # -- on the controller's thread -------------------------------------------------------------------

    def _run(self, incoming: Incoming, action: str) -> None:
        key, kind = self._kinds[action]
        handle = self._requests.handle(incoming, key, action)
        try:
            check_own_key(incoming.key, key)
            names.check_seat(handle.caller.seat)
            query = query_forms.read(incoming.raw, kind)
            handle = replace(handle, source=query.source, query=query)
            begin(self._controller, query, handle)
        except BeatrixError as error:
            typed = error.reason in LIMIT_REASONS and not incoming.raw.binary
            hint = RADIANS_HINT if typed else ""
            self._decline(handle, BeatrixError(error.reason, error.message + hint, error.detail))


def begin(controller: MotionController, query: MotionQuery | PoseQuery, handle: RequestHandle) -> None:
    """Begin a motion; reply ACCEPTED now and DONE at its end. Raises BeatrixError if the motion is refused."""

    def accepted(number: int, goal: Goal) -> None:
        text = f"Accepted: {goal.duration:.1f} s."
        handle.reply(motion_reply(Phase.ACCEPTED, Reason.OK, text, number, goal.duration, goal.target))

    def ended(number: int, reason: Reason, text: str, took_s: float) -> None:
        handle.end(motion_reply(Phase.DONE, reason, text, number, took_s, controller.arms()))

    controller.begin(query, handle.caller, ended, accepted)


def motion_reply(
    phase: Phase,
    reason: Reason,
    text: str,
    motion: int,
    duration_s: float,
    position: Arms,
    detail: Detail | None = None,
) -> MotionReply:
    """Return a reply to a motion; its result follows from the reason."""
    return MotionReply(
        result=reason is Reason.OK,
        phase=phase,
        reason=reason,
        message=text,
        motion=motion,
        duration=duration_s,
        position=vector(position),
        detail=detail,
    )


def motion_refusal(error: BeatrixError, position: Arms) -> MotionReply:
    """Return the reply to a refused motion; `position`: set points of the arms (rad)."""
    return motion_reply(Phase.ACCEPTED, error.reason, error.message, 0, 0.0, position, error.detail)


CALLER: Final = Caller(ARM_TOPICS, "")


class ArmTopics(Component):
    """Subscribes to the target angles of the three arms and begins motions to them."""

    def __init__(self, requests: Requests, controller: MotionController) -> None:
        self._requests, self._controller = requests, controller
        self._key = keys.arm_target(requests.name, requests.side, "*")

    def start(self, sessions: Sessions) -> None:
        sessions.subscribe(self._key, self._target)

    def _target(self, target: Received) -> None:
        """Queue the motion to a received target angle, on Zenoh's thread."""
        key, payload = target.key, target.payload
        parts = keys.parse(key)
        arm = "" if parts is None else parts.arm
        self._requests.queue.post_latest(f"arm/{arm}", lambda: self._run(key, arm, payload))

    def _run(self, key: str, arm: str, payload: bytes) -> None:
        """Decode a target angle and begin the motion to it, on the controller's thread."""
        handle = RequestHandle(
            CALLER, f"{arm} target", self._requests.events, send=self._warn, source=Source.ARM_TOPIC
        )
        try:
            check_own_key(key, self._key.replace("*", arm))
            if arm not in ARMS:
                raise refusals.bad_field(arm, f"There is no arm {arm!r}.", ARMS)
            self._move(ARMS.index(arm), codec.number(payload), handle)
        except BeatrixError as error:
            handle.end(motion_refusal(error, self._controller.arms()))

    def _warn(self, reply: object) -> None:
        """Warn in the status if the motion was refused or interrupted, because a put has no reply."""
        if isinstance(reply, MotionReply) and reply.reason not in (Reason.OK, Reason.REPLACED):
            self._controller.diagnostics.warn(f"{ARM_TOPICS}: {reply.message}", reply.reason)

    def _move(self, arm: int, angle: float, handle: RequestHandle) -> None:
        """Turn one arm to an angle (rad); the others keep the targets of a running motion of this seat, or stay."""
        controller = self._controller
        running = controller.running
        own = running is not None and running.caller == CALLER
        target = list(running.goal.exact if running is not None and own else controller.base())
        target[arm] = angle
        query = MotionQuery(position=Vector3(*target), source=Source.ARM_TOPIC)
        begin(controller, query, replace(handle, query=query))
