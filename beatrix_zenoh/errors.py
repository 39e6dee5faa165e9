"""One family of errors: a reason from the contract's table and a sentence that says what to do."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from beatrix_zenoh._generated.messages import Reason

QUOTED = 60
"""Characters of what was sent that a refusal repeats."""


class BeatrixError(Exception):
    """Root of all errors of this package.

    `reason` is the entry of the contract's table, `message` the sentence for people; the same
    sentence appears in SDK, command line, window and replies.
    """

    def __init__(self, reason: Reason, message: str) -> None:
        super().__init__(message)
        self.reason = reason
        self.message = message


class Refused(BeatrixError):
    """The robot, or a check on its behalf, said no; nothing has moved."""


class WrongUsage(Refused):
    """A name, an endpoint or a file that can mean nothing, whoever is asked; nobody was."""


class Interrupted(BeatrixError):
    """A motion was accepted and ended somewhere else than asked: stopped, replaced, lost."""


class NoAnswer(BeatrixError):
    """Nobody answered: no router, no robot of this name, or no reply in time."""


@contextmanager
def naming(robot: str) -> Iterator[None]:
    """Where several robots are asked, what one of them refuses begins with its name."""
    try:
        yield
    except BeatrixError as error:
        if error.message.startswith(robot):
            raise
        raise type(error)(error.reason, f"{robot}: {error.message}") from error


def quoted(text: str) -> str:
    """What was sent, in quotes and not longer than a sentence bears."""
    return repr(text if len(text) <= QUOTED else text[:QUOTED] + "…")
