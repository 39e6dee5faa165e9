"""The child process of a check that calls functions of a pupil's file: one request and one answer a line.

`python -m beatrix_zenoh.lessons.function_child FILE`. The file is imported, not run: `__name__` is not "__main__".
"""

from __future__ import annotations

import contextlib
import faulthandler
import importlib.util
import json
import os
import signal
import sys
import time
import traceback
from collections.abc import Callable, Iterator
from pathlib import Path
from types import ModuleType
from typing import IO

import msgspec

from beatrix_zenoh.lessons.phrases import ErrorData, error_data

SLOWER = 10.0
"""A call may take this many times its limit on a busy computer, as long as it does not use the processor."""
ALARM_CODE: int | None = None
if sys.platform != "win32":
    ALARM_CODE = -signal.SIGPROF
"""Exit code of a process that has used up its processor time; Windows limits the time only, not that of the processor."""
STDERR = 2
ODD = 60
"""Longest text of a value that an answer quotes."""


class FunctionReply(msgspec.Struct):
    """An answer: the value of a function, or what stands in place of it."""

    value: object = None
    used_s: float = 0.0
    """processor time (s) of the call"""
    error: ErrorData | None = None
    line: int = 0
    """of the pupil's file, in which it was raised; 0: not known"""
    missing: list[str] | None = None
    """the functions of the file, if the one that was asked for is not among them"""
    odd: str = ""
    """a value that JSON cannot hold"""


def main(words: list[str]) -> int:
    """Answer requests of the parent until it closes the pipe."""
    answers = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)  # what the pupil prints is no answer
    if hasattr(os, "register_at_fork"):
        os.register_at_fork(
            after_in_child=answers.close
        )  # else the parent would wait for all forks of the pupil
    requests = os.fdopen(os.dup(0), encoding="utf-8")
    os.dup2(os.open(os.devnull, os.O_RDONLY), 0)  # `input()` fails at once, and takes no request
    path = Path(words[0])
    sys.path.insert(0, str(path.parent))
    try:
        with limited(float(words[1])):
            module = load(path)
    except BaseException as error:  # noqa: BLE001 - the pupil's code may raise any, SystemExit included
        write(answers, failed(error, path))
        return 1
    write(answers, FunctionReply())
    for line in requests:
        request = json.loads(line)
        with limited(request["limit_s"]):
            found = call(module, path, request["function"], request["arguments"])
        write(answers, found)
    return 0


def load(path: Path) -> ModuleType:
    """Import the file."""
    spec = importlib.util.spec_from_file_location(path.stem, path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module  # dataclasses look for their module there
    spec.loader.exec_module(module)
    return module


def call(module: ModuleType, path: Path, name: str, arguments: list[object]) -> FunctionReply:
    """Return the answer with the value of a function, or with the error."""
    function: Callable[..., object] | None = getattr(module, name, None)
    if not callable(function):
        own = [
            key for key, value in vars(module).items() if getattr(value, "__module__", "") == module.__name__
        ]
        return FunctionReply(missing=own)
    began_s = time.process_time()
    try:
        value = function(*arguments)
    except BaseException as error:  # noqa: BLE001 - as in `main`
        return failed(error, path)
    used_s = time.process_time() - began_s
    try:
        return FunctionReply(plain(value), used_s)
    except TypeError:
        return FunctionReply(odd=repr(value)[:ODD])


def plain(value: object) -> object:
    """Return numbers, texts, lists and arrays of numpy as values of JSON; raises TypeError for anything else."""
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, list | tuple):
        return [plain(one) for one in value]
    if isinstance(value, dict):
        return {str(key): plain(one) for key, one in value.items()}
    if value is None or isinstance(value, bool | int | float | str):
        return value
    raise TypeError


def failed(error: BaseException, path: Path) -> FunctionReply:
    """Return the error, and the number of the last line of the pupil's file in its traceback."""
    if isinstance(error, SyntaxError):
        return FunctionReply(error=ErrorData(error.msg, type(error).__name__), line=error.lineno or 0)
    lines = [
        frame.lineno for frame in traceback.extract_tb(error.__traceback__) if frame.filename == str(path)
    ]
    return FunctionReply(error=error_data(error), line=(lines[-1] if lines else None) or 0)


@contextlib.contextmanager
def limited(limit_s: float) -> Iterator[None]:
    """Let the system end this process if the block uses the processor for longer than `limit_s`, or lasts SLOWER times that.

    Not a thread of Python: a calculation such as `9**9**9` lets none run.
    """
    alarm(limit_s)
    faulthandler.dump_traceback_later(SLOWER * limit_s, exit=True, file=STDERR)
    try:
        yield
    finally:
        alarm(0.0)
        faulthandler.cancel_dump_traceback_later()


def alarm(seconds: float) -> None:
    """End this process, with ALARM_CODE, after this processor time; 0: never."""
    if sys.platform != "win32":
        signal.setitimer(signal.ITIMER_PROF, seconds)


def write(answers: IO[str], answer: FunctionReply) -> None:
    """Write an answer as one line."""
    answers.write(json.dumps(msgspec.to_builtins(answer)) + "\n")
    answers.flush()


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
