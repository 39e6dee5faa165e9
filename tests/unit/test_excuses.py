"""The rule that excuses a late test: only a measured time, only if the pauses explain it, three in a run."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

SUPPORT = Path(__file__).resolve().parents[1] / "support"
CONFTEST = """
import os
import pytest
from late_tests import Excuses

class Pauses:
    def paused_s(self, since_s): return 0.4
    def close(self): print("closed")

def pytest_configure(config):
    config.addinivalue_line("markers", "measures_time: measures time")
    excuses = Excuses(counts=not hasattr(config, "workerinput"))
    excuses.witness = Pauses()
    config.pluginmanager.register(excuses)
"""
BEGINNING = """
import pytest
from late_tests import in_time, within
"""
LATE = """
@pytest.mark.measures_time
def test_late_{0}():
    in_time(1.3, 1.0, "the reply {0}")
"""
NO_EXCUSE = """
@pytest.mark.measures_time
def test_wrong_value():
    assert 1 == 2

@pytest.mark.measures_time
def test_timeout():
    raise AssertionError("not within 20 s: moving")

def test_not_marked():
    in_time(1.3, 1.0, "the reply")

@pytest.mark.measures_time
def test_later_than_the_pauses():
    in_time(1.5, 1.0, "the reply")

@pytest.mark.measures_time
def test_wrong_value_within():
    with within(-1.0, "the reply"):
        assert 1 == 2
"""


def run(folder: Path, tests: str) -> subprocess.CompletedProcess[str]:
    """Run these tests as a session of its own, on a computer that stands still for 0.4 s during each."""
    (folder / "conftest.py").write_text(CONFTEST)
    (folder / "test_these.py").write_text(BEGINNING + tests)
    command = [sys.executable, "-m", "pytest", "-c", "/dev/null", "-p", "no:cacheprovider", "-q"]
    return subprocess.run(
        [*command, f"--rootdir={folder}", f"--override-ini=pythonpath={SUPPORT}", str(folder)],
        capture_output=True, text=True, check=False, timeout=120,
    )  # fmt: skip


def test_three_late_tests_are_excused_and_printed_and_the_fourth_and_wrong_ones_fail(tmp_path: Path) -> None:
    done = run(tmp_path, NO_EXCUSE + "".join(LATE.format(name) for name in "abcd"))
    assert (done.returncode, "6 failed, 3 skipped" in done.stdout) == (1, True), done.stdout
    figures = "1.30 s, at most 1.00 s; this computer stood still for 0.40 s"
    assert sum(f"test_late_{name}: the reply {name}: {figures}" in done.stdout for name in "abcd") == 3
