"""The code panel: its file, what runs, what is said about it, and the editor."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest
from gui_windows import reveal
from gui_worlds import state_after, world
from PyQt5.QtCore import Qt
from PyQt5.QtTest import QTest
from pytestqt.qtbot import QtBot
from recording_link import RecordingLink

from beatrix_zenoh.contract._generated.messages import Detail, Reason
from gui.console.link.editor import LOOK_S, Editor
from gui.console.state.actions import (
    FOLLOW,
    Action,
    EndProgram,
    OpenProgram,
    Outcome,
    RunProgram,
    WriteProgram,
)
from gui.console.state.editor import RunCode
from gui.console.state.intents import Choose, Intent, Jog, Stop
from gui.console.state.world import CodeProgress, ProgramProgress, Trouble, World
from gui.window.widgets.code_editor import PythonEditor
from gui.window.window import Window

PRESSES, MINE = Path("/home/ana/beatrix-programs/presses.py"), Path("/home/ana/mine.py")


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The folder of the user's programs, which does not exist yet."""
    monkeypatch.setenv("HOME", str(tmp_path))
    return tmp_path / "beatrix-programs"


def test_a_change_never_overwrites_presses_or_shipped_programs(folder: Path) -> None:
    before, presses = FOLLOW.read_text(encoding="utf-8"), folder / "presses.py"
    for opened, name in (
        (None, "program-1.py"),
        (None, "program-2.py"),
        (FOLLOW, "follow_the_face-1.py"),
        (presses, "program-3.py"),
    ):
        editor = Editor()
        editor.write(WriteProgram("of the presses", presses))
        assert editor.progress(0.0).file is None
        editor.open(OpenProgram(opened))
        for text in ("a = 1", name):
            editor.write(WriteProgram(text))
        assert (editor.progress(0.0).file, editor.progress(0.0).text) == (folder / name, name)
        assert (folder / name).read_text(encoding="utf-8") == name
    assert FOLLOW.read_text(encoding="utf-8") == before
    assert presses.read_text(encoding="utf-8") == "of the presses"


def test_the_newest_change_of_a_file_wins(folder: Path) -> None:
    editor, file = Editor(), folder.parent / "start.py"
    file.write_text("a = 1", encoding="utf-8")
    editor.open(OpenProgram(file))
    editor.write(WriteProgram("a = 2"))
    assert (file.read_text(encoding="utf-8"), editor.progress(2.0).text) == ("a = 2", "a = 2")
    file.write_text("a = 33", encoding="utf-8")
    seen = editor.progress(2.0 + 2 * LOOK_S)
    assert (seen.text, seen.file) == ("a = 33", file)
    editor.write(WriteProgram("a = 4", folder / "other.py"))
    assert (file.read_text(encoding="utf-8"), editor.progress(9.0).file) == ("a = 33", folder / "other.py")


def test_a_file_that_cannot_be_used_is_named(folder: Path) -> None:
    editor = Editor()
    (folder.parent / "picture.py").write_bytes(b"\xff\xfe\x00")
    for file in (folder.parent / "picture.py", folder.parent / "absent.py", folder.parent):
        editor.open(OpenProgram(file))
        assert editor.progress(0.0).trouble == Trouble("result.no_program", slots={"file": str(file)})
        assert editor.progress(0.0).file is None
    own = folder.parent / "own.py"
    own.write_text("a = 1", encoding="utf-8")
    editor.open(OpenProgram(own))
    editor.open(OpenProgram(folder.parent / "picture.py"))
    seen = editor.progress(9.0 + 2 * LOOK_S)
    assert (seen.file, seen.trouble is not None) == (own, True), (
        "the program of before stays, with the reason"
    )
    editor.write(WriteProgram("a = 2", folder))
    assert editor.progress(20.0).file == folder / "program-1.py"
    editor = Editor()
    shutil.rmtree(folder)
    folder.write_text("no folder", encoding="utf-8")
    editor.write(WriteProgram("a = 1"))
    trouble = editor.progress(0.0).trouble
    assert trouble is not None
    assert trouble.key == "result.no_write"


def coded(file: Path | None = None, **program: object) -> World:
    """Return a world with a program in the code panel, and its newest run."""
    run = replace(ProgramProgress(file or PRESSES), **program)  # type: ignore[arg-type]
    return world(code=CodeProgress(PRESSES, file, "a = 1", 1), program=run)


def test_run_writes_the_program_of_the_presses_and_runs_a_file_as_it_is() -> None:
    state = state_after(Jog("short", 1))
    text = state.view(coded()).code.text
    assert state.handle(RunCode(), coded()) == [WriteProgram(text, PRESSES), RunProgram(2, PRESSES)]
    assert state.view(coded()).code.text == text, "a run is no line of the program"
    assert state.handle(RunCode(), coded(MINE)) == [RunProgram(3, MINE)]
    assert state.view(coded(MINE, running=True)).code.run.intent == EndProgram()
    assert state.view(coded(None, running=True)).history[0].what == "program mine.py"


