"""The board of a node: requests with timeouts and retries, telemetry, lines of text."""

from __future__ import annotations

import queue
import threading
from collections.abc import Callable
from typing import Final

from beatrix_zenoh.board.connection import BoardConnection
from beatrix_zenoh.board.link import SerialFrame, encode
from beatrix_zenoh.board.state import Port
from beatrix_zenoh.contract import refusals
from beatrix_zenoh.contract._generated import serial as wire
from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract._generated.serial import (
    BoardState,
    Error,
    FrameType,
    Move,
    MoveStraight,
    Telemetry,
    Text,
    TextWarning,
)
from beatrix_zenoh.contract.errors import NoAnswer, Refused

STOPS: Final = (FrameType.STOP, FrameType.EMERGENCY_STOP)
MOTIONS: Final = (FrameType.MOVE, FrameType.MOVE_STRAIGHT)
_OK: Final = bytes([Error.OK])
REPLY_S: Final = wire.REPLY_TIMEOUT / 1000


class Board(BoardConnection):
    """A board on a port that may be unplugged and plugged in again.

    `on_telemetry` is called for the newest TELEMETRY that has arrived, after `sample` has been set; `on_link` when the
    board is connected or lost; `on_text` for every line and warning of the text port. All callbacks
    run on the board's own thread, never on the thread that calls `request`. They must be quick and must not
    call the board.

    Telemetry from before a motion may arrive after the acknowledgement of the motion: wait for newer telemetry with
    `wait_for`.
    """

    def __init__(
        self,
        open_port: Callable[[], Port],
        on_telemetry: Callable[[Telemetry], None],
        on_link: Callable[[], None],
    ) -> None:
        """Store the callbacks; `start` opens the port."""
        super().__init__(open_port, on_telemetry, on_link)
        self.on_text: Callable[[Text | TextWarning], None] = lambda *_: None
        """Set this before `start`."""
        self._lock = threading.Lock()
        self._pending: dict[tuple[int, int], queue.SimpleQueue[int]] = {}
        self._seq = 0

    @property
    def telemetry(self) -> Telemetry | None:
        """The newest telemetry; None before the first."""
        sample = self.sample
        return None if sample is None else sample.telemetry

    @property
    def state(self) -> int:
        """State bits of the newest telemetry, 0 before the first."""
        telemetry = self.telemetry
        return 0 if telemetry is None else telemetry.state

    def wait_for(self, holds: Callable[[Telemetry], bool], timeout_s: float) -> bool:
        """Wait until `holds` is true for the newest telemetry; return False if this takes longer than `timeout_s`."""
        with self.sample_changed:
            return self.sample_changed.wait_for(
                lambda: self.sample is not None and holds(self.sample.telemetry), timeout=timeout_s
            )

    def move(self, move: Move | MoveStraight) -> None:
        """Begin a motion; raises the errors of `request`. Call `wake` after the reply to the client."""
        self.request(move.kind, move.pack())

    def enable(self, *, on: bool) -> None:
        """Switch the motors on or off; raises the errors of `request`."""
        self.request(FrameType.ENABLE, bytes([on]))

    def send_text(self, line: bytes) -> None:
        """Send a line of text, given without its line end; raises NoAnswer: BOARD_LOST or CONTRACT_MISMATCH."""
        self.check_connected()
        self.write(line + b"\r")  # not `write_frame`: text does not count as a heartbeat
        self.wake()

    def check_connected(self) -> None:
        """Raise NoAnswer (BOARD_LOST or CONTRACT_MISMATCH) unless the board is connected."""
        if not self.connected:
            raise self.not_connected()

    def ready_telemetry(self) -> Telemetry:
        """Return the newest telemetry of a robot that is ready to move.

        Raises:
            Refused or NoAnswer: the robot is not ready to move; the message says why and what to do.
        """
        telemetry = self.telemetry
        if telemetry is None or not self.connected:
            raise self.not_connected()
        state = telemetry.state
        refusals.check_ready(
            emergency=bool(state & BoardState.EMERGENCY),
            enabled=bool(state & BoardState.ENABLED),
            calibrated=bool(state & BoardState.CALIBRATED),
        )
        return telemetry

    def request(self, kind: FrameType, payload: bytes = b"") -> None:
        """Send a request and wait for its acknowledgement; without one, send it again, TRIES times in all.

        Raises:
            Refused: the firmware refused the request.
            NoAnswer: BOARD_LOST or CONTRACT_MISMATCH.
        """
        # STOP and EMERGENCY_STOP are the same in every contract: send them to any firmware.
        if kind not in STOPS and not self.understood:
            raise self.not_connected()
        slot: queue.SimpleQueue[int] = queue.SimpleQueue()
        with self._lock:
            self._seq = seq = self._seq % 255 + 1
            self._pending[kind | FrameType.ACK, seq] = slot
        try:
            code = self._ask(kind, seq, payload, slot)
        finally:
            self._pending.pop((kind | FrameType.ACK, seq), None)
        if code is None:
            raise NoAnswer(
                Reason.BOARD_LOST,
                f"The board at {self.port_name or 'its port'} does not answer. Check its cable and its power.",
            )
        check_acknowledged(kind, code)

    def _ask(self, kind: FrameType, seq: int, payload: bytes, slot: queue.SimpleQueue[int]) -> int | None:
        """Send a request up to TRIES times; return the code of the acknowledgement, None if there is none.

        `write_frame` returns the answer of a virtual board. For a motion this thread finds the acknowledgement
        in it and does not wait for the board's thread, which reads the same bytes later. Other requests wait for the
        board's thread, so that everything the board sent earlier (answers to text, telemetry) has been handled.
        """
        frame = encode(kind, seq, payload)
        for attempt in range(wire.TRIES):
            self.retries += attempt > 0
            answer = self.write_frame(frame)
            self.request_sent()
            if kind in MOTIONS and answer and answer.startswith(encode(kind | FrameType.ACK, seq, _OK)):
                return Error.OK
            self.wake()
            try:
                return slot.get(timeout=REPLY_S)
            except queue.Empty:
                continue
        return None

    def _handle(self, frame: SerialFrame) -> None:
        if frame.type == FrameType.TEXT and len(frame.payload) > 1:
            self.on_text(Text.unpack(frame.payload))
        elif frame.type == FrameType.TEXT_WARNING and len(frame.payload) == TextWarning.layout.size:
            self.on_text(TextWarning.unpack(frame.payload))
        elif FrameType.ACK <= frame.type < FrameType.TELEMETRY and frame.payload:  # a reply
            slot = self._pending.get((frame.type, frame.seq))
            if slot is not None:
                slot.put(frame.payload[0])


def check_acknowledged(kind: FrameType, code: int) -> None:
    """Raise Refused unless the error code of an acknowledgement is OK."""
    if code == Error.OK:
        return
    if code not in list(Error):
        raise Refused(
            Reason.CONTRACT_MISMATCH, f"The firmware answered {kind.name} with the unknown error code {code}."
        )
    error = Error(code)
    raise Refused(error.reason, f"The firmware refused {kind.name}: {error.text}.")
