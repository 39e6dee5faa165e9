"""Previews of motions: their queries, and the same firmware and physics on copies, faster than real time.

A thread of its own answers, so that previews never delay the robot.
"""

from __future__ import annotations

import math
import queue
import threading
from collections.abc import Callable
from typing import Final

from beatrix_zenoh import threads
from beatrix_zenoh.board.link import Decoder, SerialFrame, encode
from beatrix_zenoh.board.virtual import Firmware
from beatrix_zenoh.bus import Incoming, Sessions, query_forms
from beatrix_zenoh.bus.query_forms import RawQuery
from beatrix_zenoh.contract import refusals
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import Detail, Head, Limit, PreviewReply, Reason
from beatrix_zenoh.contract._generated.serial import (
    HEARTBEAT_PERIOD,
    BoardOutcome,
    BoardState,
    Error,
    FrameType,
    Move,
    MoveStraight,
    Telemetry,
)
from beatrix_zenoh.contract.errors import BeatrixError, Refused
from beatrix_zenoh.motion.gear import Arms
from beatrix_zenoh.node import Component
from beatrix_zenoh.node.controller import MotionController
from beatrix_zenoh.node.planner import vector
from beatrix_zenoh.node.requests import own_key, seat_of
from sim_node.model import TIMESTEP_MS
from sim_node.plant import Plant

PREVIEW_MAX_S = 60.0
"""Longest duration (s) of a motion in a preview."""


LONGEST_MS: Final = round(PREVIEW_MAX_S * 1000)
"""Longest preview (simulated ms), in case the firmware takes longer than was computed before."""
SAMPLES_MAX: Final = 300
"""Largest number of samples; then every second one is dropped, and the sample rate is halved."""
_SAMPLE_MS: Final = 20
_CHUNK_MS: Final = 20
"""Simulated time between two readings of the firmware's output."""
_SETTLE_MS: Final = 1000
"""Longest wait until the arms rest after the firmware's last step."""
_AT_REST: Final = math.radians(0.2)
"""Arms below this velocity (rad/s) are at rest."""
_SEQ_MOVE: Final = 1
_SEQ_PING: Final = 2


def simulate_motion(plant: Plant, firmware: Firmware, move: Move | MoveStraight) -> PreviewReply:
    """Carry out a motion until the arms rest, as fast as this computer can, and return the reply with its samples.

    This changes `plant` and `firmware`, which must be copies. Raises Refused if the firmware refuses the motion, stops
    it before its end, or needs more than LONGEST_MS, or if the neck would leave its home assembly.
    """
    run = _MotionSimulation(plant, firmware)
    run.send(move.kind, _SEQ_MOVE, move.pack())
    while not run.at_rest():
        if run.now_ms >= LONGEST_MS:
            raise Refused(
                Reason.TIMED_OUT,
                f"This motion takes longer than {LONGEST_MS / 1000:.0f} s, the longest preview: "
                "use a higher speed or a shorter motion.",
            )
        run.advance()
    return run.result()


