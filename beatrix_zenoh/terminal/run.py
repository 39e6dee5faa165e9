"""Run a verb, and report an expected error as one sentence and an exit code, never as a traceback."""

from __future__ import annotations

import contextlib
import errno
import io
import os
import sys
from collections.abc import Callable, Sequence
from typing import cast

import typer

from beatrix_zenoh import hiding
from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.errors import BeatrixError, Refused, WrongUsage, bad_value
from beatrix_zenoh.output import (
    FAILED,
    STDOUT,
    UNREAD,
    USAGE,
    exit_code,
    note,
    print_failure,
)
from beatrix_zenoh.shutdown import INTERRUPTED

DISK_FULL = (errno.ENOSPC, errno.EDQUOT)
USAGE_ERROR = cast("type[typer.BadParameter]", typer.BadParameter.__base__)
"""Base class of all errors of typer about wrong usage; only its subclass BadParameter is public."""


def run(app: typer.Typer, words: Sequence[str], program: str) -> int:
    """Run the verb and return the exit code. Expected errors are printed; other exceptions propagate."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")  # so that a terminal without a degree sign causes no error
    try:
        return _invoke(app, words, program)
    except OSError as error:
        if not isinstance(error, BrokenPipeError) and error.errno not in DISK_FULL:
            raise
        return unwritten(error)


def run_command(command: Callable[..., None], program: str, words: Sequence[str] | None) -> int:
    """Run a program with a single verb as `run` does; `words` are by default the arguments of the process."""
    app = typer.Typer(add_completion=False, rich_markup_mode=None)
    app.command()(command)
    return run(app, sys.argv[1:] if words is None else words, program)


def _invoke(app: typer.Typer, words: Sequence[str], program: str) -> int:
    as_json = "--json" in words  # read here, because typer may fail before it reads the option
    command = typer.main.get_command(app)
    try:
        with command.make_context(program, list(words)) as context:
            command.invoke(context)
    except typer.Exit as end:
        return end.exit_code
    except KeyboardInterrupt:
        return INTERRUPTED
    except USAGE_ERROR as error:
        if as_json:
            print_failure(Reason.BAD_VALUE, error.format_message())
        else:
            error.show()
        return USAGE
    except BeatrixError as error:
        cause = error.__cause__  # a package that cannot be imported may be hidden, not missing
        message = (isinstance(cause, ImportError) and hiding.cause(cause)) or error.message
        if as_json:
            print_failure(error.reason, message)
        else:
            note(message)
        return USAGE if isinstance(error, WrongUsage) else exit_code(error.reason)
    return 0


def unwritten(error: OSError) -> int:
    """Handle an error of writing to stdout and return the exit code; print nothing if the reader closed the pipe."""
    # At exit Python would try to write the rest of the buffer again and print another error, so replace stdout.
    null = os.open(os.devnull, os.O_WRONLY)
    os.dup2(null, STDOUT)
    if isinstance(error, BrokenPipeError):
        return UNREAD
    with contextlib.suppress(OSError):
        note(
            f"Cannot write the result: {error.strerror}. Free some space, or write the result to another disk."
        )
    return FAILED


EXTRAS = {"flash": "hw", "model": "sim"}
"""The extra of each program whose extra has another name than the program."""


def missing(process: str, error: ModuleNotFoundError) -> Refused:
    """Return the refusal for a program that needs a package that is not installed."""
    text = f"`beatrix {process}` needs {error.name}, which is not installed. {install(process)}"
    return bad_value(text)


def install(process: str) -> str:
    """Return a sentence with the command that installs the packages of `beatrix PROCESS`."""
    return f"Run `beatrix install {EXTRAS.get(process, process)}`."
