"""Trying a motion on a copy: the very firmware and the same physics, ahead of time."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Final

from beatrix_zenoh._generated.messages import Reason
from beatrix_zenoh._generated.serial import (
    ERROR_REASON,
    ERROR_TEXT,
    HEARTBEAT_PERIOD,
    OUTCOME_REASON,
    OUTCOME_TEXT,
    Error,
    FrameType,
    Move,
    MoveStraight,
    Outcome,
    State,
    Telemetry,
)
from beatrix_zenoh.board.link import Decoder, Frame, encode
from beatrix_zenoh.board.virtual import Firmware
from beatrix_zenoh.drive import Arms
from beatrix_zenoh.errors import Interrupted, Refused
from beatrix_zenoh.node.body import PREVIEW_MAX_S, Preview
from sim_node.model import TIMESTEP_MS
from sim_node.plant import Plant

LONGEST_MS: Final = round(PREVIEW_MAX_S * 1000)
"""Longest motion that is tried (simulated ms), should the firmware take longer than was computed."""
SAMPLES_MAX: Final = 300
"""Then every second sample is dropped and the rest go on at half the rate."""
_SAMPLE_MS: Final = 20
_CHUNK_MS: Final = 20
"""Between two looks at what the firmware says and whether anybody still waits."""
_SETTLE_MS: Final = 1000
"""Longest wait for the arms after the firmware's last step."""
_AT_REST: Final = math.radians(0.2)
"""Arms slower than this (rad/s) rest."""
_SEQ_MOVE: Final = 1
_SEQ_PING: Final = 2


def run_ahead(
    plant: Plant, firmware: Firmware, move: Move | MoveStraight, cancelled: Callable[[], bool] = lambda: False
) -> Preview:
    """Carry out a motion until the arms rest, as fast as the machine can, and say how it went.

    `plant` and `firmware` are copies made for this: they end where the motion ends. Raises Refused if the
    firmware refuses the motion, would stop it on its way, or needs more than LONGEST_MS; Interrupted
    if `cancelled` says so.
    """
    run = _Run(plant, firmware)
    run.send(move.kind, _SEQ_MOVE, move.pack())
    while not run.at_rest():
        if cancelled():
            raise Interrupted(Reason.STOPPED, "The preview was cancelled; nothing has moved.")
        if run.now_ms >= LONGEST_MS:
            raise Refused(
                Reason.TIMED_OUT,
                f"This motion takes longer than the {LONGEST_MS / 1000:.0f} s a preview looks ahead: "
                "ask for a higher speed or a shorter way.",
            )
        run.advance()
    return run.result()


class _Run:
    """One motion on its way, in simulated time."""

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
        # What the original has sent before the copy was made is not about this motion.
        firmware.transmit()

    def send(self, kind: FrameType, seq: int, payload: bytes = b"") -> None:
        """Give a frame to the firmware and read its answer."""
        self._firmware.receive(encode(kind, seq, payload))
        self._listen()

    def advance(self) -> None:
        """Let a chunk of time pass."""
        if self.now_ms >= self._next_ping_ms:
            self.send(FrameType.PING, _SEQ_PING)
            self._next_ping_ms += HEARTBEAT_PERIOD
        plant, firmware = self._plant, self._firmware
        tilt_max, gap_min = self._tilt_max, self._gap_min
        for _ in range(_CHUNK_MS // TIMESTEP_MS):
            firmware.tick(TIMESTEP_MS)
            pulses, drivers_on = firmware.outputs()
            plant.step(pulses, drivers_on=drivers_on)
            tilt_max = max(tilt_max, plant.tilt())
            gap_min = min(gap_min, plant.gap())
        self._tilt_max, self._gap_min = tilt_max, gap_min
        self.now_ms += _CHUNK_MS
        if self.now_ms % self._period_ms == 0:
            self._sample()
        if plant.home_assembly_left():
            raise Refused(
                Reason.FAULT, "On this way the neck would snap out of its home assembly: choose another."
            )
        self._listen()

    def at_rest(self) -> bool:
        """Whether the firmware makes no more steps and the arms have come to rest."""
        telemetry = self._telemetry
        if telemetry is None or telemetry.state & State.MOVING:
            return False
        if self._stopped_ms is None:
            self._stopped_ms = self.now_ms
        waited = self.now_ms - self._stopped_ms >= _SETTLE_MS
        return waited or max(map(abs, self._plant.velocities())) < _AT_REST

    def result(self) -> Preview:
        """How it went; the last sample is the end. Raises Refused if the firmware stopped it."""
        outcome = Outcome.DONE if self._telemetry is None else Outcome(self._telemetry.outcome)
        if outcome is not Outcome.DONE:
            raise Refused(
                OUTCOME_REASON[outcome], f"The firmware would end this motion {OUTCOME_TEXT[outcome]}."
            )
        if self._samples[-1][0] != self.now_ms:
            self._sample()
        return Preview(
            duration_s=self.now_ms / 1000,
            tilt_max=self._tilt_max,
            gap_min=self._gap_min,
            t=[t / 1000 for t, _, _ in self._samples],
            arms=[arms for _, arms, _ in self._samples],
            head=[head for _, _, head in self._samples],
        )

    def _sample(self) -> None:
        if len(self._samples) >= SAMPLES_MAX:
            del self._samples[1::2]
            self._period_ms *= 2
        self._samples.append((self.now_ms, self._plant.arms(), self._plant.head()))

    def _listen(self) -> None:
        for frame in self._decoder.feed(self._firmware.transmit()):
            if frame.type == FrameType.TELEMETRY:
                self._telemetry = Telemetry.unpack(frame.payload)
            elif FrameType.ACK <= frame.type < FrameType.TELEMETRY and frame.seq == _SEQ_MOVE:
                _check(frame)


def _check(ack: Frame) -> None:
    error = Error(ack.payload[0])
    if error is not Error.OK:
        raise Refused(ERROR_REASON[error], f"The firmware refuses this motion: {ERROR_TEXT[error]}.")
