"""Errors of this package: a reason from the contract's table, a sentence for the user, and the data of the sentence."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Self

import msgspec

from beatrix_zenoh.contract import sentences, tracebacks
from beatrix_zenoh.contract._generated.messages import Detail, Reason

QUOTED = 60
"""Largest number of characters of a request or an argument that an error message quotes."""


class BeatrixError(Exception):
    """Base class of all errors of this package.

    `beatrix_zenoh.suggestion(error)` returns the alternative in degrees.
    """

    def __init__(self, reason: Reason, message: str = "", detail: Detail | None = None) -> None:
        """Make the sentence from reason and detail if no message is given."""
        message = message or sentences.render(reason, detail)
        super().__init__(message)
        self.reason: Reason = reason
        """An entry of the contract's table of reasons."""
        self.message: str = message
        """The sentence for the user, the same in SDK, command line, window and replies."""
        self.detail: Detail | None = detail
        """The data of the reason, if any (rad, as in messages)."""

    @property
    def data(self) -> dict[str, object]:
        """The error as values of JSON, for another process that makes its sentence in another language.

        A user's program can make an error of anything: what is no reason, or no detail, is left out.
        """
        return {
            "kind": type(self).__name__,
            "message": self.message,
            "reason": self.reason if self.reason in tuple(Reason) else None,
            "detail": msgspec.to_builtins(self.detail) if isinstance(self.detail, Detail) else None,
        }

    def __reduce__(self) -> tuple[type[Self], tuple[Reason, str, Detail | None]]:
        """Describe the error for pickle, so that one of a child process reaches its parent."""
        return type(self), (self.reason, self.message, self.detail)

    def _render_traceback_(self) -> list[str]:
        """Return the lines that IPython prints in a notebook."""
        return tracebacks.text(self).splitlines()


class Refused(BeatrixError):
    """A request that the robot, or a check before sending, has refused; nothing has moved."""


class WrongUsage(Refused):
    """An invalid argument, endpoint or file, rejected locally without sending a request."""


class Interrupted(BeatrixError):
    """A motion that was accepted and did not reach its goal, for example because of STOP or a newer motion."""


class NoAnswer(BeatrixError):
    """A request or connection without an answer; `reason` is the cause."""


@contextmanager
def naming(robot: str) -> Iterator[None]:
    """Prefix the message of an error with the name of its robot, or its place in a file."""
    try:
        yield
    except BeatrixError as error:
        if error.message.startswith(robot):
            raise
        raise type(error)(error.reason, f"{robot}: {error.message}", error.detail) from error


def quoted(text: str) -> str:
    """Return a text in quotes, at most QUOTED characters of it."""
    return repr(text if len(text) <= QUOTED else text[:QUOTED] + "…")


def bad_value(message: str) -> Refused:
    """Return a BAD_VALUE refusal that is a sentence only: what is wrong, and what to do."""
    return Refused(Reason.BAD_VALUE, message)


def wrong_usage(message: str) -> WrongUsage:
    """Return the same error as `bad_value` for what is rejected without sending a request."""
    return WrongUsage(Reason.BAD_VALUE, message)
