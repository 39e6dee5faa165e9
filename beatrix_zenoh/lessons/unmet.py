"""How a check ends early."""

from __future__ import annotations

from beatrix_zenoh.lessons.phrases import Phrase, phrase, said


class Unmet(Exception):
    """A figure is not met; `values` fill the sentences of hints.toml, and may be phrases."""

    def __init__(self, figure: str, **values: object) -> None:
        super().__init__(figure)
        self.figure, self.values = figure, values
        self.ended = False
        """whether the program had ended by itself before"""


class NotMeasurable(Exception):
    """The check cannot judge the program; `why` says why, and what to do."""

    def __init__(self, why: Phrase) -> None:
        super().__init__(said(why))
        self.why = why


def busy(why: Phrase | str) -> NotMeasurable:
    """Return the error of a computer that was too slow; `why` is a sentence with what was measured."""
    return NotMeasurable(phrase("busy", why=why))
