"""A firmware under test in virtual time, and a host that sends requests to it."""

from __future__ import annotations

import random
from pathlib import Path
from typing import Protocol

from beatrix_zenoh.board.link import Decoder, SerialFrame, encode
from beatrix_zenoh.board.virtual import Firmware
from beatrix_zenoh.contract._generated.robot import ROBOT
from beatrix_zenoh.contract._generated.serial import (
    BoardOutcome,
    BoardState,
    Enable,
    Error,
    FrameType,
    Move,
    MoveStraight,
    Telemetry,
)

ROOT = Path(__file__).resolve().parents[2]
_TURN = ROBOT.drive.full_steps * ROBOT.drive.microsteps * ROBOT.drive.gear_ring / ROBOT.drive.gear_pinion
ARM_TURN = round(_TURN)
ARM_SPACING = round(_TURN / 3)
GAP_MIN = round(_TURN / 360 * ROBOT.limits.guard_gap_min)
YAW_SUM_MAX = int(3 * _TURN / 360 * ROBOT.limits.guard_yaw_max)
SPEED_MAX = 4189
"""Quarter microsteps per second."""
ACCELERATION = _TURN / 360 * ROBOT.limits.acceleration / 1e6
"""Microsteps per tick, per tick."""
KEEP_ALIVE_MS = 400

Steps = tuple[int, int, int]


class Core(Protocol):
    """The interface of a compiled firmware, the same for every target."""

    def receive(self, data: bytes) -> None: ...
    def transmit(self) -> bytes: ...
    def tick(self, ms: int) -> None: ...
    def steps(self) -> Steps: ...


class Rig:
    """The host of a firmware: sends frames, and checks every reply and telemetry frame."""

    def __init__(self, core: Core | None = None) -> None:
        self.core = core or Firmware()
        self.telemetry: list[Telemetry] = []
        self.others: list[SerialFrame] = []
        self._decoder = Decoder()
        self._seq = 0
        self.motion = 0
        self.raw(encode(FrameType.HELLO, 0, b""))

    def ask(self, kind: int, payload: bytes = b"") -> Error:
        """Send a request and return its acknowledgement, which must arrive before `receive` returns."""
        self._seq = self._seq % 255 + 1
        self.others.clear()
        self.core.receive(encode(kind, self._seq, payload))
        self._look()
        (reply,) = self.others
        assert (reply.type, reply.seq, len(reply.payload)) == (kind | 0x80, self._seq, 1)
        return Error(reply.payload[0])

    def enable(self, value: int = 1) -> Error:
        """Send ENABLE."""
        return self.ask(FrameType.ENABLE, Enable(value).pack())

    def ready(self) -> Rig:
        """Enable and calibrate the board."""
        assert self.enable() == Error.OK
        assert self.ask(FrameType.CALIBRATE) == Error.OK
        return self

    def move(
        self,
        target: Steps,
        speed: Steps | int = SPEED_MAX,
        *,
        straight: bool = False,
        motion: int | None = None,
    ) -> Error:
        """Send MOVE, or MOVE_STRAIGHT with the first speed; the default motion number is the next one."""
        self.motion = (self.motion + 1) % 65536 if motion is None else motion
        speeds = (speed, speed, speed) if isinstance(speed, int) else speed
        move = MoveStraight(self.motion, target, speeds[0]) if straight else Move(self.motion, target, speeds)
        return self.ask(move.kind, move.pack())

    def raw(self, data: bytes) -> list[SerialFrame]:
        """Send bytes unchanged; return all received frames but telemetry."""
        self.others.clear()
        self.core.receive(data)
        self._look()
        return list(self.others)

    def tick(self, ms: int = 1) -> None:
        """Let this many milliseconds pass, and read the frames sent meanwhile."""
        self.core.tick(ms)
        self._look()

    def run(self, limit_ms: int = 60_000) -> None:
        """Let time pass until the arms rest, at most `limit_ms`, with heartbeats."""
        while BoardState.MOVING in self.state:
            assert limit_ms > 0, self.last
            self.ask(FrameType.PING)
            self.tick(KEEP_ALIVE_MS)
            limit_ms -= KEEP_ALIVE_MS

    @property
    def last(self) -> Telemetry:
        """Newest telemetry."""
        return self.telemetry[-1]

    @property
    def state(self) -> BoardState:
        """State bits of the newest telemetry, which comes with every change."""
        return BoardState(self.last.state)

    @property
    def outcome(self) -> BoardOutcome:
        """Outcome of the last motion."""
        return BoardOutcome(self.last.outcome)

    @property
    def steps(self) -> Steps:
        """Set points in whole microsteps."""
        return self.core.steps()

    def _look(self) -> None:
        sent = self.core.transmit()
        if not sent:
            return
        for frame in self._decoder.feed(sent):
            if frame.type == FrameType.TELEMETRY:
                self.telemetry.append(Telemetry.unpack(frame.payload))
            else:
                self.others.append(frame)
        assert self._decoder.rejected == 0


def least_gap(steps: Steps) -> int:
    """Return the smallest gap between neighbouring arms (microsteps)."""
    x, y, z = steps
    last = ARM_TURN - 2 * ARM_SPACING
    return min(ARM_SPACING + y - x, ARM_SPACING + z - y, last + x - z)


def damaged(wire: bytes, chance: random.Random) -> bytes:
    """Return the bytes with one to three errors: flipped bits, and missing, added or replaced bytes."""
    data = bytearray(wire)
    for _ in range(chance.randint(1, 3)):
        at = chance.randrange(len(data))
        match chance.randrange(4):
            case 0:
                data[at] ^= 1 << chance.randrange(8)
            case 1:
                del data[at]
            case 2:
                data.insert(at, chance.randrange(256))
            case _:
                data[at : at + 4] = chance.randbytes(chance.randint(0, 6))
    return bytes(data)
