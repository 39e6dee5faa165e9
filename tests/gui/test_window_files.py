"""The file dialog of choreographies never blocks clicks on STOP."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from present import present
from PyQt5.QtCore import Qt, QTimer
from PyQt5.QtTest import QTest
from PyQt5.QtWidgets import QApplication, QFileDialog, QLineEdit
from pytestqt.qtbot import QtBot

from gui.console.state.intents import Intent, SavePose, SaveSequence, Stop
from gui.window.widgets.files import FORBIDDEN, FileDialog
from gui.window.window import Window

pytestmark = pytest.mark.qt_log_ignore("This plugin does not support")  # dialogs without a display
Taken = Callable[[], list[Intent]]


@pytest.fixture(autouse=True)
def _poses(window: Window, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Save a pose, and create a file and a folder in the working folder; close the dialog afterwards."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "dance.csv").write_text("mine")
    (tmp_path / "inner").mkdir()
    window.handle(SavePose("nod"))
    yield
    if window.panels.sequence.dialog is not None:
        window.panels.sequence.dialog.close()


def opened(qtbot: QtBot, window: Window, entry: str) -> FileDialog:
    window.panels.sequence.entries[entry].trigger()
    dialog = present(window.panels.sequence.dialog)
    qtbot.waitUntil(lambda: QApplication.activeWindow() is dialog)  # keys go to the active window
    return dialog


def enter(dialog: FileDialog, name: str) -> None:
    """Type a name, and press Enter; assert that no modal box opens. A timer would close it after a second."""
    boxes: list[object] = []

    def close_boxes() -> None:
        box = QApplication.activeModalWidget()
        if box is not None:
            boxes.append(box)
            box.close()

    watch = QTimer()
    watch.setSingleShot(True)
    watch.timeout.connect(close_boxes)
    watch.start(1000)
    field = present(dialog.findChild(QLineEdit, "fileNameEdit"))
    field.selectAll()
    QTest.keyClicks(field, name)
    QTest.keyClick(field, Qt.Key.Key_Return)
    watch.stop()
    assert boxes == []
    assert QApplication.activeModalWidget() is None


@pytest.mark.parametrize("name", ["n.2", "n.2.csv.", "n.2.CSV"])
def test_a_saved_file_always_has_the_suffix_of_its_kind(
    qtbot: QtBot, window: Window, intents: Taken, tmp_path: Path, name: str
) -> None:
    dialog = opened(qtbot, window, "save_file")
    intents()
    enter(dialog, name)
    (saved,) = intents()
    assert isinstance(saved, SaveSequence)
    assert saved.file.name.lower() == "n.2.csv"
    assert saved.file.parent == tmp_path


@pytest.mark.parametrize("name", ["what?:n.2", 'my"dance"', "a\\b"])
def test_a_name_that_windows_does_not_allow_is_refused_with_its_characters(
    qtbot: QtBot, window: Window, intents: Taken, name: str
) -> None:
    dialog = opened(qtbot, window, "save_file")
    intents()
    enter(dialog, name)
    assert dialog.isVisible()
    assert all(character in dialog.notice.text() for character in name if character in FORBIDDEN)
    assert intents() == []
    enter(dialog, "allowed")
    assert len(intents()) == 1


def test_a_file_whose_suffix_was_added_is_overwritten_only_at_the_second_press(
    qtbot: QtBot, window: Window, intents: Taken, tmp_path: Path
) -> None:
    (tmp_path / "n.2.csv").write_text("mine")
    dialog = opened(qtbot, window, "save_file")
    intents()
    enter(dialog, "n.2")
    assert "n.2.csv" in dialog.notice.text()
    assert intents() == []
    field = present(dialog.findChild(QLineEdit, "fileNameEdit"))
    QTest.keyClick(field, Qt.Key.Key_Return)
    assert intents() == [SaveSequence(tmp_path / "n.2.csv")]


def test_a_file_that_exists_is_not_written_at_the_first_press(
    qtbot: QtBot, window: Window, intents: Taken, tmp_path: Path
) -> None:
    dialog = opened(qtbot, window, "save_file")
    intents()
    assert dialog.selectedFiles() == [str(tmp_path / "beatrix.csv")], "Save works at once"
    enter(dialog, "dance")
    assert dialog.labelText(QFileDialog.DialogLabel.Accept) == "Overwrite"
    assert dialog.isVisible()
    assert dialog.notice.isVisible()
    assert "dance.csv" in dialog.notice.text()
    QTest.mousePress(window.panels.stop_bar, Qt.MouseButton.LeftButton)
    assert intents() == [Stop()]
    assert (tmp_path / "dance.csv").read_text() == "mine"
    enter(dialog, "inner")
    assert dialog.directory().dirName() == "inner"
    assert not dialog.notice.isVisible()
    enter(dialog, "dance")
    assert intents() == [SaveSequence(tmp_path / "inner" / "dance.csv")]
