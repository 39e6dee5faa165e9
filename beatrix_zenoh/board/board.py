"""The board behind a node: requests with time-outs and retries, telemetry, heartbeat, reconnection."""

from __future__ import annotations

import contextlib
import queue
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

from beatrix_zenoh import threads
from beatrix_zenoh._generated import serial as wire
from beatrix_zenoh._generated.messages import Reason
from beatrix_zenoh._generated.serial import (
    ERROR_REASON,
    ERROR_TEXT,
    Error,
    FrameType,
    HelloReply,
    Move,
    MoveStraight,
    Telemetry,
    Text,
    TextWarning,
)
from beatrix_zenoh.board.greeting import Greeting
from beatrix_zenoh.board.link import Decoder, Frame, encode
from beatrix_zenoh.errors import BeatrixError, NoAnswer, Refused

STOPS = (FrameType.STOP, FrameType.EMERGENCY_STOP)
READ_S = 0.05
REOPEN_S = 0.3
REPLY_S = wire.REPLY_TIMEOUT / 1000
HEARTBEAT_S = wire.HEARTBEAT_PERIOD / 1000
SILENT = "; is it powered?"
NEVER_HEARD = ": is that the board's port, and is BEATRIX's firmware on the board? `beatrix flash` puts it there (end this first)."
LOST_S = 0.4
"""Silence after which the board counts as lost; with the loop's period this stays under 0.5 s."""


class Port(Protocol):
    """Bytes to and from a board."""

    @property
    def name(self) -> str:
        """What people call it: a device path, or `virtual:`."""

    @property
    def boot_s(self) -> float:
        """How long a board needs to start, which opening the port may have reset, s."""

    def write(self, data: bytes) -> None:
        """Send all of it; OSError if the port has gone."""

    def read(self, timeout_s: float) -> bytes:
        """What has come, waiting up to `timeout_s` for the first byte; OSError if the port has gone."""

    def close(self) -> None:
        """Free the device; wakes a reader."""


@dataclass(frozen=True)
class Link:
    """What is known of the board now."""

    port: str
    connected: bool
    trouble: str
    """Why the port cannot be opened, what firmware is there instead of ours, or that the board is silent; else empty."""
    hello: HelloReply | None
    rejected: int
    retries: int
    reset: bool
    """It was lost because it was reset."""

    @property
    def name(self) -> str:
        """Robot name the board keeps, empty if none."""
        return "" if self.hello is None else self.hello.name.rstrip(b"\0").decode("ascii", "replace")

    @property
    def version(self) -> str:
        """Firmware version, empty if unknown."""
        return "" if self.hello is None else ".".join(map(str, self.hello.version))

    @property
    def boot(self) -> int:
        """How often the board was started, 0 if unknown."""
        return 0 if self.hello is None else self.hello.boot

    @property
    def understood(self) -> bool:
        """The firmware speaks this contract."""
        return self.hello is not None and ours(self.hello)

    @property
    def foreign(self) -> bool:
        """The firmware speaks another contract."""
        return self.hello is not None and not self.understood


