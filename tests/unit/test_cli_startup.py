"""The start of the command line: Ctrl-C during imports, and the modules that it imports."""

from __future__ import annotations

import json
import signal
from pathlib import Path

import pytest
from robots import Process, python

import beatrix_zenoh
from beatrix_zenoh import BeatrixError, Robot


@pytest.mark.parametrize(
    ("words", "library"),
    [("beatrix_zenoh.cli ls", "typer"), ("hw_node", "serial")],
)
def test_ctrl_c_during_an_import_prints_no_traceback(
    words: str, library: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / f"{library}.py").write_text('import sys\nprint("here", flush=True)\nsys.stdin.read()\n')
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    process = Process("-m", *words.split(), listens=True)
    process.expect("here")
    assert process.end(signal.SIGINT) == 130
    assert process.lines == ["here"]


def test_ctrl_c_that_a_library_turns_into_an_import_error_is_ctrl_c(tmp_path: Path) -> None:
    (tmp_path / "typer.py").write_text(
        "try:\n    raise KeyboardInterrupt\nexcept KeyboardInterrupt as error:\n    raise ImportError('core') from error\n"
    )
    done = python(tmp_path, "-m", "beatrix_zenoh.cli", "ls", PYTHONPATH=str(tmp_path))
    assert (done.returncode, done.stdout, done.stderr) == (130, "", "")


def test_importing_the_package_imports_none_of_its_modules(tmp_path: Path) -> None:
    code = "import sys, beatrix_zenoh; print([name for name in sys.modules if name.startswith('beatrix_zenoh.')])"
    assert python(tmp_path, "-c", code).stdout == "[]\n"


def test_the_package_provides_the_names_that_dir_lists() -> None:
    names = {"BeatrixError", "Interrupted", "NoAnswer", "Refused", "Robot", "Plan", "Twin"}
    assert names <= set(dir(beatrix_zenoh))
    assert {getattr(beatrix_zenoh, name).__name__ for name in names} == names
    assert not hasattr(beatrix_zenoh, "Rowboat")


def test_help_imports_neither_verbs_nor_slow_packages(tmp_path: Path) -> None:
    code = (
        "import sys\nfrom beatrix_zenoh.cli import app, verbs\nassert app.run(['--help']) == 0\n"
        "slow = {'numpy', 'rerun', 'matplotlib', 'mujoco', 'rich', 'zenoh', 'email'}\n"
        "slow |= {f'beatrix_zenoh.{name}' for name in verbs.VERBS.values()}\n"
        "print('slow:', [name for name in slow if name in sys.modules])"
    )
    assert python(tmp_path, "-c", code).stdout.splitlines()[-1] == "slow: []"


# -- an error of BEATRIX that ends a program shows the program's own lines and the sentence --------


HEAD = "from beatrix_zenoh import Robot\n"
CALL = 'Robot("bea1", connect="nowhere")'
SENTENCE = "WrongUsage: 'nowhere' is not an endpoint."
OURS = "robot_base.py"


def errors_of(folder: Path, text: str, **environment: str) -> list[str]:
    """Run a program and return the lines that it writes to stderr."""
    (folder / "prog.py").write_text(HEAD + text, encoding="utf-8")
    done = python(folder, "prog.py", **environment)
    return [line for line in done.stderr.splitlines() if "^^^" not in line]


def test_an_uncaught_error_shows_only_the_lines_of_the_program(tmp_path: Path) -> None:
    program = f"def drive():\n    {CALL}.look()\ntry:\n    1/0\nexcept ArithmeticError:\n    drive()\n"
    *lines, sentence = errors_of(tmp_path, program)
    # Python 3.13 also marks the call.
    assert [line for line in lines if line.strip("~^ ")] == [
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


def test_other_errors_are_shown_as_python_shows_them(tmp_path: Path) -> None:
    assert errors_of(tmp_path, "1/0")[-1] == "ZeroDivisionError: division by zero"


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
