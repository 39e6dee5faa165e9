"""Run a pupil's program, and kill all that it has started: `python -I -S guard.py COMMAND...`.

The program's standard input is empty. Standard input of the guard is a pipe from the process that checks the program:
each byte interrupts the program as Ctrl-C does, and its end, also if that process was killed, kills the program. The
exit code is that of the program, 128 and the number of a signal that ended it.
The file USED in the home folder gets the processor time (s) of the program and of what it has started.
A process of its own, because a program may let no other thread run.
"""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

SUBREAPER = 36
"""PR_SET_CHILD_SUBREAPER of Linux: processes whose parent has ended become children of this process."""
USED = "used_s"
KILL_S = 2.0
"""Longest time (s) of killing: a program may start processes all the time."""
POLL_S = 0.005


def main(command: list[str]) -> int:
    """Run the program to its end, then kill the processes that it has left."""
    adopt_orphans()
    signal.signal(signal.SIGINT, lambda *_: None)  # not ignored: the program would inherit that
    program = subprocess.Popen(command, stdin=subprocess.DEVNULL)
    threading.Thread(target=obey, args=[program], daemon=True).start()
    code = program.wait()
    kill_children()
    times = os.times()
    with contextlib.suppress(OSError):  # the program has deleted its home
        Path.home().joinpath(USED).write_text(str(times.children_user + times.children_system))
    return code if code >= 0 else 128 - code


def adopt_orphans() -> None:
    """Become the parent of processes that the program has started and whose parent has ended (Linux)."""
    if sys.platform == "linux":
        import ctypes  # noqa: PLC0415 - only Linux needs it

        ctypes.CDLL(None).prctl(SUBREAPER, 1, 0, 0, 0)


def obey(program: subprocess.Popen[bytes]) -> None:
    """Interrupt and kill the program as the process says that checks it."""
    while os.read(0, 1):
        if sys.platform != "win32":
            program.send_signal(signal.SIGINT)
    program.kill()


def kill_children() -> None:
    """Kill all children of this process; their own children are then its children, too."""
    if sys.platform == "win32":
        return  # `own_children` knows none there
    end_s = time.monotonic() + KILL_S
    while (children := own_children()) and time.monotonic() < end_s:
        for child in children:
            with contextlib.suppress(OSError):
                os.kill(child, signal.SIGKILL)
        with contextlib.suppress(ChildProcessError):
            while os.waitpid(-1, os.WNOHANG)[0]:
                pass
        time.sleep(POLL_S)


def own_children() -> list[int]:
    """Return the children of this process; none where there is no /proc."""
    lists = Path("/proc/self/task").glob("*/children")
    return [int(number) for path in lists for number in path.read_text().split()]


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
