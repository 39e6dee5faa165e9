"""Report the outcome of each line: warnings in the status, and events for lines that act on the robot.

Both contain the reason why a line was refused.
"""

from __future__ import annotations

import re
import time
from typing import Final

from beatrix_zenoh.contract._generated.messages import Detail, Phase, Reason
from beatrix_zenoh.contract._generated.serial import WARNING_TEXT, WarningCode
from beatrix_zenoh.contract.errors import BeatrixError
from beatrix_zenoh.legacy.interface import NodeInterface
from beatrix_zenoh.legacy.line import Effect, LineCause, ProgramLine

EXPLAINED_S = 0.1
"""Time within which the board sends the warning that explains a NACK, if it sends one (s)."""
STEPS_MAX: Final = 32767
"""Largest number of steps in a line, in either direction."""
NUMBERS: Final = {
    **dict.fromkeys(("@MOVRX", "@MOVRY", "@MOVRZ", "@MOVAX", "@MOVAY", "@MOVAZ"), 1),
    **dict.fromkeys(("@MOVRALL", "@MOVAALL"), 3),
    **dict.fromkeys(("@MOVTORPOS", "@MOVTOAPOS"), 2),
}
"""Number of words after the first that have an effect; speeds have none."""
WHOLE: Final = re.compile(r"[+-]?[0-9]+")
NUMBER: Final = re.compile(r"[+-]?([0-9]+(\.[0-9]*)?|\.[0-9]+)")
"""Whole and decimal numbers; the decimals have no effect."""

UNREADABLE: Final = LineCause(
    Reason.BAD_VALUE, "the line was refused: at most 127 ASCII characters are allowed."
)
BUSY: Final = LineCause(Reason.BUSY, WARNING_TEXT[WarningCode.BUSY])
STOPPED: Final = LineCause(Reason.STOPPED, "STOP was pressed.")
CUT_SHORT: Final = LineCause(Reason.STOPPED, "the motion ended before its goal.")
LOST: Final = LineCause(Reason.BOARD_LOST, "the board has not answered the line.")
PORT_CLOSED: Final = LineCause(Reason.CLIENT_LOST, "the program closed its port before the line was sent.")
PORT_REOPENED: Final = LineCause(Reason.CLIENT_LOST, "another program opened the port.")
REFUSED_BY_BOARD: Final = LineCause(Reason.FAULT, "the board has refused the line.")
CALNOW_FIRST: Final = LineCause(
    Reason.NOT_CALIBRATED,
    "the motion was refused: send @CALNOW first, and again after each @ENMOTORS.",
)
ZERO_FORGOTTEN: Final = LineCause(
    Reason.NOT_CALIBRATED,
    "the motion was refused: the board did not answer for a while and has lost its zero for this program. "
    "Restart the program, or let it send @CALNOW.",
)
WARNING_REASON: Final = {
    WarningCode.BUSY: Reason.BUSY,
    WarningCode.HOME_UNKNOWN: Reason.NOT_CALIBRATED,
    WarningCode.EMERGENCY: Reason.EMERGENCY,
}
"""Reasons of the warnings that explain a refusal; after other warnings the line is carried out with changes."""


