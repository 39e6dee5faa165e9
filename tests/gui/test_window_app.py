"""The window's process: its ready line, its end, the refusals at the start, and what its end means for `up` and `demo`."""

from __future__ import annotations

import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from golden import same
from robots import START_S, Process, free_endpoint

from beatrix_zenoh import bus as zbus
from beatrix_zenoh.cli.serving import start_programs
from beatrix_zenoh.processes import Role, Supervisor, watch
from beatrix_zenoh.settings import Settings
from beatrix_zenoh.shutdown import Shutdown
from gui.window.app import main

END_S = 3.0


@pytest.fixture(autouse=True)
def folders(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Set the folders of processes for choices and temporary files."""
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    monkeypatch.setenv("TMPDIR", str(tmp_path))


def test_a_signal_closes_the_window_without_an_error(tmp_path: Path) -> None:
    words = ("gui", "--connect", "tcp/127.0.0.1:1", "--language", "de", "--theme", "projector")
    process = Process("-m", "beatrix_zenoh.cli", *words, folder=tmp_path)
    process.expect("ready window")
    begin_s = time.monotonic()
    assert process.end(signal.SIGINT) == 0
    assert time.monotonic() - begin_s < END_S
    unsupported = "This plugin does not support propagateSizeHints()"  # Qt's screen of tests says so
    assert {*process.lines} - {unsupported} == {"ready window"}
    assert not (tmp_path / "beatrix").exists(), "options apply to one window only"


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="elsewhere there is always a display")
@pytest.mark.parametrize("platform", ["", "wayland"])
def test_without_a_display_the_window_is_refused(
    platform: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    for name, value in (("QT_QPA_PLATFORM", platform), ("DISPLAY", ""), ("WAYLAND_DISPLAY", "")):
        monkeypatch.setenv(name, value)
    assert main([]) == 1
    output, errors = capsys.readouterr()
    assert output == ""
    same("window app.without a display the window is refused", errors)


def test_a_window_that_ends_is_reported_by_up_and_its_robots_go_on(capfd: pytest.CaptureFixture[str]) -> None:
    where = Settings("bea", free_endpoint(), "ana")
    with Supervisor() as supervisor:
        start_programs(supervisor, where, {"gui": ["--nonsense"]})
    report = capfd.readouterr().err
    assert report.startswith("The window has ended (exit code 2); the robots continue to run.")
    assert f"To start it again: beatrix gui --name bea --connect {where.connect} --nonsense" in report


def test_a_demo_ends_with_its_window() -> None:
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
    assert "beatrix install gui" in done.stderr
    assert done.stderr.count("\n") == 1
