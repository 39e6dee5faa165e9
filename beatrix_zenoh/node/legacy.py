"""The port for old programs: lines of the text protocol of 2023, passed on to the firmware one at a time.

The firmware understands them and answers (record 0013). Here they wait, obey the lease and STOP, and every line is
answered in its turn whatever happens to the board.
"""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field

from beatrix_zenoh._generated import serial as wire
from beatrix_zenoh._generated.messages import Reason
from beatrix_zenoh._generated.serial import WARNING_TEXT, FrameType, State, Text, TextWarning, WarningCode
from beatrix_zenoh.board.board import Board
from beatrix_zenoh.errors import BeatrixError, NoAnswer
from beatrix_zenoh.node.body import Body
from beatrix_zenoh.node.driver import TEXT_SESSION, Driver
from beatrix_zenoh.node.terminal import KEPT, Terminal

CAPACITY = 32
"""Lines that wait; those beyond are refused."""
UNANSWERED = KEPT // 2
"""Lines without an answer, refused ones among them; then the program waits, and is not heard, not even @STOPALL. Each answer
has two lines: no more are kept for a program that does not read."""
AT_ONCE = 128
"""Refusals written in one go: what others ask for waits no longer."""
HANDED_OVER = 8
"""Lines on their way from the terminal's thread to the driver's; then the program waits, not those who ask over Zenoh."""
HAND_OVER_S = 1.0
LAST = 1
"""Flag of the line that ends an answer."""
HEARD, UNDONE = b"ACK\n", b"NACK\n"
UNKNOWN, REFUSED = (UNDONE,), (HEARD, UNDONE)
STOP, CALIBRATE, MOTORS, MOVES, ASKS = b"@STOPALL", b"@CALNOW", b"@ENMOTORS", b"@MOV", b"@GET"
SEQS = 256
ECHOED = (b"ACK", b"NACK")
"""A terminal that a program has set to echo sends back our own answers: to answer them would never end."""
ZERO_FORGOTTEN = (
    "the motion was refused: the board did not answer for a while, and so its zero for this program is forgotten. "
    "Start the program anew, or let it send @CALNOW."
)
NOT_YET_OR_TOO_FAR = "the motion was refused: @CALNOW must come before it, again after each @ENMOTORS, and no number in it may be beyond 32767."
EXPLAINED_S = 0.1
"""A board that refuses a motion says why within this long, if it does."""
SILENT_S = 3.0
"""A line that the board has not answered for this long, arms at rest, was lost on the wire."""
PRETENDED_S = 340.0
"""The same with motors off, when a motion is only counted: from -32767 to 32767 at 200 steps a second."""


@dataclass
class Line:
    """A command of the program and what has become of it."""

    text: bytes
    sent: bool = False
    told: int = 0
    """lines of its answer that the program has got: the first comes at once, the others together"""
    rest: list[bytes] = field(default_factory=list)
    """lines of its answer that wait for the last"""
    broken: bool = False
    """a line of its answer was lost on the wire"""
    refusal: tuple[bytes, ...] = ()
    warned: bool = False
    """somebody has said why it does not, or not all of it"""
    warning: str = ""
    """what the board has said of it"""

    @property
    def moves(self) -> bool:
        """It may turn the arms."""
        return self.text.startswith(MOVES)

    def end(self, last: bytes) -> list[bytes]:
        """What is left of its answer; whole for programs that count lines, even if the wire has lost some of it."""
        if not self.broken:
            return [*self.rest, last]
        end = UNDONE if self.text.startswith(ASKS) else last
        return [end] if self.told else [HEARD, end]