class _MotionSimulation:
    """The simulation of one motion."""

    def __init__(self, plant: Plant, firmware: Firmware) -> None:
        self.now_ms = 0
        self._plant, self._firmware = plant, firmware
        self._decoder = Decoder()
        self._telemetry: Telemetry | None = None
        self._stopped_ms: int | None = None
        self._next_ping_ms = HEARTBEAT_PERIOD
        self._tilt_max = plant.tilt()
        self._gap_min = plant.gap()
        self._period_ms = _SAMPLE_MS
        self._samples: list[tuple[int, Arms, Arms]] = [(0, plant.arms(), plant.head())]
        # Discard the output from before the copy was made.
        firmware.transmit()

    def send(self, kind: FrameType, seq: int, payload: bytes = b"") -> None:
        """Send a frame to the firmware and read its answer."""
        self._firmware.receive(encode(kind, seq, payload))
        self._read_frames()

    def advance(self) -> None:
        """Advance simulated time by one chunk."""
        if self.now_ms >= self._next_ping_ms:
            self.send(FrameType.PING, _SEQ_PING)
            self._next_ping_ms += HEARTBEAT_PERIOD
        plant, firmware = self._plant, self._firmware
        tilt_max, gap_min = self._tilt_max, self._gap_min
        firmware.tick(_CHUNK_MS)
        for pulses, drivers_on, count in firmware.motors(_CHUNK_MS, TIMESTEP_MS):
            for _ in range(count):
                plant.step(pulses, drivers_on=drivers_on)
                tilt_max = max(tilt_max, plant.tilt())
                gap_min = min(gap_min, plant.gap())
        self._tilt_max, self._gap_min = tilt_max, gap_min
        self.now_ms += _CHUNK_MS
        if self.now_ms % self._period_ms == 0:
            self._sample()
        if plant.home_assembly_left():
            raise Refused(
                Reason.FAULT,
                "During this motion the neck would snap out of its home assembly: choose another motion.",
            )
        self._read_frames()

    def at_rest(self) -> bool:
        """Return whether the firmware has made its last step, and the arms rest or _SETTLE_MS have passed since."""
        telemetry = self._telemetry
        if telemetry is None or telemetry.state & BoardState.MOVING:
            return False
        if self._stopped_ms is None:
            self._stopped_ms = self.now_ms
        waited = self.now_ms - self._stopped_ms >= _SETTLE_MS
        return waited or max(map(abs, self._plant.velocities())) < _AT_REST

    def result(self) -> PreviewReply:
        """Return the samples of the motion up to its end; raises Refused if the firmware stopped it."""
        outcome = BoardOutcome.DONE if self._telemetry is None else BoardOutcome(self._telemetry.outcome)
        if outcome is not BoardOutcome.DONE:
            raise Refused(outcome.reason, f"The firmware would end this motion {outcome.text}.")
        if self._samples[-1][0] != self.now_ms:
            self._sample()
        duration_s = self.now_ms / 1000
        return PreviewReply(
            result=True,
            reason=Reason.OK,
            message=f"Possible: {duration_s:.1f} s.",
            duration=duration_s,
            tilt_max=self._tilt_max,
            gap_min=self._gap_min,
            t=[t / 1000 for t, _, _ in self._samples],
            arms=[vector(arms) for _, arms, _ in self._samples],
            head=[Head(*head) for _, _, head in self._samples],
        )

    def _sample(self) -> None:
        if len(self._samples) >= SAMPLES_MAX:
            del self._samples[1::2]
            self._period_ms *= 2
        self._samples.append((self.now_ms, self._plant.arms(), self._plant.head()))

    def _read_frames(self) -> None:
        for frame in self._decoder.feed(self._firmware.transmit()):
            if frame.type == FrameType.TELEMETRY:
                self._telemetry = Telemetry.unpack(frame.payload)
            elif FrameType.ACK <= frame.type < FrameType.TELEMETRY and frame.seq == _SEQ_MOVE:
                _check(frame)


def _check(ack: SerialFrame) -> None:
    error = Error(ack.payload[0])
    if error is not Error.OK:
        raise Refused(error.reason, f"The firmware refuses this motion: {error.text}.")


CAPACITY: Final = 8
"""Largest number of waiting previews; further ones are refused."""


class PreviewHandler(Component):
    """Answers preview queries one after the other."""

    def __init__(
        self,
        name: str,
        controller: MotionController,
        carry_out: Callable[[Move | MoveStraight], PreviewReply],
    ) -> None:
        """Store `carry_out`, which runs a motion on a copy of the robot and may raise BeatrixError."""
        self._key, self._controller, self._carry_out = keys.preview(name, "*"), controller, carry_out
        self._waiting: queue.Queue[Incoming | None] = queue.Queue(maxsize=CAPACITY)
        self._thread: threading.Thread | None = None

    def start(self, sessions: Sessions) -> None:
        self._thread = threads.start(self._run, "preview")
        sessions.serve(self._key, self._query)

    def _query(self, incoming: Incoming) -> None:
        """Queue a query, on Zenoh's thread; refuse it if the queue is full."""
        try:
            self._waiting.put_nowait(incoming)
        except queue.Full:
            self._reply(incoming, preview_refusal(refusals.queue_full(CAPACITY)))

    def _reply(self, incoming: Incoming, reply: PreviewReply) -> None:
        key = own_key(self._key, seat_of(incoming.key, self._key))
        incoming.reply(key, *incoming.raw.answer(reply))
        incoming.finish()

    def _run(self) -> None:
        while (incoming := self._waiting.get()) is not None:
            try:
                reply = self._preview(incoming.raw)
            except BeatrixError as error:
                reply = preview_refusal(error)
            self._reply(incoming, reply)

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
        while not self._waiting.empty():
            try:
                incoming = self._waiting.get_nowait()
            except queue.Empty:
                break
            if incoming is not None:
                self._reply(incoming, preview_refusal(Refused(Reason.SHUTDOWN)))
        self._waiting.put(None)
        if self._thread is not None:
            self._thread.join(timeout=2.0)


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
