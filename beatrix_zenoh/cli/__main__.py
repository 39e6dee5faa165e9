"""Run the command line: `python -m beatrix_zenoh.cli` is the same as `beatrix`.

`--program FILE ARGUMENTS` instead of a verb runs a program of the user. An error of the SDK that ends it is printed as
one line of JSON, from which the window makes its sentence.

With --with-parent before the verb it ends when its parent process has ended. Standard input is then a pipe to which the
parent writes nothing. Reading from it returns when the parent has ended, even if the parent was killed; this process
then sends itself SIGTERM.
"""

from __future__ import annotations

import os
import signal
import sys
import threading

from beatrix_zenoh.cli.app import main

STDIN = 0


def watch_parent() -> None:
    """Wait until the parent has ended, then request the shutdown of this process."""
    while os.read(STDIN, 1):
        pass
    os.kill(os.getpid(), signal.SIGTERM)


def run_program(words: list[str]) -> int:
    """Run the program in a file with its arguments; return 0, or print the error of the SDK and return its exit code."""
    import runpy

    from beatrix_zenoh.contract.errors import BeatrixError
    from beatrix_zenoh.output import exit_code, print_failure

    sys.argv = words
    sys.path.insert(0, os.path.dirname(os.path.abspath(words[0])))  # noqa: PTH100, PTH120 - as Python itself does
    try:
        runpy.run_path(words[0], run_name="__main__")
    except BeatrixError as error:
        print_failure(error.reason, error.message, error.detail)
        return exit_code(error.reason)
    return 0


if sys.argv[1:2] == ["--with-parent"]:
    del sys.argv[1]
    threading.Thread(target=watch_parent, name="beatrix-parent", daemon=True).start()
if sys.argv[1:2] == ["--program"]:
    sys.exit(run_program(sys.argv[2:]))
main()
