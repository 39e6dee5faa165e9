"""The processes that tests start."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

from robots import ROOT, free_endpoint, until

PROGRAM = """
import os, signal, sys
sys.path.insert(0, "tests/support")
import robots
print(robots.start_router(sys.argv[1]).pid, flush=True)
os.kill(os.getpid(), signal.SIGKILL)
"""


def runs(pid: int) -> bool:
    """Return whether a process runs."""
    try:
        return Path(f"/proc/{pid}/stat").read_text(encoding="utf-8").rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


def test_a_router_ends_with_the_tests_that_were_killed() -> None:
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM, free_endpoint()],
        cwd=ROOT,
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert done.stdout, done.stderr
    router = int(done.stdout)
    until(lambda: not runs(router), "the router has ended")
