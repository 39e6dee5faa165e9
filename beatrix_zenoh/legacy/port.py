"""The port for programs of 2023: passes lines between terminal, controller and board.

The firmware understands the lines and answers them (decision 0013). The port queues them, applies the access
rules and STOP, and answers every line in order, even if the board is lost.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable

from beatrix_zenoh.board.board import Board
from beatrix_zenoh.contract._generated.serial import Text, TextWarning
from beatrix_zenoh.legacy import outcomes
from beatrix_zenoh.legacy.interface import NodeInterface
from beatrix_zenoh.legacy.line import ACK, NACK, REFUSED, UNKNOWN, Effect, ProgramLine, effect_of, readable
from beatrix_zenoh.legacy.link import LineSender, TextLink
from beatrix_zenoh.legacy.outcomes import Outcomes
from beatrix_zenoh.legacy.terminal import Terminal

ECHOED = (b"ACK", b"NACK")
"""Lines that a terminal with echo returns to the port; answers to them would be echoed again, without end."""


class TextPort:
    """Receives the lines of a terminal; `lines` is their queue, used on the controller's thread through `post`."""

    def __init__(
        self,
        terminal: Terminal,
        board: Board,
        node: NodeInterface,
        post: Callable[[Callable[[], None]], None],
    ) -> None:
        self._terminal, self._node, self._post = terminal, node, post
        self._link = TextLink(board)
        self.lines = LineQueue(terminal.write, self._link, node)

    # -- called on the terminal's thread ----------------------------------------------------------------

    def opened(self) -> None:
        """Handle a program that has opened the terminal."""
        self._post(self._opened)

    def _opened(self) -> None:
        self.lines.program_opened()
        self._terminal.begin_answers()

    def received(self, line: bytes) -> None:
        """Queue a line of the program, unless it is an echoed answer; report STOP to the node at once."""
        if effect_of(line) is Effect.STOP:
            self._node.stop_pressed()
        if line not in ECHOED:
            self._post(lambda: self.lines.take(line))

    def closed(self) -> None:
        """Handle a program that has closed the terminal, or has ended."""
        self._post(self.lines.program_closed)

    # -- called on the board's thread -------------------------------------------------------------------

    def board_sent(self, seq: int, frame: Text | TextWarning) -> None:
        """Handle a line of an answer, or a warning, from the board; `seq` counts both."""
        opening = self._link.openings
        self._post(lambda: self.lines.receive(seq, frame, opening))

    # -- called by the node -----------------------------------------------------------------------------

    def start(self) -> None:
        """Begin to receive lines."""
        self._terminal.start(self)

    def close(self) -> None:
        """Close the terminal."""
        self._terminal.close()


CAPACITY = 32
"""Largest number of lines without an answer; further lines are refused."""
REFUSED_MAX = 1024
"""Largest number of lines without an answer, refused lines included; further refused lines are ignored."""
LAST = 1
"""Flag of the TEXT that ends an answer."""


