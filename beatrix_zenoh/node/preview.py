"""Preview queries, on a thread of their own so that they never delay the robot."""

from __future__ import annotations

import queue
import threading
from collections.abc import Callable
from typing import Final

from beatrix_zenoh import threads
from beatrix_zenoh.bus import Incoming, Sessions, query_forms
from beatrix_zenoh.bus.query_forms import RawQuery
from beatrix_zenoh.contract import refusals
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import Head, PreviewReply, Reason
from beatrix_zenoh.contract._generated.serial import Move, MoveStraight
from beatrix_zenoh.contract.errors import BeatrixError, Refused
from beatrix_zenoh.node.context import Context
from beatrix_zenoh.node.interfaces import PREVIEW_MAX_S, Component, Preview
from beatrix_zenoh.node.planner import vector
from beatrix_zenoh.node.readiness import ready_telemetry
from beatrix_zenoh.node.requests import RequestHandle, request_handle

CAPACITY: Final = 8
"""Largest number of waiting previews; further ones are refused."""


class PreviewHandler(Component):
    """Answers preview queries one after the other."""

    def __init__(self, context: Context, carry_out: Callable[[Move | MoveStraight], Preview]) -> None:
        """Store `carry_out`, which runs a motion on a copy of the robot and may raise BeatrixError."""
        self._context, self._carry_out = context, carry_out
        self._waiting: queue.Queue[tuple[RawQuery, RequestHandle] | None] = queue.Queue(maxsize=CAPACITY)
        self._thread: threading.Thread | None = None

    def start(self, sessions: Sessions) -> None:
        self._thread = threads.start(self._run, "preview")
        sessions.serve(keys.preview(self._context.name, "*"), self._query)

    def _query(self, incoming: Incoming) -> None:
        """Queue a query, on Zenoh's thread; refuse it if the queue is full."""
        key = keys.preview(self._context.name, "*")
        handle = request_handle(incoming, key, "preview", self._context.events)
        try:
            self._waiting.put_nowait((incoming.raw, handle))
        except queue.Full:
            handle.end(preview_refusal(refusals.queue_full(CAPACITY)))

    def _run(self) -> None:
        while (entry := self._waiting.get()) is not None:
            raw, handle = entry
            try:
                reply = preview_reply(self._preview(raw))
            except BeatrixError as error:
                reply = preview_refusal(error)
            handle.end(reply)

    def _preview(self, raw: RawQuery) -> Preview:
        query = query_forms.read_motion_or_pose(raw)
        if self._context.access.following:
            raise Refused(Reason.FOLLOWING)
        last = self._context.controller.last_goal
        goal = self._context.planner.goal(query, ready_telemetry(self._context.board_watch.board), last)
        if goal.duration > PREVIEW_MAX_S:
            raise refusals.motion_too_long(goal.duration, PREVIEW_MAX_S)
        return self._carry_out(goal.frame(0))

    def close(self) -> None:
        """Refuse the waiting previews, finish the running one, and end the thread."""
        while not self._waiting.empty():
            try:
                entry = self._waiting.get_nowait()
            except queue.Empty:
                break
            if entry is not None:
                entry[1].end(preview_refusal(Refused(Reason.SHUTDOWN)))
        self._waiting.put(None)
        if self._thread is not None:
            self._thread.join(timeout=2.0)


def preview_reply(preview: Preview) -> PreviewReply:
    """Return the reply to a preview."""
    return PreviewReply(
        result=True,
        reason=Reason.OK,
        message=f"Possible: {preview.duration_s:.1f} s.",
        duration=preview.duration_s,
        tilt_max=preview.tilt_max,
        gap_min=preview.gap_min,
        t=preview.t,
        arms=[vector(arms) for arms in preview.arms],
        head=[Head(*head) for head in preview.head],
    )


def preview_refusal(error: BeatrixError) -> PreviewReply:
    """Return the reply to a refused preview."""
    return PreviewReply(
        result=False,
        reason=error.reason,
        message=error.message,
        duration=0.0,
        tilt_max=0.0,
        gap_min=0.0,
        t=[],
        arms=[],
        head=[],
        detail=error.detail,
    )
