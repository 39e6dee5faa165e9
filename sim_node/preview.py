"""Previews of motions: their queries, and the same firmware and physics on copies, faster than real time.

A thread of its own answers, so that previews never delay the robot.
"""

from __future__ import annotations

import math
import threading
from collections.abc import Callable
from typing import Final

from beatrix_zenoh.board.virtual import Firmware
from beatrix_zenoh.bus import Incoming, Sessions, query_forms
from beatrix_zenoh.bus.query_forms import RawQuery
from beatrix_zenoh.contract import refusals
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import Detail, Head, Limit, PreviewReply, Reason
from beatrix_zenoh.contract._generated.serial import (
    BoardOutcome,
    BoardState,
    Move,
    MoveStraight,
)
from beatrix_zenoh.contract.errors import BeatrixError, Refused
from beatrix_zenoh.motion.gear import Arms
from beatrix_zenoh.node import QueryThread
from beatrix_zenoh.node.controller import MotionController
from beatrix_zenoh.node.planner import vector
from beatrix_zenoh.node.requests import own_key, seat_of
from sim_node.plant import Plant
from sim_node.virtual_time import VirtualTime

PREVIEW_MAX_S = 60.0
"""Longest duration (s) of a motion in a preview."""


LONGEST_MS: Final = round(PREVIEW_MAX_S * 1000)
"""Longest preview (simulated ms), in case the firmware takes longer than was computed before."""
SAMPLES_MAX: Final = 300
"""Largest number of samples of a reply."""
_SETTLE_MS: Final = 1000
"""Longest wait until the arms rest after the firmware's last step."""
_AT_REST: Final = math.radians(0.2)
"""Arms below this velocity (rad/s) are at rest."""


def simulate_motion(plant: Plant, firmware: Firmware, move: Move | MoveStraight) -> PreviewReply:
    """Carry out a motion until the arms rest, as fast as this computer can, and return the reply with its samples.

    This changes `plant` and `firmware`, which must be copies. Raises Refused if the firmware refuses the motion, stops
    it before its end, or needs more than LONGEST_MS, or if the neck would leave its home assembly.
    """
    run = _MotionSimulation(plant, firmware)
    run.send(move.kind, move.pack())
    while not run.at_rest():
        if run.now_ms >= LONGEST_MS:
            raise Refused(
                Reason.TIMED_OUT,
                f"This motion takes longer than {LONGEST_MS / 1000:.0f} s, the longest preview: "
                "use a higher speed or a shorter motion.",
            )
        run.advance()
        run.sample()
        if plant.home_assembly_left():
            raise Refused(
                Reason.FAULT,
                "During this motion the neck would snap out of its home assembly: choose another motion.",
            )
    return run.result()


class _MotionSimulation(VirtualTime):
    """The simulation of one motion."""

    def __init__(self, plant: Plant, firmware: Firmware) -> None:
        super().__init__(plant, firmware)
        self._stopped_ms: int | None = None
        self._samples: list[tuple[int, Arms, Arms]] = []
        self._tilt_max, self._gap_min = plant.tilt(), plant.gap()
        self.sample()

    def at_rest(self) -> bool:
        """Return whether the firmware has made its last step, and the arms rest or _SETTLE_MS have passed since."""
        telemetry = self.telemetry
        if telemetry is None or telemetry.state & BoardState.MOVING:
            return False
        if self._stopped_ms is None:
            self._stopped_ms = self.now_ms
        waited = self.now_ms - self._stopped_ms >= _SETTLE_MS
        return waited or max(map(abs, self.plant.velocities())) < _AT_REST

    def result(self) -> PreviewReply:
        """Return at most SAMPLES_MAX samples of the motion; raises Refused if the firmware stopped it."""
        outcome = BoardOutcome.DONE if self.telemetry is None else BoardOutcome(self.telemetry.outcome)
        if outcome is not BoardOutcome.DONE:
            raise Refused(outcome.reason, f"The firmware would end this motion {outcome.text}.")
        every = -(-len(self._samples) // SAMPLES_MAX)
        samples = self._samples[-1::-every][::-1]
        if samples[0][0]:
            samples[0] = self._samples[0]
        duration_s = self.now_ms / 1000
        return PreviewReply(
            result=True,
            reason=Reason.OK,
            message=f"Possible: {duration_s:.1f} s.",
            duration=duration_s,
            tilt_max=self._tilt_max,
            gap_min=self._gap_min,
            t=[t / 1000 for t, _, _ in samples],
            arms=[vector(arms) for _, arms, _ in samples],
            head=[Head(*head) for _, _, head in samples],
        )

    def sample(self) -> None:
        """Record where arms and head are, the largest tilt and the smallest gap."""
        self._tilt_max = max(self._tilt_max, self.plant.tilt())
        self._gap_min = min(self._gap_min, self.plant.gap())
        self._samples.append((self.now_ms, self.plant.arms(), self.plant.head()))


CAPACITY: Final = 8
"""Largest number of waiting previews; further ones are refused."""


class PreviewHandler(QueryThread):
    """Answers preview queries one after the other."""

    def __init__(
        self,
        name: str,
        controller: MotionController,
        carry_out: Callable[[Move | MoveStraight], PreviewReply],
    ) -> None:
        """Store `carry_out`, which runs a motion on a copy of the robot and may raise BeatrixError."""
        super().__init__("beatrix-preview", {})
        self._key, self._controller, self._carry_out = keys.preview(name, "*"), controller, carry_out
        self._free, self._closed = threading.Semaphore(CAPACITY), False

    def start(self, sessions: Sessions) -> None:
        super().start(sessions)
        sessions.serve(self._key, self._query)

    def _query(self, incoming: Incoming) -> None:
        """Queue a query, on Zenoh's thread; refuse it if the queue is full."""
        if self._free.acquire(blocking=False):
            self.post(lambda: self._run(incoming))
        else:
            self._reply(incoming, preview_refusal(refusals.queue_full(CAPACITY)))

    def _run(self, incoming: Incoming) -> None:
        try:
            if self._closed:
                raise Refused(Reason.SHUTDOWN)
            reply = self._preview(incoming.raw)
        except BeatrixError as error:
            reply = preview_refusal(error)
        finally:
            self._free.release()
        self._reply(incoming, reply)

    def _reply(self, incoming: Incoming, reply: PreviewReply) -> None:
        key = own_key(self._key, seat_of(incoming.key, self._key))
        incoming.reply(key, *incoming.raw.answer(reply))
        incoming.finish()

    def _preview(self, raw: RawQuery) -> PreviewReply:
        query = query_forms.read_motion_or_pose(raw)
        controller = self._controller
        if controller.access.following:
            raise Refused(Reason.FOLLOWING)
        goal = controller.planner.goal(query, controller.board.ready_telemetry(), controller.last_goal)
        if goal.duration > PREVIEW_MAX_S:
            raise Refused(
                Reason.TIMED_OUT,
                detail=Detail(limit=Limit.DURATION, value=goal.duration, high=PREVIEW_MAX_S, unit="s"),
            )
        return self._carry_out(goal.frame(0))

    def close(self) -> None:
        """Refuse the waiting previews, finish the running one, and end the thread."""
        self._closed = True
        super().close()


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
