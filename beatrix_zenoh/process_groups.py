"""Process groups, and requests to end, on Linux, macOS and Windows."""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import sys
from typing import Final

GROUP: Final = None if sys.platform == "win32" else 0
"""`process_group` of a child in a group of its own, which Ctrl-C in the parent's terminal does not reach."""
NEW_GROUP: Final = getattr(subprocess, "CREATE_NEW_PROCESS_GROUP", 0)
"""`creationflags` of such a child: on Windows they do what GROUP does elsewhere."""


def ask_to_end(process: subprocess.Popen[bytes]) -> None:
    """Send SIGTERM to a process; on Windows, where that would kill it, close its standard input instead.

    A process that has no standard input from this one is killed there.
    """
    if sys.platform != "win32" or process.stdin is None:
        process.terminate()
        return
    with contextlib.suppress(OSError):
        process.stdin.close()


def ask_this_to_end() -> None:
    """Let the handlers of this process end it as SIGTERM does; os.kill of Windows would kill it without them."""
    if sys.platform == "win32":
        signal.raise_signal(signal.SIGTERM)
    else:
        os.kill(os.getpid(), signal.SIGTERM)


def kill_group(process: subprocess.Popen[bytes]) -> None:
    """Kill a process that leads a group, and the processes of the group; on Windows, which has none, the process."""
    if sys.platform == "win32":
        process.kill()
        return
    # PermissionError: macOS, if all have ended.
    with contextlib.suppress(ProcessLookupError, PermissionError):
        os.killpg(process.pid, signal.SIGKILL)
