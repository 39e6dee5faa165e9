"""Preview of a motion: the same firmware and physics, on copies, faster than real time."""

from __future__ import annotations

import math
from typing import Final

from beatrix_zenoh.board.link import Decoder, SerialFrame, encode
from beatrix_zenoh.board.virtual import Firmware
from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract._generated.serial import (
    ERROR_REASON,
    ERROR_TEXT,
    HEARTBEAT_PERIOD,
    OUTCOME_REASON,
    OUTCOME_TEXT,
    BoardOutcome,
    BoardState,
    Error,
    FrameType,
    Move,
    MoveStraight,
    Telemetry,
)
from beatrix_zenoh.contract.errors import Refused
from beatrix_zenoh.motion.gear import Arms
from beatrix_zenoh.node.interfaces import PREVIEW_MAX_S, Preview
from sim_node.model import TIMESTEP_MS
from sim_node.plant import Plant

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


def simulate_motion(plant: Plant, firmware: Firmware, move: Move | MoveStraight) -> Preview:
    """Carry out a motion until the arms rest, as fast as this computer can, and return its samples.

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
        for _ in range(_CHUNK_MS // TIMESTEP_MS):
            firmware.tick(TIMESTEP_MS)
            plant.step(firmware.pulses(), drivers_on=firmware.drivers_on())
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

    def result(self) -> Preview:
        """Return the samples of the motion up to its end; raises Refused if the firmware stopped it."""
        outcome = BoardOutcome.DONE if self._telemetry is None else BoardOutcome(self._telemetry.outcome)
        if outcome is not BoardOutcome.DONE:
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

    def _read_frames(self) -> None:
        for frame in self._decoder.feed(self._firmware.transmit()):
            if frame.type == FrameType.TELEMETRY:
                self._telemetry = Telemetry.unpack(frame.payload)
            elif FrameType.ACK <= frame.type < FrameType.TELEMETRY and frame.seq == _SEQ_MOVE:
                _check(frame)


def _check(ack: SerialFrame) -> None:
    error = Error(ack.payload[0])
    if error is not Error.OK:
        raise Refused(ERROR_REASON[error], f"The firmware refuses this motion: {ERROR_TEXT[error]}.")
