"""Run the command line: `python -m beatrix_zenoh.cli` is the same as `beatrix`.

`--program FILE ARGUMENTS` instead of a verb runs a program of the user, as Python does.

With --with-parent before the verb it ends when its parent process has ended. Standard input is then a pipe to which the
parent writes nothing. Reading from it returns when the parent has ended, even if the parent was killed; this process
then sends itself SIGTERM.
"""

from __future__ import annotations

import os
import runpy
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


if sys.argv[1:2] == ["--with-parent"]:
    del sys.argv[1]
    threading.Thread(target=watch_parent, name="beatrix-parent", daemon=True).start()
if sys.argv[1:2] == ["--program"]:
    sys.argv = sys.argv[2:]
    sys.path.insert(0, os.path.dirname(os.path.abspath(sys.argv[0])))  # noqa: PTH100, PTH120 - as Python itself does
    runpy.run_path(sys.argv[0], run_name="__main__")
else:
    main()
