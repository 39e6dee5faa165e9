"""Previews: a thread of its own, so that looking ahead never delays a robot."""

from __future__ import annotations

import queue

from beatrix_zenoh import requests, threads
from beatrix_zenoh._generated.messages import Head, PreviewReply, Reason
from beatrix_zenoh.board.board import Board
from beatrix_zenoh.errors import BeatrixError, Refused
from beatrix_zenoh.node.answers import Asker, preview_refused
from beatrix_zenoh.node.body import PREVIEW_MAX_S, Body, Preview
from beatrix_zenoh.node.course import Course, vector
from beatrix_zenoh.node.readiness import ready_telemetry
from beatrix_zenoh.requests import Wording

WAITING = 8


class Previewer:
    """Answers preview queries one after the other; refuses when too many wait."""

    def __init__(self, body: Body, board: Board, course: Course) -> None:
        self._body, self._board, self._course = body, board, course
        self._waiting: queue.Queue[tuple[Wording, Asker] | None] = queue.Queue(maxsize=WAITING)
        self._thread = threads.start(self._run, "preview")

    def ask(self, wording: Wording, asker: Asker) -> None:
        """Queue a preview; answered at once if too many wait."""
        try:
            self._waiting.put_nowait((wording, asker))
        except queue.Full:
            decline(asker, Refused(Reason.BUSY, f"{WAITING} previews are waiting already: ask again."))

    def _run(self) -> None:
        while (entry := self._waiting.get()) is not None:
            wording, asker = entry
            try:
                preview = self._look(wording)
            except BeatrixError as error:
                decline(asker, error)
                continue
            asker.answer(reply_of(preview))
            asker.finish()

    def _look(self, wording: Wording) -> Preview:
        query = requests.read_motion_or_pose(wording)
        goal = self._course.goal(query, ready_telemetry(self._board))
        if goal.duration > PREVIEW_MAX_S:
            raise Refused(
                Reason.TIMED_OUT,
                f"This motion takes {goal.duration:.0f} s and a preview looks {PREVIEW_MAX_S:.0f} s ahead: ask for a "
                "higher speed or a shorter way.",
            )
        preview = self._body.preview(goal.frame(0))
        if preview is None:
            raise Refused(Reason.FAULT, "This robot has no copy to try a motion on: ask its simulation.")
        return preview

    def close(self) -> None:
        """Finish the preview under way and end; those that wait get no answer from a node that leaves."""
        while not self._waiting.empty():
            entry = self._waiting.get_nowait()
            if entry is not None:
                decline(entry[1], Refused(Reason.SHUTDOWN, "The node is closing."))
        self._waiting.put(None)
        self._thread.join(timeout=2.0)


def reply_of(preview: Preview) -> PreviewReply:
    """A preview as it goes over the bus."""
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


def decline(asker: Asker, error: BeatrixError) -> None:
    """Tell the asker why there is no preview."""
    asker.answer(preview_refused(error))
    asker.finish()