class Board:
    """A board on a port that may come and go.

    `on_telemetry` is called on the board's own thread for every TELEMETRY, `on_link` whenever the
    board was found or lost, `on_text` for every line of text the board sends, with its seq; all must be quick and must not
    call back into the board.
    """

    def __init__(
        self,
        open_port: Callable[[], Port],
        on_telemetry: Callable[[Telemetry], None],
        on_link: Callable[[], None],
        on_text: Callable[[int, Text | TextWarning], None] = lambda *_: None,
    ) -> None:
        self._open_port = open_port
        self._on_text = on_text
        self._on_telemetry = on_telemetry
        self._on_link = on_link
        self._lock = threading.Lock()
        self._news = threading.Condition()
        self._pending: dict[tuple[int, int], queue.SimpleQueue[int]] = {}
        self._port: Port | None = None
        self._port_name = self._trouble = ""
        self._decoder = Decoder()
        self._hello: HelloReply | None = None
        self._telemetry: Telemetry | None = None
        self._connected = self._reset = False
        self._greeting = Greeting(0.0, 0.0)
        self._silent_s = self._sent_s = 0.0
        self._seq = 0
        self._retries = 0
        self._closed = threading.Event()
        self._thread: threading.Thread | None = None

    def start(self) -> None:
        """Open the port and begin to listen; the callbacks run from here on."""
        self._thread = threads.start(self._run, "board")

    # -- state ----------------------------------------------------------------------------------

    @property
    def link(self) -> Link:
        """The connection as it is now."""
        hello, trouble = self._hello, self._trouble
        if not trouble and not self._connected:
            if hello is not None and not ours(hello):
                trouble = mismatch_text(hello)
            else:
                trouble = (
                    f"{self._port_name or 'The port'} is silent{SILENT if self._telemetry else NEVER_HEARD}"
                )
        rejected = self._decoder.rejected
        return Link(self._port_name, self._connected, trouble, hello, rejected, self._retries, self._reset)

    @property
    def connected(self) -> bool:
        """As in `link`, without the rest of it."""
        return self._connected

    @property
    def telemetry(self) -> Telemetry | None:
        """The newest telemetry; None before the first."""
        return self._telemetry

    @property
    def state(self) -> int:
        """State bits of the newest telemetry, 0 before the first."""
        telemetry = self._telemetry
        return 0 if telemetry is None else telemetry.state

    def wait_for(self, holds: Callable[[Telemetry], bool], timeout_s: float) -> bool:
        """Wait until telemetry fulfils `holds`; False if it does not within `timeout_s`."""
        with self._news:
            return self._news.wait_for(
                lambda: self._telemetry is not None and holds(self._telemetry), timeout=timeout_s
            )

    # -- requests -------------------------------------------------------------------------------

    def move(self, move: Move | MoveStraight) -> None:
        """Begin a motion; raises as `request`."""
        self.request(move.kind, move.pack())

    def enable(self, *, on: bool) -> None:
        """Switch the motors; raises as `request`."""
        self.request(FrameType.ENABLE, bytes([on]))

    def send_text(self, line: bytes) -> None:
        """Pass a line of text on, without its end; raises NoAnswer: BOARD_LOST or CONTRACT_MISMATCH."""
        self.check_heard()
        self._put(line + b"\r")

    def check_heard(self) -> None:
        """Raise NoAnswer (BOARD_LOST or CONTRACT_MISMATCH) unless the board is heard and understood."""
        if not self._connected:
            raise unheard(self.link)

    def request(self, kind: FrameType, payload: bytes = b"") -> None:
        """Send a request and wait for its acknowledgement; asks again if it is lost.

        Raises:
            Refused: the firmware said no.
            NoAnswer: BOARD_LOST or CONTRACT_MISMATCH.
        """
        if kind not in STOPS:  # whatever contract it speaks, it may know these two
            self._check_contract()
        slot: queue.SimpleQueue[int] = queue.SimpleQueue()
        with self._lock:
            self._seq = seq = self._seq % 255 + 1
            self._pending[kind | FrameType.ACK, seq] = slot
        frame = encode(kind, seq, payload)
        try:
            for attempt in range(wire.TRIES):
                self._retries += attempt > 0
                self._write(frame)
                if self._hello is None:
                    self._greeting.spoken(time.monotonic())
                with contextlib.suppress(queue.Empty):
                    self._judge(kind, slot.get(timeout=REPLY_S))
                    return
        finally:
            self._pending.pop((kind | FrameType.ACK, seq), None)
        raise NoAnswer(
            Reason.BOARD_LOST,
            f"The board at {self._port_name or 'its port'} does not answer: is it plugged in and powered?",
        )

    @staticmethod
    def _judge(kind: FrameType, code: int) -> None:
        if code == Error.OK:
            return
        if code not in ERROR_REASON:
            raise Refused(
                Reason.CONTRACT_MISMATCH, f"The firmware answered {kind.name} with unknown error {code}."
            )
        error = Error(code)
        raise Refused(ERROR_REASON[error], f"The firmware refused {kind.name}: {ERROR_TEXT[error]}.")

    @property
    def _understood(self) -> bool:
        hello = self._hello
        return hello is not None and ours(hello)

    def _check_contract(self) -> None:
        if not self._understood:
            raise unheard(self.link)

    def _write(self, frame: bytes) -> None:
        self._put(frame)
        self._sent_s = time.monotonic()  # only frames are a heartbeat, text is none

    def _put(self, data: bytes) -> None:
        port = self._port
        if port is None:
            raise unheard(self.link)
        try:
            port.write(data)
        except OSError as error:
            raise NoAnswer(Reason.BOARD_LOST, f"The board at {port.name} has gone ({error}).") from error

    # -- the board's own thread -----------------------------------------------------------------

    def _run(self) -> None:
        while not self._closed.is_set():
            try:
                port = self._open_port()
            except (OSError, BeatrixError) as error:
                self._trouble = str(error)
                self._closed.wait(REOPEN_S)
                continue
            self._port, self._port_name, self._decoder = port, port.name, Decoder()
            self._trouble = ""
            self._silent_s = 0.0
            self._greeting = Greeting(time.monotonic(), port.boot_s)
            with contextlib.suppress(OSError, NoAnswer):
                self._talk(port)
            self._port = self._hello = None
            self._reset = False
            self._set_connected(connected=False)
            port.close()
            self._closed.wait(0 if self._closed.is_set() else REOPEN_S)

    def _talk(self, port: Port) -> None:
        while not self._closed.is_set():
            self._keep_in_touch(time.monotonic())
            for frame in self._decoder.feed(self._listen(port)):
                self._silent_s = 0.0
                self._receive(frame)
                if self._hello is None:
                    self._greeting.heard()
            if self._silent_s > LOST_S and (self._connected or self._hello is not None):
                self._lose_sight(reset=False)

    def _keep_in_touch(self, now: float) -> None:
        if not self._understood:
            if self._greeting.due(now):
                self._greeting.said(now, stranger=self._hello is not None)
                self._write(encode(FrameType.HELLO, 0, b""))
        elif now - self._sent_s > HEARTBEAT_S:
            self._write(encode(FrameType.PING, 0, b""))

    def _lose_sight(self, *, reset: bool) -> None:
        """Whoever is heard next may be another: greet first."""
        self._greeting.lost(time.monotonic())
        self._hello, self._reset = None, reset
        self._set_connected(connected=False)

    def _listen(self, port: Port) -> bytes:
        began_s = time.monotonic()
        data = port.read(READ_S)
        # A process that was held up for a second has not listened for a second.
        self._silent_s += min(time.monotonic() - began_s, 2 * READ_S)
        return data

    def _receive(self, frame: Frame) -> None:
        if frame.type == FrameType.TELEMETRY and len(frame.payload) == wire.TELEMETRY_SIZE:
            hello = self._hello
            if hello is None or not ours(hello):
                self._set_connected(connected=False)
                return
            telemetry = Telemetry.unpack(frame.payload)
            if telemetry.boot != hello.boot % 2**16:
                self._lose_sight(reset=True)
                return
            with self._news:
                self._telemetry = telemetry
                self._news.notify_all()
            self._set_connected(connected=True)
            self._on_telemetry(telemetry)
        elif frame.type == FrameType.HELLO_REPLY and len(frame.payload) == wire.HELLO_REPLY_SIZE:
            self._hello = HelloReply.unpack(frame.payload)
        elif frame.type == FrameType.TEXT and len(frame.payload) > 1:
            self._on_text(frame.seq, Text.unpack(frame.payload))
        elif frame.type == FrameType.TEXT_WARNING and len(frame.payload) == wire.TEXT_WARNING_SIZE:
            self._on_text(frame.seq, TextWarning.unpack(frame.payload))
        elif FrameType.ACK <= frame.type < FrameType.TELEMETRY and frame.payload:  # beyond: unasked
            slot = self._pending.get((frame.type, frame.seq))
            if slot is not None:
                slot.put(frame.payload[0])

    def _set_connected(self, *, connected: bool) -> None:
        if connected != self._connected:
            self._connected = connected
            self._on_link()

    def close(self) -> None:
        """Free the port; the board itself stays as it is."""
        self._closed.set()
        if self._thread is not None:
            self._thread.join(timeout=2.0)


def ours(hello: HelloReply) -> bool:
    """The firmware speaks this program's contract."""
    return hello.contract == wire.CONTRACT


def unheard(link: Link) -> NoAnswer:
    """What to tell people while there is no board, or one that cannot be understood."""
    if link.foreign:
        return NoAnswer(Reason.CONTRACT_MISMATCH, link.trouble)
    return NoAnswer(Reason.BOARD_LOST, f"The node does not hear its board: {link.trouble}")


def mismatch_text(hello: HelloReply) -> str:
    """What to tell people whose firmware is of another version, or counts with other values."""
    return (
        f"The firmware {'.'.join(map(str, hello.version))} speaks contract {hello.contract:08x}, this program "
        f"{wire.CONTRACT:08x}: it is of another version, or was built for another robot (microsteps, gears, guard, "
        "speed). End what uses the board and put this program's firmware onto it with `beatrix flash`; or, if it was "
        "built on purpose, use the program that was generated with it."
    )
