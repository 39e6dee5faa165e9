"""`beatrix lesson`: the folders of a pupil, checks, hints, resets and solutions, with a lesson that needs no robot."""

from __future__ import annotations

import datetime as dt
import json
import shutil
import subprocess
from pathlib import Path
from types import SimpleNamespace
from typing import Literal

import pytest
from shell import beatrix

from beatrix_zenoh import account, lesson_files
from beatrix_zenoh.account import Account
from beatrix_zenoh.client import lesson_reports
from beatrix_zenoh.contract._generated.messages import LessonState
from beatrix_zenoh.lessons import program, progress, sandbox

FILES = {
    "lesson.toml": 'title = "Double"\ntitle_de = "Doppelt"\nlevel = "S"\nminutes = 5\ngoal = "Double it."\nlimit_s = 5\n',
    "lesson.md": "# Double\n\nRead.\n\n## 1. Predict\n\n## 2. Run\n\n## 3. Modify\n\nAll.\n",
    "lesson.de.md": "# Doppelt\n",
    "start.py": '"""Double."""\n\n# %% Double\ndef double(x):\n    return x\n',
    "solution.py": "def double(x):\n    return 2 * x\n",
    "check.py": "def check(attempt):\n    found = attempt.call('double', 3)\n    attempt.require('six', found == 6, value=found)\n",
    "hints.toml": 'hints = ["One.", "Two.", "Three."]\n[figures.six]\nasked = "6 of 3"\nfound = "{value:g}"\nmeans = "Add it."\nhint = 2\n',
}
START, NOTEBOOK = Path("lessons/01-double/start.py"), Path("lessons/01-double/start.ipynb")


