"""How a check ends early."""

from __future__ import annotations


class Unmet(Exception):
    """A figure is not met; `values` fill the sentences of hints.toml."""

    def __init__(self, figure: str, **values: object) -> None:
        super().__init__(figure)
        self.figure, self.values = figure, values
        self.ended = False
        """whether the program had ended by itself before"""


class NotMeasurable(Exception):
    """The check cannot judge the program; the message says why, and what to do."""


BUSY = "This computer was too busy to measure; your program may be right. {why} Close other programs, and check again."


def busy(why: str) -> NotMeasurable:
    """Return the error of a computer that was too slow; `why` is a sentence with what was measured."""
    return NotMeasurable(BUSY.format(why=why))
