"""How every verb ends: one sentence and an exit code, never a traceback."""

from __future__ import annotations

import contextlib
import errno
import io
import os
import sys
from collections.abc import Callable, Mapping, Sequence
from typing import cast

import msgspec
import typer

from beatrix_zenoh._generated.messages import Reason
from beatrix_zenoh.cli.hurry import INTERRUPTED
from beatrix_zenoh.errors import BeatrixError, WrongUsage

FAILED, USAGE, NOBODY, TIMED_OUT, UNREAD = 1, 2, 3, 4, 141
"""Exit codes; 0 is done, 141 is what shells give to a tool whose reader has gone."""
CODES = {Reason.NO_ANSWER: NOBODY, Reason.NO_ROUTER: NOBODY, Reason.TIMED_OUT: TIMED_OUT}
STDOUT = 1
STRAY = "Got unexpected extra argument"
"""How typer begins to tell of a word that belongs to no option."""
NO_ROOM = (errno.ENOSPC, errno.EDQUOT)
USAGE_ERROR = cast("type[typer.BadParameter]", typer.BadParameter.__base__)
"""What typer raises for all wrong usage; it names only this child of it in public."""


def exit_code(reason: Reason) -> int:
    """Exit code of a failure."""
    return CODES.get(reason, FAILED)


def run(app: typer.Typer, words: Sequence[str], program: str) -> int:
    """Do what the words say; the exit code. A fault of ours is raised, everything else is said."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")  # a terminal without a degree sign is no reason to fail
    try:
        return _done(app, words, program)
    except OSError as error:
        if not isinstance(error, BrokenPipeError) and error.errno not in NO_ROOM:
            raise
        return unwritten(error)


def alone(command: Callable[..., None], program: str, words: Sequence[str] | None) -> int:
    """As `run`, of a program that is one verb; words default to those of the process."""
    app = typer.Typer(add_completion=False, rich_markup_mode=None)
    app.command()(command)
    return run(app, sys.argv[1:] if words is None else words, program)


def _done(app: typer.Typer, words: Sequence[str], program: str) -> int:
    as_json = "--json" in words  # also where typer has not come so far as to read it
    command = typer.main.get_command(app)
    try:
        _check_once(command, words)
        with command.make_context(program, list(words)) as context:
            command.invoke(context)
    except typer.Exit as end:
        return end.exit_code
    except KeyboardInterrupt:
        return INTERRUPTED
    except USAGE_ERROR as error:
        error.message = _taught(error)
        if as_json:
            refusal(Reason.BAD_VALUE, error.format_message())
        else:
            error.show()
        return USAGE
    except BeatrixError as error:
        if as_json:
            refusal(error.reason, error.message)
        else:
            note(error.message)
        return USAGE if isinstance(error, WrongUsage) else exit_code(error.reason)
    return 0


def _check_once(command: object, words: Sequence[str]) -> None:
    """Raise BadParameter for an option with a value that is given twice: typer would take the last, in silence."""
    verb = getattr(command, "commands", {}).get(words[0] if words else "", command)
    for option in getattr(verb, "params", ()):
        if option.param_type_name != "option" or option.multiple or option.is_flag:
            continue
        given = [name for name in (word.partition("=")[0] for word in words) if name in option.opts]
        if len(given) > 1:
            raise typer.BadParameter(f"{given[0]} is given {len(given)} times: give it once.")


def _taught(error: typer.BadParameter) -> str:
    """The message; where a value stands alone (`beatrix hw /dev/ttyACM0`), with the options that take one."""
    if error.ctx is None or not error.message.startswith(STRAY):
        return error.message
    named = [
        max(parameter.opts, key=len)
        for parameter in error.ctx.command.params
        if parameter.param_type_name == "option" and not getattr(parameter, "is_flag", False)
    ]
    if not named:
        return error.message
    return f"{error.message}. Values follow the name of their option here: {', '.join(named)}."


def unwritten(error: OSError) -> int:
    """Nobody takes what we write: quiet if the reader has gone, as other tools are, else a sentence."""
    # What is left in the buffer would be tried, and complained of, once more when Python ends.
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, STDOUT)
    if isinstance(error, BrokenPipeError):
        return UNREAD
    with contextlib.suppress(OSError):
        note(f"Cannot write the result: {error.strerror}. Make room there, or write it elsewhere.")
    return FAILED


def say(text: str) -> None:
    """A line for people or pipes."""
    print(text, flush=True)


def note(text: str) -> None:
    """A line beside the result: on stderr."""
    print(text, file=sys.stderr, flush=True)


def document(content: Mapping[str, object]) -> None:
    """One JSON document on one line."""
    print(msgspec.json.encode(content).decode(), flush=True)


def refusal(reason: Reason, message: str) -> None:
    """A failure as JSON."""
    document({"result": False, "reason": reason, "message": message})
