"""Firmware and plant in virtual time, as fast as this computer can: for previews, and for the bench of lessons."""

from __future__ import annotations

from beatrix_zenoh.board.link import Decoder, encode
from beatrix_zenoh.board.virtual import Firmware
from beatrix_zenoh.contract._generated.serial import (
    HEARTBEAT_PERIOD,
    Error,
    FrameType,
    Telemetry,
)
from beatrix_zenoh.contract.errors import Refused
from sim_node.model import TIMESTEP_MS
from sim_node.plant import Plant

CHUNK_MS = 20
"""Virtual time of a step, as between two positions of a robot."""
_SEQ_ASK, _SEQ_PING = 1, 2


class VirtualTime:
    """A firmware that drives a plant and hears a heartbeat; no thread, no clock."""

    def __init__(self, plant: Plant, firmware: Firmware) -> None:
        self.plant, self.firmware = plant, firmware
        self.now_ms = 0
        self.telemetry: Telemetry | None = None
        self._decoder = Decoder()
        firmware.transmit()  # what was sent before is discarded

    def send(self, kind: FrameType, payload: bytes = b"") -> None:
        """Send a frame to the firmware; raises Refused if the firmware refuses it."""
        self.firmware.receive(encode(kind, _SEQ_ASK, payload))
        self._read()

    def advance(self) -> None:
        """Let CHUNK_MS pass."""
        if self.now_ms % HEARTBEAT_PERIOD == 0:
            self.firmware.receive(encode(FrameType.PING, _SEQ_PING, b""))
        self.firmware.tick(CHUNK_MS)
        for pulses, drivers_on, count in self.firmware.motors(CHUNK_MS, TIMESTEP_MS):
            self.plant.step(pulses, drivers_on=drivers_on, count=count)
        self.now_ms += CHUNK_MS
        self._read()

    def _read(self) -> None:
        for frame in self._decoder.feed(self.firmware.transmit()):
            if frame.type == FrameType.TELEMETRY:
                self.telemetry = Telemetry.unpack(frame.payload)
            elif FrameType.ACK <= frame.type < FrameType.TELEMETRY and frame.seq == _SEQ_ASK:
                error = Error(frame.payload[0])
                if error is not Error.OK:
                    raise Refused(error.reason, f"The firmware refuses this motion: {error.text}.")
