"""Kill a pupil's program when the process that has started both has ended: `python guard.py PID`.

Standard input is a pipe from that process; reading from it returns when the process has ended, even if it was killed. A
process of its own, because the program runs as it would without a check, and may let no other thread run.
"""

from __future__ import annotations

import contextlib
import os
import signal
import sys

STDIN = 0


def main(pid: int) -> None:
    """Wait for the end of the parent; then kill the process, which leads a group, with this group."""
    while os.read(STDIN, 1):
        pass
    with contextlib.suppress(OSError):  # it has ended, too
        if sys.platform == "win32":
            os.kill(pid, signal.SIGTERM)
        else:
            os.killpg(pid, signal.SIGKILL)


if __name__ == "__main__":
    main(int(sys.argv[1]))
