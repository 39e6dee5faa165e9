"""The window's process: its ready line, its end, and the refusals at the start."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from golden import same
from present import present

PROGRAM = "import sys; from gui.window.app import main; sys.exit(main(sys.argv[1:]))"
NOWHERE = "tcp/127.0.0.1:1"
START_S, END_S = 30.0, 3.0


def start(folder: Path, *words: str, **environment: str) -> subprocess.Popen[str]:
    """Start the window, with its file of choices in this folder."""
    return subprocess.Popen(
        [sys.executable, "-c", PROGRAM, "--connect", NOWHERE, *words],
        env={**os.environ, "XDG_CONFIG_HOME": str(folder), **environment},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        cwd=folder,
    )


@pytest.mark.timeout(START_S + END_S + 10)
def test_a_signal_closes_the_window_without_an_error(tmp_path: Path) -> None:
    with start(tmp_path, "--language", "de", "--theme", "projector") as process:
        assert present(process.stdout).readline() == "ready window\n"
        begin_s = time.monotonic()
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate(timeout=END_S + 5)
        assert time.monotonic() - begin_s < END_S
    unsupported = "This plugin does not support propagateSizeHints()\n"  # Qt's screen of tests says so
    assert (process.returncode, errors.replace(unsupported, "")) == (0, "")
    assert not (tmp_path / "beatrix").exists(), "options apply to one window only"


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="elsewhere there is always a display")
@pytest.mark.parametrize("platform", ["", "wayland"])
def test_without_a_display_the_window_is_refused(tmp_path: Path, platform: str) -> None:
    environment = {"QT_QPA_PLATFORM": platform, "DISPLAY": "", "WAYLAND_DISPLAY": ""}
    with start(tmp_path, **environment) as process:
        output, errors = process.communicate(timeout=START_S)
    assert (process.returncode, output) == (1, "")
    same("window app.without a display the window is refused", errors)
