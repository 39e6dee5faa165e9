"""The connection to a board: the port, handshake, heartbeat and telemetry."""

from __future__ import annotations

import contextlib
import threading
import time
from collections.abc import Callable
from typing import Final

from beatrix_zenoh import threads
from beatrix_zenoh.board.link import Decoder, SerialFrame, encode
from beatrix_zenoh.board.state import NO_TELEMETRY, Port, TelemetrySample, mismatch_text
from beatrix_zenoh.board.timing import BoardClock, Handshake
from beatrix_zenoh.board.virtual import TimedPort
from beatrix_zenoh.contract._generated import serial as wire
from beatrix_zenoh.contract._generated.messages import BoardStatus, Reason
from beatrix_zenoh.contract._generated.serial import FrameType, HelloReply, Telemetry
from beatrix_zenoh.contract.errors import BeatrixError, NoAnswer
from beatrix_zenoh.schedule import Schedule
from beatrix_zenoh.threads import Owner

READ_S: Final = 0.05
REOPEN_S: Final = 0.3
HEARTBEAT_S: Final = wire.HEARTBEAT_PERIOD / 1000
SILENT: Final = ". Check that the board is powered."
NEVER_CONNECTED: Final = (
    ". Check that the board is connected to this port. If the board does not have BEATRIX's firmware, end this program "
    "and run `beatrix flash`."
)
LOST_S: Final = 0.4
"""Silence (s) after which the board counts as lost; together with READ_S less than 0.5 s."""


