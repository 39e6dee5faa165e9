"""One line of a program of 2023, its effect on the robot, and its answer."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import Enum, auto
from typing import Final, NamedTuple

from beatrix_zenoh.contract._generated import serial as wire
from beatrix_zenoh.contract._generated.messages import Reason

ACK: Final = b"ACK\n"
NACK: Final = b"NACK\n"
UNKNOWN: Final = (NACK,)
"""The answer to a line that is not in the protocol."""
REFUSED: Final = (ACK, NACK)
"""The answer to a line that is in the protocol and is not carried out."""


class Effect(Enum):
    """Effect of a line on the robot."""

    NONE = auto()
    MOVE = auto()
    ENABLE = auto()
    DISABLE = auto()
    CALIBRATE = auto()
    STOP = auto()


class LineCause(NamedTuple):
    """The reason why a line was not carried out; with reason OK, a description of how it was changed."""

    reason: Reason
    message: str


@dataclass
class Answer:
    """The board's answer to a line: the port writes its first line at once, the others together with the last."""

    begun: bool = False
    """whether the first line was written"""
    damaged: bool = False
    """whether the serial link has lost a line of the answer"""
    held: list[bytes] = field(default_factory=list)

    def add(self, text: bytes) -> list[bytes]:
        """Add a line that is not the last; return the lines to write now."""
        if self.begun:
            self.held.append(text)
            return []
        self.begun = True
        return [ACK if self.damaged else text]

    def finish(self, last: bytes, *, data: bool) -> list[bytes]:
        """Add the last line; return the lines to write now.

        The program gets as many lines as the protocol requires, even if the link has lost some of them. With `data` the
        lost lines contained numbers, which the port cannot replace, so the last line is NACK.
        """
        if not self.damaged:
            return [*self.held, last]
        end = NACK if data else last
        return [end] if self.begun else [ACK, end]

    def refuse(self, refusal: tuple[bytes, ...]) -> list[bytes]:
        """Return the lines of a refusal that are still to be written."""
        return list(refusal[int(self.begun) :] or refusal[-1:])


@dataclass(eq=False)
class ProgramLine:
    """A line in the queue; two lines with the same text are different lines."""

    text: bytes
    effect: Effect = field(init=False)
    sent_s: float | None = None
    """when it was sent to the board (s, monotonic clock); None: not sent"""
    refusal: tuple[bytes, ...] = ()
    """the answer of this port instead of the board's; empty: the line was not refused"""
    cause: LineCause | None = None
    answer: Answer = field(default_factory=Answer)

    def __post_init__(self) -> None:
        self.effect = effect_of(self.text)

    @property
    def sent(self) -> bool:
        """Whether the line was sent to the board and not refused since."""
        return self.sent_s is not None and not self.refusal

    @property
    def waits(self) -> bool:
        """Whether the line was neither sent nor refused."""
        return self.sent_s is None and not self.refusal

    @property
    def word(self) -> str:
        """The first word of the line."""
        return self.text.partition(b" ")[0].decode("ascii", "replace")

    @property
    def requests_numbers(self) -> bool:
        """Whether the answer to the line has lines of numbers."""
        return self.text.startswith(b"@GET")


def effect_of(text: bytes) -> Effect:
    """Return the effect of a line; unknown words that begin with @MOV count as motions."""
    words = text.split(b" ")
    if text == b"@STOPALL":
        return Effect.STOP
    if text == b"@CALNOW":
        return Effect.CALIBRATE
    if words[0].startswith(b"@MOV"):
        return Effect.MOVE
    if words[0] == b"@ENMOTORS":
        return Effect.DISABLE if words[1:2] == [b"OFF"] else Effect.ENABLE
    return Effect.NONE


def readable(text: bytes) -> bool:
    """Return whether the firmware would accept `text` as a line."""
    return (
        text.startswith(b"@") and len(text) <= wire.TEXT_LINE_MAX and text.isascii() and min(text) >= ord(" ")
    )
