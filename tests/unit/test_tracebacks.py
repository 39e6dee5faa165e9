"""An error of BEATRIX that ends a program shows the program's own lines and the sentence."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest
from robots import untraced

from beatrix_zenoh import BeatrixError, Robot

HEAD = "from beatrix_zenoh import Robot\n"
CALL = 'Robot("bea1", connect="nowhere")'
SENTENCE = "WrongUsage: 'nowhere' is not an endpoint."
OURS = "robot_base.py"


def errors_of(folder: Path, text: str, **environment: str) -> list[str]:
    """Run a program and return the lines that it writes to stderr."""
    (folder / "prog.py").write_text(HEAD + text, encoding="utf-8")
    done = subprocess.run(
        [sys.executable, "prog.py"],
        cwd=folder,
        env={**untraced(), **environment},
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    return [line for line in done.stderr.splitlines() if "^^^" not in line]


def test_an_uncaught_error_shows_only_the_lines_of_the_program(tmp_path: Path) -> None:
    program = f"def drive():\n    {CALL}.look()\ntry:\n    1/0\nexcept ArithmeticError:\n    drive()\n"
    *lines, sentence = errors_of(tmp_path, program)
    assert lines == [
        "Traceback (most recent call last):",
        f'  File "{tmp_path}/prog.py", line 7, in <module>',
        "    drive()",
        f'  File "{tmp_path}/prog.py", line 3, in drive',
        f"    {CALL}.look()",
    ]
    assert sentence.startswith(SENTENCE)


def test_an_error_in_a_thread_of_the_program_is_as_short(tmp_path: Path) -> None:
    lines = errors_of(
        tmp_path, f"import threading\nthreading.Thread(target=lambda: {CALL}, name='mine').start()\n"
    )
    assert lines[0] == "Exception in thread mine:"
    assert [line for line in lines if line.startswith("  File")] == [
        f'  File "{tmp_path}/prog.py", line 3, in <lambda>'
    ]
    assert lines[-1].startswith(SENTENCE)


COMPLETE = {
    "on request": (CALL, {"BEATRIX_TRACEBACK": "full"}),
    "by unittest": (
        f"import unittest\nclass Mine(unittest.TestCase):\n    def test(self):\n        {CALL}\nunittest.main()\n",
        {},
    ),
    "by a hook of the program": (
        f"import sys, traceback\nsys.excepthook = traceback.print_exception\nfrom beatrix_zenoh import Twin\n{CALL}\n",
        {},
    ),
}


@pytest.mark.parametrize("case", COMPLETE)
def test_a_traceback_is_complete(case: str, tmp_path: Path) -> None:
    program, environment = COMPLETE[case]
    assert any(OURS in line for line in errors_of(tmp_path, program, **environment))


@pytest.mark.parametrize(
    ("text", "last"), [("1/0", "ZeroDivisionError: division by zero"), ("raise SystemExit('end')", "end")]
)
def test_other_errors_are_shown_as_python_shows_them(text: str, last: str, tmp_path: Path) -> None:
    assert errors_of(tmp_path, text)[-1] == last


def test_a_parent_process_gets_the_error_as_data_whatever_hook_the_system_has(tmp_path: Path) -> None:
    program = f"import sys\nsys.excepthook = print\nfrom beatrix_zenoh import Twin\n{CALL}\n"
    *_, data = errors_of(tmp_path, program, BEATRIX_TRACEBACK="data")
    assert json.loads(data)["reason"] == "BAD_VALUE"


def test_a_notebook_shows_the_short_traceback() -> None:
    with pytest.raises(BeatrixError) as caught:
        Robot("bea1", connect="nowhere")
    lines = caught.value._render_traceback_()
    assert not any(OURS in line for line in lines)
    assert lines[-1].startswith(SENTENCE)
    assert any(__file__ in line for line in lines)