@pytest.fixture(autouse=True)
def pupil(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A pupil in an empty folder, with one lesson to choose."""
    library = tmp_path / "library"
    (library / "01-double").mkdir(parents=True)
    for name, text in FILES.items():
        (library / "01-double" / name).write_text(text)
    for path in lesson_files.LIBRARY.glob("figures*.toml"):
        (library / path.name).write_bytes(path.read_bytes())
    monkeypatch.setattr(lesson_files, "LIBRARY", library)
    (tmp_path / "pupil").mkdir()
    monkeypatch.chdir(tmp_path / "pupil")
    return tmp_path / "pupil"


def good(*words: str) -> str:
    done = beatrix("lesson", *words)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def refused(*words: str) -> str:
    done = beatrix("lesson", *words)
    assert done.returncode == 1, done.stdout + done.stderr
    return done.stderr


def checked(*words: str) -> subprocess.CompletedProcess[str]:
    return beatrix("lesson", "check", *words)


def test_a_pupil_starts_fails_reads_the_hint_and_passes() -> None:
    text = good("start", "1")
    assert "Double it." in text
    assert str(START) in text
    done = checked()
    assert done.returncode == 1
    assert [line.split() for line in done.stdout.splitlines()[1:4]] == [
        ["asked", "6", "of", "3"],
        ["found", "3"],
        ["Add", "it."],
    ]
    assert "Hint 2/3: Two." in good("hint", "1")
    assert "Hint 1/3: One." in good("hint"), "of the lesson whose program was saved last"
    START.write_text(FILES["solution.py"])
    assert checked("1").stdout.splitlines()[0] == "Passed: Double."
    assert "2 * x" in good("solution", "1")
    record = progress.workspace(Path.cwd()).record("01-double")
    assert (record.tries, record.hints, record.figure) == (2, [2, 1], "")
    assert record.passed == [progress.sealed("01-double", program.read(START).sha256)]


def test_a_start_is_never_overwritten(pupil: Path) -> None:
    good("start", "1")
    START.write_text("mine")
    assert "lesson reset 1" in refused("start", "1")
    assert START.read_text() == "mine"
    good("reset", "1")
    assert START.read_text() == FILES["start.py"]
    assert (pupil / "lessons/01-double/start-1.py").read_text() == "mine"


def test_a_lesson_must_exist_and_be_started() -> None:
    for words in (("check",), ("check", "1"), ("reset", "1")):
        assert "lesson start 1" in refused(*words)
    assert "choose one of 1" in refused("start", "7")


def test_german_is_chosen_once() -> None:
    text = good("start", "1", "--language", "de").splitlines()
    assert (text[0], text[-1]) == ("Lektion 1: Doppelt (5 Minuten)", "  prüfen   beatrix lesson watch 1")
    assert START.with_name("lesson.md").read_text() == "# Doppelt\n"
    assert checked("1").stdout.splitlines()[0] == "Noch nicht: Doppelt (Versuch 1)."


def test_a_notebook_is_checked_like_a_program_and_an_error_names_its_cell() -> None:
    good("start", "1", "--notebook")
    made = json.loads(NOTEBOOK.read_text())
    assert [(cell["cell_type"], "".join(cell["source"])) for cell in made["cells"]] == [
        ("markdown", "# Double\n\nRead."),
        ("markdown", "## 1. Predict"),
        ("markdown", "## 2. Run"),
        ("markdown", "### Double"),
        ("code", "def double(x):\n    return x"),
        ("markdown", "## 3. Modify\n\nAll."),
        ("code", "# Save the notebook, then run this cell.\n!beatrix lesson check 1"),
    ]
    lines = ["%matplotlib inline\n", "def double(x):\n", "    return 2 * x\n"]
    code = made["cells"][4]
    code["source"] = lines
    NOTEBOOK.write_text(json.dumps(made))
    assert checked("1").returncode == 0
    code["source"] = [*lines, "undefined\n"]
    NOTEBOOK.write_text(json.dumps(made))
    assert "NameError: name 'undefined' is not defined (cell 1, line 4)" in checked("1").stdout


@pytest.mark.parametrize(
    ("text", "figure"),
    [
        ("def double(x):\n    pass\n", "returns"),
        ("def double(x):\n    return 10**400\n", "returns"),
        ("def twice(x):\n    return 2 * x\n", "function"),
        ("def double(x):\n    return x / 0\n", "runs"),
        ("import os\ndef double(x):\n    os._exit(3)\n", "runs"),
        ("def double(x):\n    return int(input())\n", "keyboard"),
        ("from beatrix_zenoh import Robot\nRobot().home()\n", "import"),
        ("from beatrix_zenoh import Robot\ndef double(x):\n    Robot().home()\n", "calculates"),
        ("def double(x):\n    return 9**9**9\n", "ends"),  # in C, where no thread of Python runs
    ],
)
def test_errors_of_a_function_are_figures_of_every_lesson(
    text: str, figure: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("beatrix_zenoh.lessons.attempt.CALL_S", 0.3)
    good("start", "1")
    START.write_text(text)
    document = json.loads(checked("1", "--json").stdout)
    assert document["figure"] == figure
    assert "{" not in document["asked"] + document["found"] + document["message"]
    assert "Traceback" not in document["found"]


@pytest.mark.parametrize("entry", ["00", "sha256", "sha256-00", "of another lesson"])
def test_a_progress_file_written_by_hand_counts_for_nothing(
    entry: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    published: list[LessonState] = []
    monkeypatch.setattr(lesson_reports, "_publish", lambda *sent: published.append(sent[-1]))
    monkeypatch.setattr(lesson_reports, "resolve", lambda: SimpleNamespace(account=1))
    good("start", "1")
    sha256 = program.read(START).sha256
    written = progress.sealed("02-steps", sha256) if "another" in entry else entry.replace("sha256", sha256)
    path = Path("lessons/progress.json")
    path.write_text(path.read_text().replace('"passed": []', f'"passed": ["{written}"]'))
    assert written in path.read_text()
    assert json.loads(good("list", "--json"))["lessons"][0]["state"] == "started"
    assert "has not passed yet" in refused("turn", "1", "--name", "bea1")
    assert "--show" in refused("solution", "1")
    assert "2 * x" in good("solution", "1", "--show")
    good("hint", "1")
    assert [state.passed for state in published] == [False]


def test_tries_at_one_figure_are_counted_and_a_renamed_figure_has_the_first_hint() -> None:
    assert json.loads(good("list", "--json"))["lessons"][0]["state"] == "-"
    good("start", "1")
    assert "started" in good("list")
    for _ in range(3):
        checked("1")
    assert "tried 3 x" in good("list")
    record = progress.workspace(Path.cwd()).record("01-double")
    assert (record.tries, record.figure, record.stuck) == (3, "six", 3)
    path = Path("lessons/progress.json")
    path.write_text(path.read_text().replace('"six"', '"renamed"'))
    assert "Hint 1/3" in good("hint", "1")


def test_a_program_that_was_saved_during_its_check_is_neither_passed_nor_judged() -> None:
    good("start", "1")
    START.write_text("def double(x):\n    open(__file__, 'a').write('# mine')\n    return 2 * x\n")
    done = checked("1")
    assert (done.returncode, "start.py was saved while it was checked" in done.stdout) == (4, True)
    record = progress.workspace(Path.cwd()).record("01-double")
    assert (record.tries, record.passed) == (0, [])


def test_lessons_of_another_pupil_further_up_are_not_used(
    pupil: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    good("start", "1")
    shutil.copytree("lessons", "shared")
    for own in (Path("ana"), Path("lessons/ana"), Path("shared/ana")):
        (pupil / own).mkdir()
        monkeypatch.chdir(pupil / own)
        assert f"{pupil / own}/lessons has no lesson yet" in refused("check")
        assert f"  folder   {pupil / own}/lessons/01-double\n" in good("start", "1")


@pytest.mark.parametrize(
    ("in_use", "fence", "allowed"),
    [
        ("teacher", False, False),
        ("teacher", True, False),
        ("", False, False),  # a program could read what `beatrix join` has stored
        ("", True, True),
        ("ana", False, True),
    ],
)
def test_a_check_with_the_account_of_the_teacher_is_refused(
    pupil: Path, monkeypatch: pytest.MonkeyPatch, in_use: str, fence: bool, allowed: bool
) -> None:
    roles: dict[str, Literal["student", "teacher"]] = {"teacher": "teacher", "ana": "student"}
    for name, role in roles.items():
        made = Account("8b", name, role, "tls/127.0.0.1:1", dt.date.max, "", "", "")
        (pupil / f"{name}.toml").write_text(made.text())
    good("start", "1")
    START.write_text(FILES["solution.py"])
    monkeypatch.setattr(account, "joined", lambda: pupil / "teacher.toml")
    monkeypatch.setattr(sandbox, "bubblewrap_works", lambda: fence)
    monkeypatch.setattr(sandbox.Sandbox, "_bubblewrap", lambda _: [])
    monkeypatch.setattr(lesson_reports, "report", lambda *_: None)
    monkeypatch.setenv("BEATRIX_ACCOUNT", in_use and str(pupil / f"{in_use}.toml"))
    if allowed:
        good("check", "1")
    else:
        assert "Check programs as another user of this computer" in refused("check", "1")
