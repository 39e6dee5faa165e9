"""Send lines to the board if the node permits it, and find lines that the board will never answer."""

from __future__ import annotations

import time
from collections.abc import Sequence

from beatrix_zenoh.board.board import Board
from beatrix_zenoh.contract._generated.serial import BoardState, FrameType, Telemetry
from beatrix_zenoh.contract.errors import BeatrixError
from beatrix_zenoh.legacy.interface import NodeInterface
from beatrix_zenoh.legacy.line import REFUSED, Effect, ProgramLine
from beatrix_zenoh.legacy.outcomes import Outcomes

SEQS = 256
SHOWN_S = 0.3
"""Time within which telemetry shows that a line has switched the motors (s)."""
SILENT_S = 3.0
"""Time after which a line without an answer counts as lost on the serial link, if the arms are at rest."""
COUNTED_S = 340.0
"""Used instead of SILENT_S for a motion that the board only counts, because the motors are off: the longest one, from
-32767 to 32767 steps, takes 328 s at 200 steps/s."""
AUTHORIZED = (Effect.MOVE, Effect.ENABLE, Effect.DISABLE)
"""Effects that need permission; @CALNOW needs it only if it sets the robot's home."""


class TextLink:
    """Sends lines to the board; used on the controller's thread, except `openings` and `silent`."""

    def __init__(self, board: Board) -> None:
        self._board = board
        self.openings = 0
        """Number of TEXT_OPEN requests; answers from before the last one belong to no line."""
        self.zero_forgotten = False
        """Whether the firmware has discarded the zero of the program although the program did not request it."""
        self._lines_lost = False
        """Whether the board may still answer lines for which this port no longer waits; the board must discard
        them before the next line is sent."""
        self._next_seq: int | None = None
        """Number of the board's next TEXT or warning; None: any number."""
        self._before_switch: Telemetry | None = None
        """The telemetry when the board answered a line that switches the motors; None: no line since `sets_home`."""
        self._heard_s = 0.0

    def open(self) -> None:
        """Let the firmware discard the lines and the zero of the previous program; raises BeatrixError."""
        self.zero_forgotten, self._lines_lost = False, True
        self._reopen()

    def _reopen(self) -> None:
        self.openings += 1
        self._next_seq = None
        self._board.request(FrameType.TEXT_OPEN)
        self._lines_lost = False

    def prepare(self) -> None:
        """Make sure that the next answer belongs to the next line; raises BeatrixError."""
        self._board.check_connected()
        if self._lines_lost:
            self._reopen()
            self.zero_forgotten = True

    def send(self, line: ProgramLine) -> None:
        """Send a line; raises BeatrixError."""
        self._board.send_text(line.text)
        self._heard_s = line.sent_s = time.monotonic()

    def switch_off(self) -> None:
        """Switch the motors off at once; raises BeatrixError."""
        self._board.enable(on=False)

    def received(self, seq: int) -> bool:
        """Record the number of a TEXT or warning of the board; return whether earlier ones were lost."""
        lost = self._next_seq not in (None, seq)
        self._next_seq = (seq + 1) % SEQS
        self._heard_s = time.monotonic()
        return lost

    def switched(self) -> None:
        """Record that the board has answered a line that switches the motors."""
        self._before_switch = self._board.telemetry

    def sets_home(self) -> bool:
        """Return whether @CALNOW would set the robot's home, because the motors are on and home is not known.

        May wait SHOWN_S for telemetry.
        """
        before, self._before_switch = self._before_switch, None
        if before is not None:
            self._board.wait_for(lambda new: new is not before, SHOWN_S)
        return self._board.state & (BoardState.ENABLED | BoardState.CALIBRATED) == BoardState.ENABLED

    # -- lines that were lost -------------------------------------------------------------------------

    def silent(self) -> bool:
        """Return whether the board has not answered for SILENT_S; any thread may call it."""
        return time.monotonic() - self._heard_s > SILENT_S

    def gave_up(self, under_way: Sequence[ProgramLine]) -> bool:
        """Return whether the board will never answer these lines, because it was lost or reset, or they were lost."""
        connected, state = self._board.connected, self._board.state
        if not connected:
            self._next_seq = None
        if state & BoardState.MOVING:
            self._heard_s = time.monotonic()  # not silent: the board answers when the arms rest
        only_counted = not state & BoardState.ENABLED and any(
            line.effect is Effect.MOVE for line in under_way
        )
        limit_s = COUNTED_S if only_counted else SILENT_S
        lost = bool(under_way) and (not connected or time.monotonic() - self._heard_s > limit_s)
        self._lines_lost |= lost
        return lost


class LineSender:
    """Sends lines to the board if the node and the board allow it; used on the controller's thread."""

    def __init__(self, link: TextLink, node: NodeInterface, outcomes: Outcomes) -> None:
        self._link, self._node, self._outcomes = link, node, outcomes

    def send(self, line: ProgramLine) -> None:
        """Send a line, or refuse it."""
        try:
            if line.effect in AUTHORIZED:
                self._node.authorize(line.effect)
            self._link.prepare()
            if line.effect is Effect.CALIBRATE:
                self._prepare_calibration()
            self._link.send(line)
        except BeatrixError as error:
            line.refusal = REFUSED
            self._outcomes.failed(line, error)
        else:
            self._outcomes.accepted(line)

    def _prepare_calibration(self) -> None:
        """Request permission for @CALNOW if it sets the robot's home, and not only the zero of the program."""
        if self._link.sets_home():
            self._node.authorize(Effect.CALIBRATE)
            self._node.set_home()
        self._link.zero_forgotten = False

    def switch_off_now(self, line: ProgramLine) -> None:
        """Switch the motors off by a request of the node, because `open` discards the lines of the program."""
        try:
            self._node.authorize(Effect.DISABLE)
            self._link.switch_off()
        except BeatrixError as error:
            self._outcomes.failed(line, error)
        else:
            self._outcomes.done(line)

    def open(self) -> None:
        """Let the firmware discard the lines and the zero of the previous program; warn if this fails."""
        try:
            self._link.open()
        except BeatrixError as error:
            self._node.warn(f"old program: {error.message}")
