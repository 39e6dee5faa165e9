"""The lines of a program of 2023: their queue, their way to the board, their answers and outcomes.

The firmware understands the lines and answers them (decision 0013). The queue sends one line at a time, if the access
rules allow it, and answers every line in order, even if the board is lost.
"""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Final

from beatrix_zenoh.board.board import Board
from beatrix_zenoh.contract._generated import serial as wire
from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract._generated.serial import (
    BoardState,
    FrameType,
    Text,
    TextWarning,
    WarningCode,
)
from beatrix_zenoh.contract.errors import BeatrixError, NoAnswer, Refused, bad_value
from beatrix_zenoh.node.access import Operation
from beatrix_zenoh.node.legacy_driving import Driving

ACK, NACK = b"ACK\n", b"NACK\n"
UNKNOWN: Final = (NACK,)
"""The answer to a line that is not in the protocol."""
REFUSED: Final = (ACK, NACK)
"""The answer to a line that is in the protocol and is not carried out."""
CAPACITY: Final = 1024
"""Largest number of lines without an answer; further lines are ignored."""
LAST: Final = 1
"""Flag of the TEXT that ends an answer."""
SHOWN_S: Final = 0.3
"""Time within which telemetry shows that a line has switched the motors (s)."""

STOPPED: Final = Refused(Reason.STOPPED, "STOP was pressed.")
LOST: Final = NoAnswer(Reason.BOARD_LOST, "the board has not answered the line. Restart the program.")
DROPPED: Final = Refused(Reason.CLIENT_LOST, "the program closed its port, or another one opened it.")
REFUSED_BY_BOARD: Final = bad_value(
    "the board refused the line, or ended its motion before the goal. Motions need @CALNOW first, and again after each "
    "@ENMOTORS ON or OFF; numbers go up to 32767. docs/how-to/old-programs.md lists the words.",
)


@dataclass(eq=False)
class ProgramLine:
    """A line in the queue; two lines with the same text are different lines."""

    text: bytes
    operation: Operation | None = field(init=False)
    sent_s: float | None = None
    """when it was sent to the board (s, monotonic clock); None: not sent"""
    refusal: tuple[bytes, ...] = ()
    """the answer of the node instead of the board's; empty: the line was not refused"""
    cause: BeatrixError | None = None
    """why it is not carried out, if that is known before the board answers"""
    begun: bool = False
    """whether the first line of the answer was written"""

    def __post_init__(self) -> None:
        self.operation = operation_of(self.text)

    @property
    def sent(self) -> bool:
        """Whether the line was sent to the board and not refused since."""
        return self.sent_s is not None and not self.refusal

    @property
    def waits(self) -> bool:
        """Whether the line was neither sent nor refused."""
        return self.sent_s is None and not self.refusal


def operation_of(text: bytes) -> Operation | None:
    """Return what a line does, None: nothing that needs a right; unknown words that begin with @MOV count as motions."""
    words = text.split(b" ")
    if text == b"@STOPALL":
        return Operation.STOP
    if text == b"@CALNOW":
        return Operation.CALIBRATE
    if words[0].startswith(b"@MOV"):
        return Operation.MOVE
    if words[0] == b"@ENMOTORS":
        return Operation.DISABLE if words[1:2] == [b"OFF"] else Operation.ENABLE
    return None


def readable(text: bytes) -> bool:
    """Return whether the firmware would accept `text` as a line."""
    return (
        text.startswith(b"@") and len(text) <= wire.TEXT_LINE_MAX and text.isascii() and min(text) >= ord(" ")
    )


