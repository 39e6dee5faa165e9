"""A process that measures how long this computer delays a process that is ready to run.

Robots move in real time. If the computer, or the host of a virtual machine, stops all processes for a while, a time that
a test measured meanwhile may be too long: tests/support/late_tests.py.

`python tests/support/stall_monitor.py` prints the monotonic time and the delay (s): at its start, and whenever it wakes up later than
STALL_S.
"""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

STALL_S = 0.25
"""Shortest delay (s) that counts: a busy computer delays a process that seldom runs by less."""
PERIOD_S = 0.02
REPORT_S = 0.1
"""Time (s) to report a delay that ended just now."""


class Witness:
    """Runs the measuring process and stores the delays that it prints."""

    def __init__(self) -> None:
        self._stalls: list[tuple[float, float]] = []
        self._pause = threading.Event()
        self._child = subprocess.Popen(
            [sys.executable, "-S", str(Path(__file__).resolve())], stdout=subprocess.PIPE, text=True
        )
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()

    def _read(self) -> None:
        assert self._child.stdout is not None
        for line in self._child.stdout:
            woke_s, late_s = map(float, line.split())
            self._stalls.append((woke_s, late_s))

    def paused_s(self, since_s: float) -> float:
        """Return the sum of all delays above STALL_S since a time of the monotonic clock (s)."""
        self._pause.wait(REPORT_S)
        return sum(late_s for woke_s, late_s in self._stalls if woke_s >= since_s)

    def close(self) -> None:
        """End the process."""
        self._child.kill()
        self._child.wait()
        self._reader.join()
        assert self._child.stdout is not None
        self._child.stdout.close()


def main() -> None:
    """Measure until this process is killed or its parent has ended."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    parent = os.getppid()
    due_s = time.monotonic()
    print(due_s, 0.0, flush=True)
    while os.getppid() == parent:
        due_s += PERIOD_S
        time.sleep(max(0.0, due_s - time.monotonic()))
        woke_s = time.monotonic()
        if woke_s - due_s > STALL_S:
            print(woke_s, woke_s - due_s, flush=True)
            due_s = woke_s


if __name__ == "__main__":
    main()
