"""Short tracebacks: an error of BEATRIX shows the lines of the user's program, not those of the library."""

from __future__ import annotations

import os
import sys
import threading
from collections.abc import Callable
from pathlib import Path
from types import TracebackType
from typing import TypeVar

import msgspec

VARIABLE = "BEATRIX_TRACEBACK"
"""Environment variable; with the value `full` tracebacks are complete."""
DATA = "data"
"""Value of VARIABLE with which a line of JSON follows a traceback: the error as data, for the parent process."""
LIBRARIES = tuple(f"{Path(file).parent}{os.sep}" for file in (str(Path(__file__).parent), os.__file__))
"""Folders of BEATRIX and of Python's own modules."""
INSTALLED = f"-packages{os.sep}"
"""Part of the paths of installed packages, such as IPython, which runs the cells of a notebook."""


E = TypeVar("E", bound=Exception)


def install(kind: type[E], data: Callable[[E], object]) -> None:
    """Print errors of this kind with a short traceback, unless the program has a hook of its own and VARIABLE is not DATA.

    `data` returns an error as values of JSON.
    """
    for_parent = os.environ.get(VARIABLE) == DATA

    def show(of: type[BaseException], error: BaseException, trace: TracebackType | None) -> None:
        if isinstance(error, kind):
            sys.stderr.write(text(error))
            if for_parent:
                sys.stderr.write(msgspec.json.encode(data(error)).decode() + "\n")
        else:
            sys.__excepthook__(of, error, trace)

    def show_in_thread(args: threading.ExceptHookArgs) -> None:
        if isinstance(args.exc_value, kind):
            name = args.thread.name if args.thread is not None else ""
            sys.stderr.write(f"Exception in thread {name}:\n{text(args.exc_value)}")
        else:
            threading.__excepthook__(args)

    if for_parent or sys.excepthook is sys.__excepthook__:
        sys.excepthook = show
    if threading.excepthook is threading.__excepthook__:
        threading.excepthook = show_in_thread


def text(error: BaseException) -> str:
    """Return the traceback of an error: the lines of the user's program only, and no other errors that caused it."""
    import traceback  # noqa: PLC0415 - only after an error

    found = traceback.TracebackException.from_exception(error)
    if os.environ.get(VARIABLE) == "full":
        return "".join(found.format())
    program = getattr(sys.modules["__main__"], "__file__", None)
    own = [frame for frame in found.stack if frame.filename == program or not _is_library(frame.filename)]
    if own:
        found.stack[:] = own
        found.__cause__ = found.__context__ = None
    name = type(error).__name__
    return "".join(found.format()).replace(f"\n{type(error).__module__}.{name}:", f"\n{name}:")


def _is_library(file: str) -> bool:
    return file.startswith((*LIBRARIES, "<frozen ")) or INSTALLED in file