class Outcomes:
    """Reports outcomes to the node; used on the controller's thread, except `overdue`."""

    def __init__(self, node: NodeInterface) -> None:
        self._node = node
        self._unexplained: ProgramLine | None = None
        """The line that the board has refused, until a warning of the board explains why."""
        self._presumed = REFUSED_BY_BOARD
        """The cause that is reported if no warning comes."""
        self._refused_s = 0.0

    def accepted(self, line: ProgramLine) -> None:
        """Report a motion that was sent to the board; other lines are reported only when they end."""
        if line.effect is Effect.MOVE:
            read = LineCause(Reason.OK, misread(line.text))
            if read.message:
                text = line.text.decode("ascii", "replace")
                self._warn(LineCause(Reason.OK, f"`{text}`: {read.message}"))
            self._record(line, read, Phase.ACCEPTED)

    def declined(
        self, line: ProgramLine, cause: LineCause, *, silent: bool = False, detail: Detail | None = None
    ) -> None:
        """Report a line that was refused before it was sent; `silent`: without a warning."""
        if not silent:
            self._warn(cause)
        phase = Phase.ACCEPTED if line.effect is Effect.MOVE else None
        self._record(line, cause, phase, detail)

    def failed(self, line: ProgramLine, error: BeatrixError) -> None:
        """Report a line that could not be sent, or that the program may not send."""
        self.declined(line, LineCause(error.reason, error.message), detail=error.detail)

    def dropped(self, line: ProgramLine) -> None:
        """Report a line that is dropped because the program has closed the port, or another has opened it."""
        if line.sent:
            self._end(line, PORT_REOPENED)
        else:
            self.declined(line, PORT_CLOSED, silent=True)

    def done(self, line: ProgramLine) -> None:
        """Report a line that was carried out."""
        cause = line.cause or LineCause(Reason.OK, "")
        if cause.reason is not Reason.OK:
            cause = LineCause(Reason.OK, "")  # the motion had just ended when STOP was pressed
        if cause.message:
            self._warn(cause)  # warn again, because the status may have dropped the warning
        self._end(line, cause)

    def not_done(self, line: ProgramLine, *, unknown: bool, zero_forgotten: bool) -> None:
        """Report a line that got NACK or no answer from the board; if the cause is unknown, first wait for a warning.

        `unknown`: NACK alone, which means an unknown line; `zero_forgotten`: as `TextLink.zero_forgotten`.
        """
        if line.effect is Effect.MOVE and not self._node.move_refused() and not refuses(line.cause):
            line.cause = CUT_SHORT
        cause = line.cause if refuses(line.cause) else explain(line, unknown=unknown)
        if cause is not None:
            self._explained(line, cause)
        elif line.effect is not Effect.NONE:
            self.report_unexplained()
            self._unexplained, self._refused_s = line, time.monotonic()
            self._presumed = REFUSED_BY_BOARD
            if line.effect is Effect.MOVE:
                self._presumed = ZERO_FORGOTTEN if zero_forgotten else CALNOW_FIRST

    def board_warned(self, line: ProgramLine | None, code: int) -> None:
        """Report a warning of the board, which explains the last refusal or precedes the answer to `line`."""
        cause = board_warning(code)
        if self._unexplained is not None and refuses(cause):
            refused, self._unexplained = self._unexplained, None
            self._explained(refused, cause)
            return
        self._warn(cause)
        if line is not None and not refuses(line.cause):
            line.cause = cause

    def overdue(self) -> bool:
        """Return whether the board has not explained a refusal within EXPLAINED_S; any thread may call it."""
        return self._unexplained is not None and time.monotonic() - self._refused_s > EXPLAINED_S

    def report_unexplained(self) -> None:
        """Report the refusal that the board has not explained."""
        line, self._unexplained = self._unexplained, None
        if line is not None:
            self._explained(line, self._presumed)

    def _explained(self, line: ProgramLine, cause: LineCause) -> None:
        if cause.reason is not Reason.STOPPED:
            self._warn(cause)
        self._end(line, cause)

    def _end(self, line: ProgramLine, cause: LineCause) -> None:
        self._record(line, cause, Phase.DONE if line.effect is Effect.MOVE else None)

    def _warn(self, cause: LineCause) -> None:
        self._node.warn(f"old program: {cause.message}")

    def _record(
        self, line: ProgramLine, cause: LineCause, phase: Phase | None, detail: Detail | None = None
    ) -> None:
        if line.effect is Effect.NONE:
            return
        text = line.text.decode("ascii", "replace")
        message = f"{text}: {cause.message}" if cause.message else text
        moved_s = time.monotonic() - line.sent_s if phase is Phase.DONE and line.sent_s is not None else 0.0
        outcome = LineCause(cause.reason, message)
        self._node.record(line.effect, line.word, outcome, phase=phase, detail=detail, duration_s=moved_s)


def refuses(cause: LineCause | None) -> bool:
    """Return whether a cause explains why a line was not carried out."""
    return cause is not None and cause.reason is not Reason.OK


def misread(text: bytes) -> str:
    """Return how the firmware reads the words of a line that are no numbers, as a clause; empty: all are numbers.

    Like the firmware of 2023 it reads a sign and digits up to the first other character, and 0 if there are none.
    """
    first, *words = text.decode("ascii", "replace").removesuffix(" ").split(" ")
    count = NUMBERS.get(first, 0)
    wrong = [f"`{word}` {read_as(word)}" for word in words[:count] if word and not NUMBER.fullmatch(word)]
    if "" in words[:count]:
        wrong.append("two spaces in a row enclose an empty word, which counts as 0")
    if (missing := count - len(words)) > 0:
        which = "the number" if count == 1 else f"{missing} of {count} numbers"
        wrong.append(f"{which} {'is' if missing == 1 else 'are'} missing and counted as 0")
    return "; ".join(wrong) + "." if wrong else ""


def read_as(word: str) -> str:
    """Return how the firmware reads a word that is no number."""
    whole = WHOLE.match(word)
    return "is no number and counts as 0" if whole is None else f"is read as {int(whole[0])}"


def board_warning(code: int) -> LineCause:
    """Return the cause that a warning of the firmware gives."""
    if code not in WARNING_TEXT:
        return LineCause(Reason.OK, f"unknown warning {code}")
    known = WarningCode(code)
    return LineCause(WARNING_REASON.get(known, Reason.OK), WARNING_TEXT[known])


def explain(line: ProgramLine, *, unknown: bool) -> LineCause | None:
    """Return the cause of a NACK that the text of the line reveals, else None; `unknown`: the board sent NACK alone."""
    words = line.text.split(b" ")
    if line.effect is Effect.ENABLE and words[1:2] != [b"ON"]:
        return LineCause(Reason.BAD_VALUE, "the line was refused: ON or OFF must follow @ENMOTORS.")
    if line.effect is not Effect.MOVE:
        return None
    if unknown:
        text = line.text.decode("ascii", "replace")
        return LineCause(
            Reason.BAD_VALUE,
            f"the motion was refused: the board does not understand `{text}`. "
            "docs/how-to/old-programs.md lists the words.",
        )
    numbers = [abs(steps(word)) for word in words[1:4]]
    if (sum(numbers[:2]) if line.word.startswith("@MOVTO") else max(numbers, default=0)) > STEPS_MAX:
        return LineCause(
            Reason.BAD_VALUE, f"the motion was refused: no number in it may be beyond {STEPS_MAX}."
        )
    return None


def steps(word: bytes) -> int:
    """Return a number as the firmware reads it: sign and digits, up to the first other character; 0 without digits."""
    found = re.match(rb"[+-]?[0-9]+", word)
    return int(found[0]) if found else 0
