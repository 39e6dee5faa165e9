"""How every verb ends: one sentence and an exit code, never a traceback."""

from __future__ import annotations

import functools
import sys
from collections.abc import Callable, Mapping
from typing import NoReturn, ParamSpec

import msgspec
import typer

from beatrix_zenoh._generated.messages import Reason
from beatrix_zenoh.errors import BeatrixError

P = ParamSpec("P")

FAILED, NOBODY, TIMED_OUT, INTERRUPTED = 1, 3, 4, 130
"""Exit codes; 0 is done, 2 (from typer) is usage, 130 is what shells give to Ctrl-C."""
CODES = {Reason.NO_ANSWER: NOBODY, Reason.NO_ROUTER: NOBODY, Reason.TIMED_OUT: TIMED_OUT}


def exit_code(reason: Reason) -> int:
    """Exit code of a failure."""
    return CODES.get(reason, FAILED)


def verb(function: Callable[P, None]) -> Callable[P, None]:
    """Turn what a verb raises into a sentence and an exit code; Ctrl-C into 130."""

    @functools.wraps(function)
    def run(*args: P.args, **kwargs: P.kwargs) -> None:
        try:
            function(*args, **kwargs)
        except BeatrixError as error:
            fail(error, as_json=bool(kwargs.get("as_json")))
        except KeyboardInterrupt:
            raise typer.Exit(INTERRUPTED) from None

    return run


def fail(error: BeatrixError, *, as_json: bool) -> NoReturn:
    """Say what went wrong and end."""
    if as_json:
        document({"result": False, "reason": error.reason, "message": error.message})
    else:
        note(error.message)
    raise typer.Exit(exit_code(error.reason)) from error


def say(text: str) -> None:
    """A line for people or pipes."""
    print(text, flush=True)


def note(text: str) -> None:
    """A line beside the result: on stderr."""
    print(text, file=sys.stderr, flush=True)


def document(content: Mapping[str, object]) -> None:
    """One JSON document on one line."""
    print(msgspec.json.encode(content).decode(), flush=True)