class LineQueue:
    """Sends one line at a time to the board; its methods run on the controller's thread, except `overdue`."""

    def __init__(self, write: Callable[[bytes], None], link: TextLink, node: NodeInterface) -> None:
        self._write, self._link, self._node = write, link, node
        self._outcomes = Outcomes(node)
        self._sender = LineSender(link, node, self._outcomes)
        self._lines: deque[ProgramLine] = deque()
        self._last_queued = Effect.NONE

    # -- the program ----------------------------------------------------------------------------------

    def program_opened(self) -> None:
        """Drop all lines of the previous program, and begin as if the board had just been reset.

        A line without an answer that switches the motors off is still carried out.
        """
        off = next((line for line in self._lines if switches_off(line)), None)
        if off is not None:
            self._lines.remove(off)
            self._sender.switch_off_now(off)
        self._drop(set(self._lines))
        self._last_queued = Effect.NONE
        self._sender.open()
        self._node.program_began()
        self._node.moves_ended()

    def program_closed(self) -> None:
        """Drop the waiting lines, except motors off; the board finishes the lines that it has received."""
        self._drop({line for line in self._lines if not (line.sent or switches_off(line))})
        self._advance()

    def _drop(self, lines: set[ProgramLine]) -> None:
        for line in self._lines:
            if line in lines and not line.refusal:
                self._outcomes.dropped(line)
        self._lines = deque(line for line in self._lines if line not in lines)

    def take(self, text: bytes) -> None:
        """Queue or refuse a line of the program; send STOP at once."""
        line = ProgramLine(text)
        if line.effect is Effect.STOP:
            self._stop(line)
        elif not readable(text):
            line.refusal = UNKNOWN
            line.cause = None if line.effect is Effect.NONE else outcomes.UNREADABLE
        elif self._full_for(line):
            line.refusal, line.cause = REFUSED, outcomes.BUSY
            if line.effect is Effect.MOVE:
                self._node.move_declined()
        else:
            self._last_queued = line.effect
        if line.refusal and len(self._lines) >= REFUSED_MAX:
            return
        if line.cause is not None:
            self._outcomes.declined(line, line.cause)
        self._lines.append(line)
        self._advance()

    def _full_for(self, line: ProgramLine) -> bool:
        """Return whether the queue is full for `line`.

        A line that switches the motors off is accepted even then, but not twice in a row.
        """
        if len(self._lines) < CAPACITY:
            return False
        return line.effect is not Effect.DISABLE or self._last_queued is Effect.DISABLE

    def _stop(self, line: ProgramLine) -> None:
        """Refuse the waiting motions, send the other waiting lines, then STOP, so that answers keep their order."""
        self.refuse_waiting_motions()
        for waiting in self._lines:
            if waiting.waits:
                self._sender.send(waiting)
        self._sender.send(line)
        self._node.stop_sent()

    def refuse_waiting_motions(self) -> None:
        """After a STOP of any client refuse the waiting motions; STOP is also the cause if a sent motion ends early."""
        for line in self._lines:
            if line.effect is not Effect.MOVE or line.refusal:
                continue
            line.cause = outcomes.STOPPED
            if line.waits:
                line.refusal = REFUSED
                self._outcomes.declined(line, outcomes.STOPPED, silent=True)

    # -- the board ------------------------------------------------------------------------------------

    def _advance(self) -> None:
        """Answer the refused lines at the head of the queue and send the next line."""
        answers: list[bytes] = []
        while self._lines:
            line = self._lines[0]
            if line.waits:
                self._sender.send(line)
            if not line.refusal:
                break
            self._lines.popleft()
            answers += line.answer.refuse(line.refusal)
        self._write(b"".join(answers))
        if not self._lines:
            self._node.moves_ended()

    def receive(self, seq: int, frame: Text | TextWarning, opening: int) -> None:
        """Handle a line or a warning of the board; `opening`: value of `TextLink.openings` when it arrived."""
        lost = self._link.received(seq)
        line = self._lines[0] if self._lines and self._lines[0].sent else None
        if line is not None:
            line.answer.damaged |= lost
        if isinstance(frame, TextWarning):
            self._outcomes.board_warned(line, frame.code)
        elif opening != self._link.openings or line is None:
            return  # no line of the present program waits for this answer
        elif frame.flags & LAST:
            self._answered(line, frame.text)
        else:
            self._write(b"".join(line.answer.add(frame.text)))

    def _answered(self, line: ProgramLine, last: bytes) -> None:
        self._lines.popleft()
        answer = line.answer
        if last == NACK:
            unknown = not (answer.begun or answer.damaged)
            self._outcomes.not_done(line, unknown=unknown, zero_forgotten=self._link.zero_forgotten)
        else:
            self._outcomes.done(line)
        if line.effect in (Effect.ENABLE, Effect.DISABLE) and last == ACK:
            self._link.switched()
        self._write(b"".join(answer.finish(last, data=line.requests_numbers)))
        self._advance()

    def overdue(self) -> bool:
        """Return whether `observe` has something to do; any thread may call it."""
        return self._outcomes.overdue() or (bool(self._lines) and self._link.silent())

    def observe(self) -> None:
        """Refuse the lines that the board will never answer; report the refusals that it has not explained."""
        if self._outcomes.overdue():
            self._outcomes.report_unexplained()
        sent = [line for line in self._lines if line.sent]
        if not self._link.gave_up(sent):
            return
        for line in sent:
            line.refusal, line.cause = REFUSED, outcomes.LOST
            self._outcomes.not_done(line, unknown=False, zero_forgotten=False)
        self._advance()


def switches_off(line: ProgramLine) -> bool:
    """Return whether a line switches the motors off; it is carried out even after the program has closed the port."""
    return line.effect is Effect.DISABLE and not line.refusal