class BoardConnection:
    """A thread that opens the port, sends handshake and heartbeat, and decodes the frames of the board.

    `on_telemetry` is called for the newest TELEMETRY that has arrived, `on_link` when the board is connected or lost, and
    `_handle` for all other frames but HELLO_REPLY; all on this thread.
    """

    def __init__(
        self,
        open_port: Callable[[], Port],
        on_telemetry: Callable[[Telemetry], None],
        on_link: Callable[[], None],
    ) -> None:
        """Store the callbacks; `start` opens the port."""
        self._open_port = open_port
        self._on_telemetry, self._on_link = on_telemetry, on_link
        self.sample_changed = threading.Condition()
        self.sample: TelemetrySample | None = None
        self.connected = False
        self.hello: HelloReply | None = None
        """What the firmware has answered to HELLO."""
        self.reset = False
        """Whether the connection was lost because the board was reset."""
        self.retries = 0
        """Number of times that a request was sent again."""
        self._clock = BoardClock()
        self._port: Port | None = None
        self.port_name = self._trouble = ""
        self._decoder = Decoder()
        self._handshake = Handshake(0.0, 0.0)
        self._silent_s = self._sent_s = 0.0
        self._closed = threading.Event()
        self._thread: threading.Thread | None = None
        self._end_turns: Callable[[], None] = lambda: None

    def start(self) -> None:
        """Start the thread, which runs the callbacks."""
        self._thread = threads.start(self._run, "board")

    def start_turns(self, schedule: Schedule, owner: Owner, port: TimedPort) -> None:
        """Let the thread of `schedule`, which several virtual boards share, run the callbacks; the port stays open."""
        self._opened(port)
        task = schedule.add(owner, lambda: self._turn(port))
        port.notify = task.wake
        task.wake()

        def end() -> None:
            if schedule.remove(task):
                self._end_port(port)

        self._end_turns = end

    @property
    def trouble(self) -> str:
        """Why the board is not connected, as a sentence (port not open, other firmware, no frames); empty if it is."""
        hello, trouble = self.hello, self._trouble
        if trouble or self.connected:
            return trouble
        if hello is not None and hello.contract != wire.CONTRACT:
            return mismatch_text(hello)
        return f"{self.port_name or 'The port'} is silent{SILENT if self.sample else NEVER_CONNECTED}"

    @property
    def understood(self) -> bool:
        """Whether the firmware has answered HELLO and has this program's contract."""
        hello = self.hello
        return hello is not None and hello.contract == wire.CONTRACT

    @property
    def contract_differs(self) -> bool:
        """Whether the firmware has another contract."""
        hello = self.hello
        return hello is not None and hello.contract != wire.CONTRACT

    def status(self) -> BoardStatus:
        """Return the present state of the connection."""
        hello, telemetry = self.hello, self.sample.telemetry if self.sample else NO_TELEMETRY
        return BoardStatus(
            connected=self.connected,
            port=self.port_name,
            name="" if hello is None else hello.name.rstrip(b"\0").decode("ascii", "replace"),
            firmware="" if hello is None else ".".join(map(str, hello.version)),
            contract="" if hello is None else f"{hello.contract:08x}",
            boot=0 if hello is None else hello.boot,
            rejected_frames=self._decoder.rejected + telemetry.rejected,
            retries=self.retries,
            overflowed_bytes=telemetry.overflowed,
        )

    def not_connected(self) -> NoAnswer:
        """Return the error for a request while the board is not connected."""
        if self.contract_differs:
            return NoAnswer(Reason.CONTRACT_MISMATCH, self.trouble)
        return NoAnswer(Reason.BOARD_LOST, f"The board does not answer its node: {self.trouble}")

    def write_frame(self, frame: bytes) -> bytes:
        """Send an encoded frame as `write` does; the frame counts as a heartbeat."""
        answer = self.write(frame)
        self._sent_s = time.monotonic()
        return answer

    def write(self, data: bytes) -> bytes:
        """Send bytes as `Port.write` does; raises NoAnswer: BOARD_LOST or CONTRACT_MISMATCH."""
        port = self._port
        if port is None:
            raise self.not_connected()
        try:
            return port.write(data)
        except OSError as error:
            raise NoAnswer(
                Reason.BOARD_LOST, f"The board at {port.name} was disconnected ({error})."
            ) from error

    def wake(self) -> None:
        """Wake the threads that wait for a virtual board; without this call they wake within milliseconds."""
        port = self._port
        if port is not None:
            port.wake()

    def request_sent(self) -> None:
        """Postpone the next HELLO after a request, if the contract of the board is unknown."""
        if self.hello is None:
            self._handshake.request_sent(time.monotonic())

    def _run(self) -> None:
        while not self._closed.is_set():
            try:
                port = self._open_port()
            except (OSError, BeatrixError) as error:
                self._trouble = str(error)
                self._closed.wait(REOPEN_S)
                continue
            self._opened(port)
            with contextlib.suppress(OSError, NoAnswer):
                while not self._closed.is_set():
                    self._exchange(port, READ_S)
            self._end_port(port)
            self._closed.wait(0 if self._closed.is_set() else REOPEN_S)

    def _turn(self, port: TimedPort) -> float:
        """Exchange what is due with a virtual board; return the time (s) of the next turn."""
        with contextlib.suppress(OSError, NoAnswer):
            self._exchange(port, 0.0)
            return port.due_s()
        return float("inf")  # the port was closed

    def _opened(self, port: Port) -> None:
        self._port, self.port_name, self._decoder = port, port.name, Decoder()
        self._trouble = ""
        self._silent_s = 0.0
        self._handshake = Handshake(time.monotonic(), port.boot_s)
        self._clock.restart()

    def _end_port(self, port: Port) -> None:
        self._port = self.hello = None
        self.reset = False
        self._set_connected(connected=False)
        port.close()

    def _exchange(self, port: Port, timeout_s: float) -> None:
        """Send what is due and handle what arrives, waiting up to `timeout_s`; raises OSError or NoAnswer."""
        self._send_due(time.monotonic())
        frames = self._decoder.feed(self._read(port, timeout_s))
        received_ns = time.monotonic_ns()
        newest = next((frame for frame in reversed(frames) if frame.type == FrameType.TELEMETRY), None)
        for frame in frames:
            self._silent_s = 0.0
            if frame.type != FrameType.TELEMETRY or frame is newest:  # one that has waited is out of date
                self._receive(frame, received_ns)
            if self.hello is None:
                self._handshake.frame_received()
        if self._silent_s > LOST_S and (self.connected or self.hello is not None):
            self._lose(reset=False)

    def _send_due(self, now: float) -> None:
        """Send HELLO or a heartbeat if it is due."""
        if not self.understood:
            if self._handshake.due(now):
                self._handshake.hello_sent(now, foreign=self.hello is not None)
                self.write_frame(encode(FrameType.HELLO, 0, b""))
        elif now - self._sent_s > HEARTBEAT_S:
            self.write_frame(encode(FrameType.PING, 0, b""))

    def _lose(self, *, reset: bool) -> None:
        """Count the board as lost and repeat the handshake, because the board may have been reset or replaced."""
        self._handshake.lost(time.monotonic())
        self._clock.restart()
        self.hello, self.reset = None, reset
        self._set_connected(connected=False)

    def _read(self, port: Port, timeout_s: float) -> bytes:
        began_s = time.monotonic()
        data = port.read(timeout_s)
        # Limit the time: while the computer suspends this process, the board is not silent.
        self._silent_s += min(time.monotonic() - began_s, 2 * READ_S)
        return data

    def _receive(self, frame: SerialFrame, received_ns: int) -> None:
        if frame.type == FrameType.TELEMETRY and len(frame.payload) == Telemetry.layout.size:
            hello = self.hello
            if hello is None or hello.contract != wire.CONTRACT:
                self._set_connected(connected=False)
                return
            telemetry = Telemetry.unpack(frame.payload)
            if telemetry.boot != hello.boot % 2**8:
                self._lose(reset=True)
                return
            t_mono_ns = self._clock.feed(telemetry.tick, received_ns)
            with self.sample_changed:
                self.sample = TelemetrySample(telemetry, t_mono_ns)
                self.sample_changed.notify_all()
            self._set_connected(connected=True)
            self._on_telemetry(telemetry)
        elif frame.type == FrameType.HELLO_REPLY and len(frame.payload) == HelloReply.layout.size:
            self.hello = HelloReply.unpack(frame.payload)
        else:
            self._handle(frame)

    def _handle(self, frame: SerialFrame) -> None:
        """Handle a frame that is neither HELLO_REPLY nor TELEMETRY."""

    def _set_connected(self, *, connected: bool) -> None:
        if connected != self.connected:
            self.connected = connected
            self._on_link()

    def close(self) -> None:
        """End the thread, which closes the port; the state of the board does not change."""
        self._closed.set()
        if self._thread is not None:
            self._thread.join(timeout=2.0)
        self._end_turns()