class Legacy:
    """Passes lines between a terminal and the board; its `opened`, `heard`, `closed` and `told` only hand over.

    Everything else runs on the driver's thread (`post`).
    """

    def __init__(
        self,
        terminal: Terminal,
        board: Board,
        driver: Driver,
        body: Body,
        online: Callable[[], bool],
        post: Callable[[Callable[[], None]], None],
    ) -> None:
        self._terminal, self._board, self._driver = terminal, board, driver
        self._body, self._online, self._post = body, online, post
        self._room = threading.Semaphore(HANDED_OVER)
        self._lines: deque[Line] = deque()
        self._heard_s = 0.0
        self._seq: int | None = None
        """The board's next TEXT; None: any"""
        self._openings = 0
        self._refusing = False
        """More refusals are about to be written"""
        self._unexplained_s: float | None = None
        """When a motion was refused; the board may be about to say why"""
        self._stale = False
        """The board may still answer lines that were given up: it must forget them before it gets another."""
        self._zero_forgotten = False
        """With them it forgot the program's zero, and the program does not know."""
        terminal.start(self)

    # -- called on the terminal's thread, `told` on the board's ---------------------------------------

    def opened(self) -> None:
        """A program has opened the terminal: to it the board was just reset."""
        self._post(self._open)

    def room(self) -> bool:
        """The program's next line may come."""
        return len(self._lines) < UNANSWERED

    def heard(self, line: bytes) -> None:
        """A line of the program."""
        if line == STOP:
            self._driver.halt(TEXT_SESSION)
        if line in ECHOED or (line != STOP and len(self._lines) >= UNANSWERED + 2 * HANDED_OVER):
            return  # the latter left behind by a program that has gone
        waited = self._room.acquire(timeout=HAND_OVER_S)
        self._post(lambda: self._take(line, waited=waited))

    def closed(self) -> None:
        """The program has gone: what is under way is finished, as in 2023; what waits is not begun."""
        self._post(self._drop_waiting)

    def told(self, seq: int, frame: Text | TextWarning) -> None:
        """The board has answered, or warns; `seq` counts what it says."""
        opening = self._openings
        self._post(lambda: self._pass_on(seq, frame, opening))

    # -- the driver's thread --------------------------------------------------------------------------

    def _open(self) -> None:
        try:
            self._board.request(FrameType.TEXT_OPEN)
            self._stale = self._zero_forgotten = False
        except BeatrixError as error:
            self._stale = True
            self._warn(error.message)
        self._openings += 1
        self._seq = None
        self._lines.clear()
        self._terminal.forget()
        self._rest()

    def _take(self, text: bytes, *, waited: bool) -> None:
        if waited:
            self._room.release()
        line = Line(text)
        if not readable(text):
            line.refusal = UNKNOWN
        elif text == STOP:
            self._stop(line)
        elif len(self._lines) >= CAPACITY:
            line.refusal = REFUSED
            self._warn(WARNING_TEXT[WarningCode.BUSY])
            if line.moves:
                self._driver.text_tried()
        self._lines.append(line)
        self._advance()

    def _stop(self, line: Line) -> None:
        """Nothing that waits moves any more; the rest goes on in front of STOP, so that answers keep their order."""
        self.call_off()
        for waiting in self._lines:
            if not waiting.sent and not waiting.refusal:
                self._send(waiting)
        self._send(line)
        self._driver.stopped(None, None, emergency=False)

    def call_off(self) -> None:
        """STOP, whoever pressed it: nothing that waits moves any more."""
        for line in self._lines:
            if not line.moves:
                continue
            line.warned = True
            if not line.sent and not line.refusal:
                line.refusal = REFUSED

    def _advance(self) -> None:
        """Answer what is refused, send the next."""
        for _ in range(AT_ONCE):
            if not self._lines:
                self._rest()
                return
            line = self._lines[0]
            if not line.refusal and not line.sent:
                self._send(line)
            if not line.refusal:
                return
            self._refuse(self._lines.popleft())
        if not self._refusing:
            self._refusing = True
            self._post(self._refuse_more)

    def _refuse_more(self) -> None:
        self._refusing = False
        self._advance()

    def _send(self, line: Line) -> None:
        """Pass a line on, if the lease and the board allow it; else it is refused."""
        try:
            if line.moves and not self._online():
                raise NoAnswer(Reason.NO_ROUTER, "the router has gone, so nobody could stop a motion.")
            self._board.check_heard()
            if line.text.startswith((MOVES, MOTORS, CALIBRATE)):
                self._driver.text_check(moves=line.moves)
            if self._stale:
                self._board.request(FrameType.TEXT_OPEN)
                self._openings += 1
                self._seq = None
                self._stale, self._zero_forgotten = False, True
            if line.text == CALIBRATE:
                self._zero_forgotten = False
                if self._homeless():
                    self._body.straighten()
                    self._driver.calibrations += 1
            self._board.send_text(line.text)
        except BeatrixError as error:
            line.refusal = REFUSED
            self._warn(error.message)
            return
        line.sent = True
        self._heard_s = time.monotonic()

    def _homeless(self) -> bool:
        """Motors on and home unknown: the program's zero becomes the robot's home."""
        return self._board.state & (State.ENABLED | State.CALIBRATED) == State.ENABLED

    def _warn(self, text: str) -> None:
        self._driver.warn(f"old program: {text}")

    def _refuse(self, line: Line) -> None:
        for text in line.refusal[line.told :] or line.refusal[-1:]:
            self._terminal.write(text)

    def _pass_on(self, seq: int, frame: Text | TextWarning, opening: int) -> None:
        lost = self._seq not in (None, seq)
        self._seq = (seq + 1) % SEQS
        line = self._lines[0] if self._lines and self._lines[0].sent else None
        if line is not None:
            line.broken |= lost
        if isinstance(frame, TextWarning):
            self._pass_warning_on(frame, line)
            return
        if opening != self._openings or line is None:
            return  # an answer to a program that has gone
        self._heard_s = time.monotonic()
        if frame.flags & LAST:
            self._answered(self._lines.popleft(), frame.text)
        elif line.told:
            line.rest.append(frame.text)
        else:
            self._terminal.write(HEARD if line.broken else frame.text)
            line.told = 1

    def _answered(self, line: Line, last: bytes) -> None:
        if last == UNDONE and self._driver.text_refused() and line.moves and not line.warned:
            self._unexplained_s = time.monotonic()
        if line.warning:
            self._warn(line.warning)  # a long motion has ended: who looks now shall see why it was shorter
        for text in line.end(last):
            self._terminal.write(text)
        self._advance()

    def _pass_warning_on(self, frame: TextWarning, line: Line | None) -> None:
        known = frame.code in WARNING_TEXT
        text = WARNING_TEXT[WarningCode(frame.code)] if known else f"unknown warning {frame.code}"
        self._warn(text)
        self._unexplained_s = None
        if line is not None:
            line.warned, line.warning = True, text

    def overdue(self) -> bool:
        """There is a reason for a `look`; may be called on any thread."""
        return self._unexplained() or (bool(self._lines) and time.monotonic() - self._heard_s > SILENT_S)

    def _unexplained(self) -> bool:
        refused_s = self._unexplained_s
        return refused_s is not None and time.monotonic() - refused_s > EXPLAINED_S

    def look(self) -> None:
        """Give up what the board will not answer any more: it was lost, reset, or the line was. Say what it does not explain."""
        if self._unexplained():
            self._unexplained_s = None
            self._warn(ZERO_FORGOTTEN if self._zero_forgotten else NOT_YET_OR_TOO_FAR)
        if not self._board.connected:
            self._seq = None
        if not any(line.sent for line in self._lines):
            return
        state = self._board.state
        if state & State.MOVING:
            self._heard_s = time.monotonic()  # as good as a word: the answer comes when the arms rest
        pretends = not state & State.ENABLED and any(line.sent and line.moves for line in self._lines)
        patience_s = PRETENDED_S if pretends else SILENT_S
        if not self._board.connected or time.monotonic() - self._heard_s > patience_s:
            self._warn("the board has not answered a line.")
            self._stale = True
            for line in self._lines:
                if line.sent:
                    line.sent, line.refusal = False, REFUSED
            self._advance()

    def _drop_waiting(self) -> None:
        self._lines = deque(line for line in self._lines if line.sent)
        if not self._lines:
            self._rest()

    def _rest(self) -> None:
        if not any(line.moves for line in self._lines):
            self._driver.text_rests()

    def close(self) -> None:
        """Hang up; the node has stopped the arms."""
        self._terminal.close()


def readable(line: bytes) -> bool:
    """The firmware would take it for a line of text."""
    return (
        line.startswith(b"@") and len(line) <= wire.TEXT_LINE_MAX and line.isascii() and min(line) >= ord(" ")
    )
