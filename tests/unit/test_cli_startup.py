"""The start of the command line: Ctrl-C during imports, and the modules that it imports."""

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
    [("beatrix_zenoh.cli ls", "typer"), ("hw_node", "serial")],
)
def test_ctrl_c_during_an_import_prints_no_traceback(words: str, library: str, tmp_path: Path) -> None:
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


@pytest.mark.parametrize(
    "words", [("ls",), ("look", "5")], ids=["while the verbs are loaded", "while one verb is loaded"]
)
def test_ctrl_c_that_a_library_turns_into_an_import_error_is_ctrl_c(
    words: tuple[str, ...], tmp_path: Path
) -> None:
    (tmp_path / "typer.py").write_text(
        "try:\n    raise KeyboardInterrupt\nexcept KeyboardInterrupt as error:\n    raise ImportError('core') from error\n"
    )
    path = os.pathsep.join((str(tmp_path), os.environ.get("PYTHONPATH", "")))
    done = subprocess.run(
        [sys.executable, "-m", "beatrix_zenoh.cli", *words],
        capture_output=True,
        text=True,
        timeout=30,
        check=False,
        env={**os.environ, "PYTHONPATH": path},
    )
    assert (done.returncode, done.stdout, done.stderr) == (130, "", "")


def test_importing_the_package_imports_none_of_its_modules() -> None:
    code = "import sys, beatrix_zenoh; print([name for name in sys.modules if name.startswith('beatrix_zenoh.')])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "[]\n"


def test_the_package_provides_the_names_that_dir_lists() -> None:
    names = {"BeatrixError", "Interrupted", "NoAnswer", "Refused", "Robot", "Plan", "Twin"}
    assert names <= set(dir(beatrix_zenoh))
    assert {getattr(beatrix_zenoh, name).__name__ for name in names} == names
    assert not hasattr(beatrix_zenoh, "Rowboat")


def test_help_imports_neither_verbs_nor_slow_packages() -> None:
    code = (
        "import sys\nfrom beatrix_zenoh.cli import app, verbs\nassert app.run(['--help']) == 0\n"
        "slow = {'numpy', 'rerun', 'matplotlib', 'mujoco', 'rich', 'zenoh', 'email'}\n"
        "slow |= {f'beatrix_zenoh.{name}' for name in verbs.VERBS.values()}\n"
        "print('slow:', [name for name in slow if name in sys.modules])"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, timeout=30, check=True
    )
    assert done.stdout.splitlines()[-1] == "slow: []"
