"""Ctrl-C at once: the command line is quiet before it has read its own verbs."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

import beatrix_zenoh


@pytest.mark.parametrize(
    ("words", "library"),
    [
        ("beatrix_zenoh.cli ls", "typer"),
        ("beatrix_zenoh.cli ls", "msgspec"),
        ("beatrix_zenoh.cli look", "zenoh"),
        ("beatrix_zenoh.cli --help", "typer"),
        ("beatrix_zenoh.cli hw", "serial"),
        ("beatrix_zenoh.cli sim", "mujoco"),
        ("hw_node", "typer"),
        ("hw_node", "serial"),
        ("sim_node", "typer"),
    ],
)
def test_ctrl_c_during_an_import_is_quiet(words: str, library: str, tmp_path: Path) -> None:
    (tmp_path / f"{library}.py").write_text('import sys\nprint("here", flush=True)\nsys.stdin.read()\n')
    with subprocess.Popen(
        [sys.executable, "-m", *words.split()],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env={**os.environ, "PYTHONPATH": os.pathsep.join((str(tmp_path), os.environ.get("PYTHONPATH", "")))},
    ) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "here\n"
        process.send_signal(signal.SIGINT)
        assert process.communicate(timeout=20) == ("", "")
    assert process.returncode == 130


def test_ctrl_c_that_is_ignored_stays_ignored() -> None:
    code = "import signal; from beatrix_zenoh.cli.hurry import nothing_to_undo\n"
    code += "with nothing_to_undo(): signal.raise_signal(signal.SIGINT)"
    ignoring = f"import signal; signal.signal(signal.SIGINT, signal.SIG_IGN)\n{code}"
    assert subprocess.run([sys.executable, "-c", ignoring], check=False).returncode == 0
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 130


def test_package_imports_nothing_until_it_is_asked() -> None:
    code = "import sys, beatrix_zenoh; print([name for name in sys.modules if name.startswith('beatrix_zenoh.')])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "[]\n"


def test_package_has_what_it_says_it_has() -> None:
    names = {"BeatrixError", "Interrupted", "NoAnswer", "Refused", "Robot", "Plan", "Twin"}
    assert names <= set(dir(beatrix_zenoh))
    assert {getattr(beatrix_zenoh, name).__name__ for name in names} == names
    assert not hasattr(beatrix_zenoh, "Rowboat")
