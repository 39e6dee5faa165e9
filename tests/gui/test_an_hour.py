"""An hour of work, shortened: memory is bounded, and no threads are added."""

from __future__ import annotations

import os
import subprocess
import sys

import hour_of_work
import msgspec
from gui_views import ready
from hour_of_work import HOUR_S, ROUNDS, at
from robots import ROOT, untraced

from gui.console.state.history import SHOWN
from gui.console.state.memory import KEPT
from gui.window.widgets.plots import CAPACITY
from gui.window.window import Window

HZ = 2
"""Refreshes a second: a tenth of the window's, but enough to fill all rows several times."""
GROWTH = 50_000
"""Bytes by which the memory of our modules may grow between the two measurements."""


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


def test_the_plots_keep_their_size_for_an_hour(window: Window) -> None:
    plots, base = window.panels.plots, ready()
    sizes = [history._rows.nbytes for history in plots._histories.values()]
    for tick in range(HOUR_S * HZ):
        plots.append(at(base, tick / HZ, ()))
    assert [history._rows.nbytes for history in plots._histories.values()] == sizes
    for history in plots._histories.values():
        assert len(history.samples) == CAPACITY
        assert history.samples[-1, 0] == 100.0 + HOUR_S - 1 / HZ
