"""File dialogs never block clicks on STOP."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from present import present
from PyQt5.QtCore import Qt
from PyQt5.QtTest import QTest
from PyQt5.QtWidgets import QApplication, QFileDialog, QLineEdit
from pytestqt.qtbot import QtBot

from gui.console.state.actions import WriteFile
from gui.console.state.intents import Intent, Stop
from gui.window.widgets.files import FileDialog
from gui.window.window import Window

pytestmark = pytest.mark.qt_log_ignore("This plugin does not support")  # dialogs without a display
Taken = Callable[[], list[Intent]]


@pytest.fixture(autouse=True)
def _files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Create a file and a folder in the working folder."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "dance.csv").write_text("mine")
    (tmp_path / "inner").mkdir()


def opened(qtbot: QtBot, window: Window) -> FileDialog:
    window.panels.plots.csv.click()
    dialog = present(window.panels.plots.dialog)
    qtbot.waitUntil(lambda: QApplication.activeWindow() is dialog)  # keys go to the active window
    return dialog


def enter(dialog: FileDialog, name: str) -> None:
    """Type a name, and press Enter; a modal box would wait until the time limit of the test."""
    field = present(dialog.findChild(QLineEdit, "fileNameEdit"))
    field.selectAll()
    QTest.keyClicks(field, name)
    QTest.keyClick(field, Qt.Key.Key_Return)
    assert QApplication.activeModalWidget() is None


def test_a_file_that_exists_is_not_written_at_the_first_press(
    qtbot: QtBot, window: Window, intents: Taken, tmp_path: Path
) -> None:
    dialog = opened(qtbot, window)
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
    (write,) = intents()
    assert isinstance(write, WriteFile)
    assert write.file == tmp_path / "inner" / "dance.csv"
