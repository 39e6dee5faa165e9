"""Run the command line: `python -m beatrix_zenoh.cli` is the same as `beatrix`.

`--program FILE ARGUMENTS` instead of a verb runs a program of the user, as Python does; it has no keyboard.

With --with-parent before the verb it ends when its parent process has ended. Standard input is then a pipe to which the
parent writes nothing. Reading from it returns when the parent has ended, even if the parent was killed; this process
then sends itself SIGTERM.
"""

from __future__ import annotations

import os
import runpy
import sys
import threading

from beatrix_zenoh.cli.app import main
from beatrix_zenoh.process_groups import ask_this_to_end

STDIN = 0


def watch_parent() -> None:
    """Wait until the parent has ended, then request the shutdown of this process."""
    while os.read(STDIN, 1):
        pass
    ask_this_to_end()


def run_program(file: str) -> None:
    """Run a program; the traceback of an error begins in it."""
    sys.path.insert(0, os.path.dirname(os.path.abspath(file)))  # noqa: PTH100, PTH120 - as Python itself does
    sys.stdin = open(os.devnull)  # noqa: PTH123, SIM115 - standard input is for `watch_parent`; `input()` would wait for ever
    try:
        runpy.run_path(file, run_name="__main__")
    except Exception as error:  # noqa: BLE001 - of any kind
        trace = error.__traceback__
        while trace is not None and trace.tb_frame.f_code.co_filename != file:
            trace = trace.tb_next
        error.__traceback__ = trace
        sys.excepthook(type(error), error, trace)
        sys.exit(1)


if sys.argv[1:2] == ["--with-parent"]:
    del sys.argv[1]
    threading.Thread(target=watch_parent, name="beatrix-parent", daemon=True).start()
if sys.argv[1:2] == ["--program"]:
    sys.argv = sys.argv[2:]
    run_program(sys.argv[0])
else:
    main()
