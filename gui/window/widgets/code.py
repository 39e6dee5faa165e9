"""The code panel: a program to write and run, beginning with that of the presses; and its output."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from pathlib import Path

from PyQt5.QtCore import QUrl, pyqtSignal
from PyQt5.QtGui import QDesktopServices, QTextCursor
from PyQt5.QtWidgets import QFileDialog, QMenu, QPlainTextEdit, QSizePolicy

from gui.console.state.actions import EXAMPLES, OpenProgram, WriteProgram
from gui.console.state.intents import Intent, Theme
from gui.console.state.views import CodeView
from gui.console.texts import Texts
from gui.window.widgets.code_editor import PythonEditor
from gui.window.widgets.controls import ElidedLabel, in_column, in_row, label, named, plain_button, set_role
from gui.window.widgets.files import FilePanel

NEW_PROGRAM = """from beatrix_zenoh import Robot

with Robot(side="sim") as robot:
    robot.make_ready()
    robot.look(yaw=20)
    robot.home()
"""


class CodePanel(FilePanel):
    """The editor, its file, and the output below it."""

    opened = pyqtSignal()
    """the user has opened a program, so that the panel must be shown"""

    def __init__(self, texts: Texts) -> None:
        super().__init__(texts)
        self._view: CodeView | None = None
        self._text = self._shown = ""
        """the program that was shown or reported last; what the editor has made of it"""
        self.program = named(PythonEditor(), texts("label.code"), "")
        self.run, self.title = self.button(main=True), ElidedLabel("title", 6)
        self.file = plain_button(texts("code.file"), "")
        self.message = label(wrap=True)
        self.message.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Preferred)
        self.output = named(QPlainTextEdit(), texts("code.output"), "")
        self.output.setReadOnly(True)
        self.output.setFont(self.program.font())
        menu = QMenu(self.file)
        menu.addAction(texts("code.new"), self._begin)
        menu.addAction(texts("code.from_presses"), lambda: self.intent.emit(OpenProgram()))
        opens, saves = QFileDialog.AcceptMode.AcceptOpen, QFileDialog.AcceptMode.AcceptSave
        save = lambda file: WriteProgram(self._text, file)  # noqa: E731
        menu.addAction(texts("code.open"), lambda: self._choose("open", opens, OpenProgram))
        menu.addAction(texts("code.examples"), lambda: self._choose("open", opens, OpenProgram, EXAMPLES))
        menu.addAction(texts("code.save_as"), lambda: self._choose("save_as", saves, save))
        self.editor = menu.addAction(texts("code.editor"), self._edit_elsewhere)
        self.file.setMenu(menu)
        head = in_row((self.run, 1), self.file, gap=4)
        parts = (self.title, head, (self.program, 3), self.message, (self.output, 1))
        in_column(*parts, gap=4, margins=(6, 6, 6, 6), inside=self)
        self.program.textChanged.connect(self._report)

    def show_view(self, view: CodeView) -> None:
        """Show the program and its run."""
        old, self._view = self._view, view
        if view.text != self._text:
            self._text = view.text
            self.program.show_text(view.text, same_file=old is not None and old.file == view.file)
            self._shown = self.program.toPlainText()
            if view.file is None:  # so that new lines are visible
                self.program.moveCursor(QTextCursor.MoveOperation.End)
        if old is not None and old.opens != view.opens:
            self.opened.emit()
        self.run.show_view(view.run)
        self.title.setText(view.title)
        self.file.setToolTip(str(view.file or view.folder))
        self.editor.setEnabled(view.file is not None)
        self.message.setText(view.message)
        set_role(self.message, "role", "bad" if view.failed else "dim")
        if old is None or old.output != view.output:
            self.output.setPlainText("\n".join(view.output).rstrip())
            self.output.moveCursor(QTextCursor.MoveOperation.End)
            self.output.setVisible(any(view.output))
        if old is None or old.line != view.line:
            self.program.show_fault(view.line)

    def show_theme(self, theme: Theme) -> None:
        """Use the colours and sizes of a theme."""
        self.program.show_theme(theme)

    def _report(self) -> None:
        """Report a change of the text; Qt reports those of colours, too."""
        if (text := self.program.toPlainText()) != self._shown:
            self._text = self._shown = text
            self.intent.emit(WriteProgram(text))

    def _choose(
        self,
        name: str,
        mode: QFileDialog.AcceptMode,
        made: Callable[[Path], Intent],
        folder: Path | None = None,
    ) -> None:
        if (view := self._view) is not None:
            folder = folder or view.folder if view.file is None else view.file.parent
            self.choose_file(self._texts(f"code.{name}"), mode, "py", made, folder=folder)

    def _begin(self) -> None:
        """Begin a program in a file of its own."""
        if self._view is not None:
            self.intent.emit(WriteProgram(NEW_PROGRAM, self._view.folder))

    def _edit_elsewhere(self) -> None:
        """Open the file in the editor of the system."""
        file = str(self._view and self._view.file)
        if sys.platform == "win32":
            os.startfile(file, "edit")  # noqa: S606 - the usual action would run it
        elif not QDesktopServices.openUrl(QUrl.fromLocalFile(file)):
            self.message.setText(self._texts("code.no_editor", file=file))