class LineQueue:
    """Sends one line at a time to the board; its methods run on the controller's thread."""

    def __init__(self, write: Callable[[bytes], None], board: Board, driving: Driving) -> None:
        self._write, self._board, self._driving = write, board, driving
        self._lines: deque[ProgramLine] = deque()
        self.openings = 0
        """Number of TEXT_OPEN requests; answers from before the last one belong to no line. Any thread may read it."""
        self._lines_lost = False
        """Whether the board may still answer lines for which no line waits here; it must discard them first."""

    # -- the program ----------------------------------------------------------------------------------

    def program_opened(self) -> None:
        """Drop all lines of the previous program, and begin as if the board had just been reset."""
        self._drop(list(self._lines))
        try:
            self._open()
        except BeatrixError as error:
            self._driving.warn(error.message)
        self._driving.program_began()

    def program_closed(self) -> None:
        """Drop the waiting lines, except motors off; the board finishes the lines that it has received."""
        self._drop([line for line in self._lines if line.waits and line.operation is not Operation.DISABLE])
        self._advance()

    def _drop(self, lines: list[ProgramLine]) -> None:
        for line in lines:
            self._lines.remove(line)
            if not line.refusal:
                self._driving.record(line.text, line.operation, DROPPED, since_s=line.sent_s, silent=True)

    def take(self, text: bytes) -> None:
        """Queue or refuse a line of the program; send STOP at once."""
        line = ProgramLine(text)
        if line.operation is Operation.STOP:
            self._stop(line)
        elif len(self._lines) >= CAPACITY:
            return
        elif not readable(text):
            line.refusal = UNKNOWN
        self._lines.append(line)
        self._advance()

    def _stop(self, line: ProgramLine) -> None:
        """Refuse the waiting motions, send the other waiting lines, then STOP, so that answers keep their order."""
        self.refuse_waiting_motions()
        for waiting in self._lines:
            if waiting.waits:
                self._send(waiting)
        self._send(line)
        self._driving.stop_sent()

    def refuse_waiting_motions(self) -> None:
        """After a STOP of any client refuse the waiting motions; STOP is also the cause if a sent motion ends early."""
        for line in self._lines:
            if line.operation is Operation.MOVE and not line.refusal:
                line.cause = STOPPED
                if line.waits:
                    self._refuse(line, STOPPED, silent=True)

    # -- the board ------------------------------------------------------------------------------------

    def _open(self) -> None:
        """Let the firmware discard the lines and the zero of the program; raises BeatrixError."""
        self.openings += 1
        self._lines_lost = True
        self._board.request(FrameType.TEXT_OPEN)
        self._lines_lost = False

    def _send(self, line: ProgramLine) -> None:
        """Send a line if the node and the board allow it; otherwise refuse it."""
        try:
            if line.operation in (Operation.MOVE, Operation.ENABLE, Operation.DISABLE):
                self._driving.authorize(line.operation)
            self._board.check_connected()
            if self._lines_lost:
                self._open()
            if line.operation is Operation.CALIBRATE and self._sets_home():
                self._driving.authorize(Operation.CALIBRATE)
            self._board.send_text(line.text)
        except BeatrixError as error:
            self._refuse(line, error)
            return
        line.sent_s = time.monotonic()
        if line.operation is Operation.MOVE:
            self._driving.record(line.text, line.operation)

    def _sets_home(self) -> bool:
        """Return whether @CALNOW would set the robot's home, because the motors are on and home is not known."""
        before = self._board.telemetry
        self._board.wait_for(
            lambda new: new is not before, SHOWN_S
        )  # a line may just have switched the motors
        return self._board.state & (BoardState.ENABLED | BoardState.CALIBRATED) == BoardState.ENABLED

    def _refuse(self, line: ProgramLine, error: BeatrixError, *, silent: bool = False) -> None:
        line.refusal = REFUSED
        self._driving.record(line.text, line.operation, error, silent=silent)

    def _advance(self) -> None:
        """Answer the refused lines at the head of the queue and send the next line."""
        answers = b""
        while self._lines:
            line = self._lines[0]
            if line.waits:
                self._send(line)
            if not line.refusal:
                break
            self._lines.popleft()
            answers += b"".join(line.refusal[line.begun :] or line.refusal[-1:])
        self._write(answers)
        if not self._lines:
            self._driving.moves_ended()

    def receive(self, frame: Text | TextWarning, opening: int) -> None:
        """Handle a line or a warning of the board; `opening`: value of `openings` when it arrived."""
        line = self._lines[0] if self._lines and self._lines[0].sent else None
        if isinstance(frame, TextWarning):
            self._driving.warn(WarningCode(frame.code).text)
        elif opening == self.openings and line is not None:
            line.begun = True
            self._write(frame.text)
            if frame.flags & LAST:
                self._lines.popleft()
                self._ended(line, REFUSED_BY_BOARD if frame.text == NACK else None)
                self._advance()

    def _ended(self, line: ProgramLine, error: BeatrixError | None) -> None:
        """Record the end of a line that was sent; a known cause replaces the error, unless the line was carried out."""
        error = error and (line.cause or error)
        self._driving.record(line.text, line.operation, error, since_s=line.sent_s)

    def observe(self) -> None:
        """Refuse the lines that the board will never answer, because it is lost."""
        sent = [line for line in self._lines if line.sent]
        if self._board.connected or not sent:
            return
        self._lines_lost = True
        for line in sent:
            line.refusal = REFUSED
            self._ended(line, LOST)
        self._advance()
