"""An hour of work, shortened: memory is bounded, and no threads are added."""

from __future__ import annotations

import os
import subprocess
import sys

import hour_of_work
import msgspec
import pytest
from hour_of_work import ROUNDS
from robots import ROOT, untraced

from gui.console.state.history import SHOWN
from gui.console.state.memory import KEPT

GROWTH = 50_000
"""Bytes by which the memory of our modules may grow between the two measurements."""


@pytest.mark.long("an hour of work, and tracemalloc")
def test_an_hour_of_work_needs_bounded_memory_and_no_more_threads() -> None:
    done = subprocess.run(
        [sys.executable, hour_of_work.__file__],
        env={**untraced(), "PYTHONPATH": os.pathsep.join([str(ROOT), str(ROOT / "tests/support")])},
        capture_output=True,
        text=True,
        timeout=120.0,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    kept = msgspec.json.decode(done.stdout, type=hour_of_work.Kept)
    assert kept.rows == KEPT < ROUNDS
    assert kept.undo < KEPT
    assert kept.listed == SHOWN
    assert kept.bytes[1] - kept.bytes[0] < GROWTH, kept
    assert kept.threads[1] == kept.threads[0]