TAKEN = Detail(holder="ben")


@pytest.mark.parametrize(
    ("outcome", "said", "failed"),
    [
        (Outcome(1, "", accepted=True, done=True, duration_s=2.0), "Nach 2,0 s beendet", False),
        (Outcome(1, "", False, True, Reason.NOT_HOLDER, detail=TAKEN), "Zeile 7: ben ", True),
        (
            Outcome(1, "", False, True, Reason.BAD_VALUE, key="result.no_keyboard"),
            "Zeile 7: Programme im Fenster haben keine",
            True,
        ),
        (Outcome(1, "", False, True, Reason.REPLACED), "Durch eine neuere", False),
    ],
)
def test_the_end_of_a_program_is_said_with_its_line(outcome: Outcome, said: str, failed: bool) -> None:
    state, now = state_after(Choose("language", "de")), coded(MINE, line=7, output=("1",))
    state.handle(RunCode(), now)
    state.report(Outcome(1, "", accepted=True, done=False))
    state.report(outcome)
    code = state.view(now).code
    assert code.message.startswith(said)
    assert (code.failed, code.line, code.output) == (failed, 7 if failed else 0, ("1",))


# -- the editor -------------------------------------------------------------------------------------


class Writing(RecordingLink):
    """Also takes what is typed, as the real link does."""

    def do(self, action: Action) -> None:
        super().do(action)
        if isinstance(action, WriteProgram):
            self.known = replace(self.known, code=CodeProgress(PRESSES, MINE, action.text))


@pytest.fixture
def link() -> RecordingLink:
    return Writing()


@pytest.fixture
def editor(window: Window, qtbot: QtBot) -> PythonEditor:
    made = window.panels.code.program
    reveal(made)
    made.setFocus()
    qtbot.waitUntil(made.hasFocus)
    return made


def test_a_program_is_typed_with_spaces_and_indents(
    window: Window, editor: PythonEditor, intents: Callable[[], list[Intent]]
) -> None:
    editor.selectAll()
    QTest.keyClicks(editor, "for i in 1,:\r\tprint(i)\r\bpass\r\bi =")
    typed = "for i in 1,:\n        print(i)\n    pass\ni ="
    assert editor.toPlainText() == typed
    given = intents()
    assert given[-1] == WriteProgram(typed)
    assert Stop() not in given
    QTest.keyClick(editor, Qt.Key.Key_Escape)
    assert intents() == [Stop()]
    QTest.keyClick(editor, Qt.Key.Key_Z, Qt.KeyboardModifier.ControlModifier)
    assert intents() == [WriteProgram(editor.toPlainText())]
    QTest.keyClick(editor, Qt.Key.Key_Backtab)
    assert not editor.hasFocus()
    QTest.mouseClick(window.panels.code.run, Qt.MouseButton.LeftButton)
    assert intents() == [RunCode()]


def test_the_program_grows_until_the_user_types_and_another_one_is_shown(
    window: Window, link: RecordingLink, editor: PythonEditor
) -> None:
    for count in (1, 2, 2):
        window.handle(Jog("short", 1))
        window.refresh()
        assert editor.toPlainText().count("move") == count
        if count == 2:
            editor.insertPlainText("mine")
    window.panels.side.setCurrentIndex(0)
    link.known = replace(link.known, code=CodeProgress(PRESSES, MINE, "theirs", 2))
    window.refresh()
    assert (editor.toPlainText(), editor.isVisible()) == ("theirs", True)
    editor.undo()
    assert "mine" in editor.toPlainText()


def test_the_output_and_the_faulty_line_are_shown(
    window: Window, link: RecordingLink, editor: PythonEditor
) -> None:
    code = CodeProgress(PRESSES, MINE, "a = 1\nb = '''\nc = 3\n'''\n", 3)
    link.known = replace(link.known, code=code, program=ProgramProgress(MINE, output=("1", "2")))
    window.handle(RunCode())
    window.report(Outcome(1, "", False, True, Reason.BAD_VALUE, key="result.no_keyboard"))
    link.known = replace(link.known, program=replace(link.known.program, line=2))
    window.refresh()
    assert window.panels.code.output.toPlainText() == "1\n2"
    assert (editor.fault, editor.textCursor().blockNumber()) == (2, 1)
    states = [editor.document().findBlockByNumber(number).userState() for number in range(5)]
    assert states == [0, 1, 1, 0, 0], "a string of several lines"
    assert not window.grab().isNull()
