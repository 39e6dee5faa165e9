"""tools/crash.py: what a crashed process leaves behind is explained and removed."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from robots import ROOT, untraced

CRASH = (
    "import ctypes, threading; threading.Thread(target=threading.Event().wait).start(); ctypes.string_at(0)"
)
CHILD = f"import subprocess, sys; subprocess.run([sys.executable, '-c', {CRASH!r}], check=False)"


@pytest.mark.parametrize(("program", "code"), [(CRASH, 139), (CHILD, 1)], ids=["program", "child"])
def test_a_crash_prints_the_test_and_the_stacks_of_all_threads(
    tmp_path: Path, program: str, code: int
) -> None:
    done = subprocess.run(
        [sys.executable, str(ROOT / "tools/crash.py"), sys.executable, "-c", program],
        capture_output=True,
        text=True,
        cwd=tmp_path,
        env=untraced() | {"TMPDIR": str(tmp_path)},
        timeout=120.0,
        check=False,
    )
    said = done.stderr
    if "writes no core file" in said:  # this system passes core files to another program, or permits none
        assert done.returncode == (139 if code == 139 else 0)
        return
    assert done.returncode == code, said
    assert not list(tmp_path.glob("core*"))
    if shutil.which("gdb") is None:
        assert "sudo apt-get install gdb" in said
        return
    assert f"== a process crashed: {sys.executable} -c import ctypes" in said
    assert f"== in the test {os.environ['PYTEST_CURRENT_TEST']}" in said
    assert "Thread 1 (" in said
    assert "Thread 2 (" in said


def test_a_program_that_ends_well_prints_nothing(tmp_path: Path) -> None:
    for code in (0, 3):
        done = subprocess.run(
            [sys.executable, str(ROOT / "tools/crash.py"), sys.executable, "-c", f"raise SystemExit({code})"],
            capture_output=True,
            text=True,
            cwd=tmp_path,
            check=False,
        )
        assert done.returncode == code
        assert done.stdout == ""
        assert done.stderr == "" or "If a process crashed" in done.stderr
