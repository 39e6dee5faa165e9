"""A program of 2023 at the text port, in virtual time.

It opens the board itself, or is behind a node that forwards its lines.
"""

from __future__ import annotations

from typing import Final

from firmware_host import Core, Steps

from beatrix_zenoh.board.link import Decoder, SerialFrame, encode
from beatrix_zenoh.board.virtual import Firmware
from beatrix_zenoh.contract._generated.serial import (
    FrameType,
    Telemetry,
    Text,
    TextWarning,
    WarningCode,
)

BYTE_MS: Final = 10 / 9.6
"""Time of a byte (ms) at 9600 baud."""
HEARTBEAT_MS: Final = 100
LOOK_MS: Final = 10
"""Default time (ms) between two polls of the replies; a poll takes longer than the simulation of this time."""
LAST: Final = 1
ACK, NACK = "ACK\n", "NACK\n"
DONE, REFUSED, UNKNOWN = [ACK, ACK], [ACK, NACK], [NACK]


class Program:
    """Sends lines and collects the reply lines with their times in ms, rounded up to the next poll.

    `framed`: behind a host that always sends frames; then flags, warnings and telemetry are collected as well.
    `look_ms`: time between two polls (ms), a divisor of HEARTBEAT_MS.
    """

    def __init__(self, core: Core | None = None, *, framed: bool = False, look_ms: int = LOOK_MS) -> None:
        self.core: Core = core or Firmware()
        self.framed = framed
        self.look_ms = look_ms
        self.ms = 0
        self.lines: list[tuple[int, str]] = []
        self.flags: list[int] = []
        self.warnings: list[WarningCode] = []
        self.telemetry: list[Telemetry] = []
        self.others: list[SerialFrame] = []
        self._decoder = Decoder()
        self._rest = b""
        self._read = 0
        if framed:
            self.frame(FrameType.PING)

    def send(self, data: bytes) -> None:
        """Send bytes unchanged."""
        self.core.receive(data)
        self._look()

    def say(self, *lines: str) -> list[str]:
        """Send lines and wait until an idle board has answered them; return the new lines."""
        for line in lines:
            self.send(line.encode("ascii") + b"\r")
        self.tick(5)
        return self.new()

    def frame(self, kind: FrameType, payload: bytes = b"") -> None:
        """Send a frame, as a host with frames does."""
        self.send(encode(kind, 1, payload))

    def ready(self) -> Program:
        """Send the lines with which programs of 2023 begin."""
        assert self.say("@ENMOTORS ON", "@CALNOW") == DONE * 2
        return self

    def run(self, line: str, limit_ms: int = 60_000) -> list[str]:
        """Send a line and wait for both replies; return the new lines."""
        self.send(line.encode("ascii") + b"\r")
        end_ms = self.ms + limit_ms
        while len(self.lines) - self._read < 2 and self.ms < end_ms:
            self.tick(self.look_ms)
        return self.new()

    def new(self) -> list[str]:
        """Return the lines since the last call."""
        found = [line for _, line in self.lines[self._read :]]
        self._read = len(self.lines)
        return found

    def tick(self, ms: int = 1) -> None:
        """Let time pass (ms); a host with frames sends heartbeats meanwhile."""
        end_ms = self.ms + ms
        while self.ms < end_ms:
            pause_ms = min(self.look_ms - self.ms % self.look_ms, end_ms - self.ms)
            self.ms += pause_ms
            self.core.tick(pause_ms)
            if self.framed and self.ms % HEARTBEAT_MS == 0:
                self.core.receive(encode(FrameType.PING, 1, b""))
            self._look()

    @property
    def position(self) -> Steps:
        """The position that the port reports to the program."""
        self.new()
        ack, empty, numbers, done = self.say("@GETALLPOS")
        assert (ack, empty, done) == (ACK, "\n", ACK)
        x, y, z = (int(number) for number in numbers.split(" "))
        return x, y, z

    def _look(self) -> None:
        sent = self.core.transmit()
        if not self.framed:
            *lines, self._rest = (self._rest + sent).split(b"\n")
            self.lines += [(self.ms, line.decode("ascii") + "\n") for line in lines]
            return
        for frame in self._decoder.feed(sent):
            if frame.type == FrameType.TEXT:
                text = Text.unpack(frame.payload)
                self.lines.append((self.ms, text.text.decode("ascii")))
                self.flags.append(text.flags)
            elif frame.type == FrameType.TEXT_WARNING:
                self.warnings.append(WarningCode(TextWarning.unpack(frame.payload).code))
            elif frame.type == FrameType.TELEMETRY:
                self.telemetry.append(Telemetry.unpack(frame.payload))
            else:
                self.others.append(frame)
        assert self._decoder.rejected == 0
