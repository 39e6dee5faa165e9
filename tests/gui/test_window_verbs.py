"""The window as a child of `beatrix up`, its end, and the refusal if the extra `gui` is not installed."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from robots import START_S, Process, free_endpoint

from beatrix_zenoh import Robot
from beatrix_zenoh import bus as zbus
from beatrix_zenoh.processes import Role, Supervisor, watch
from beatrix_zenoh.shutdown import Shutdown

CLI = ("-m", "beatrix_zenoh.cli")


@pytest.fixture(autouse=True)
def folders(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Set the folders of processes for choices and temporary files."""
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    monkeypatch.setenv("TMPDIR", str(tmp_path))


def window_of(process: Process) -> int:
    """Return the process number of the window."""
    for listing in Path(f"/proc/{process.pid}/task").glob("*/children"):
        for number in listing.read_text().split():
            if "gui" in Path(f"/proc/{number}/cmdline").read_text().split("\0"):
                return int(number)
    raise AssertionError("no window")


def test_the_robots_of_up_go_on_without_their_window() -> None:
    report = "The window has ended (SIGKILL)"
    endpoint = free_endpoint()
    up = Process(*CLI, "up", "--gui", "--connect", endpoint, "--name", "bea", "--no-sim", "--hw", "virtual:")
    try:
        up.expect("The output of all processes")
        os.kill(window_of(up), signal.SIGKILL)
        assert up.expect(report).startswith(f"{report}; the robots continue to run.")
        up.expect(f"To start it again: beatrix gui --name bea --connect {endpoint}")
        with Robot("bea", "hw", connect=endpoint) as robot:
            robot.make_ready()
        assert up.end(signal.SIGINT) == 0
    finally:
        up.end(signal.SIGKILL)


def test_a_demo_ends_with_its_window(capfd: pytest.CaptureFixture[str]) -> None:
    endpoint = free_endpoint()
    with Supervisor() as supervisor:
        window = supervisor.start("window", "router", "--listen", endpoint, role=Role.WINDOW)
        supervisor.wait_ready()
        window.end()
        watch(supervisor, Shutdown(), last=window)
        assert not zbus.is_listening(endpoint)


def test_without_the_extra_the_refusal_names_it() -> None:
    package = "PyQt5"
    code = f"import sys; sys.modules[{package!r}] = None; from beatrix_zenoh.cli.app import run; sys.exit(run(['gui']))"
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, timeout=START_S, check=False
    )
    assert done.returncode == 1
    assert done.stderr.startswith(f"`beatrix gui` needs {package}")
    assert 'pip install ".[gui]"' in done.stderr
    assert done.stderr.count("\n") == 1
