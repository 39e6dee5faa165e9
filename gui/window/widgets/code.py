"""The code panel: a program to write and run, beginning with that of the presses; and its output."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from pathlib import Path

from PyQt5.QtCore import QTimer, QUrl, pyqtSignal
from PyQt5.QtGui import QDesktopServices, QFontDatabase, QTextCursor
from PyQt5.QtWidgets import QFileDialog, QMenu, QPlainTextEdit, QSizePolicy

from gui.console.state.actions import OpenProgram, WriteProgram
from gui.console.state.intents import Intent, Theme
from gui.console.state.views import CodeView
from gui.console.texts import Texts
from gui.window.widgets.code_editor import PythonEditor
from gui.window.widgets.controls import ElidedLabel, in_column, in_row, label, named, plain_button, set_role
from gui.window.widgets.files import FilePanel

WRITE_MS = 300
"""Time after a key in which the program is written."""
OUTPUT_PX = 90
"""Largest height of the output."""


class CodePanel(FilePanel):
    """The editor, its file, and the output below it."""

    opened = pyqtSignal()
    """another program is shown, so that the panel must be"""

    def __init__(self, texts: Texts) -> None:
        super().__init__(texts)
        self._view: CodeView | None = None
        self._known = ""
        """the text that is shown or written"""
        self.program = named(PythonEditor(), texts("label.code"), "")
        self.run, self.title = self.button(main=True), ElidedLabel("title", 6)
        self.file = plain_button(texts("code.file"), texts("code.file_tip"))
        self.message = label(wrap=True)
        self.message.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Preferred)
        self.output = named(QPlainTextEdit(), texts("code.output"), "")
        self.output.setReadOnly(True)
        self.output.setFont(QFontDatabase.systemFont(QFontDatabase.SystemFont.FixedFont))
        self.output.setMaximumHeight(OUTPUT_PX)
        self.output.hide()
        head = in_row(self.run, self.file, (self.title, 1), gap=4)
        parts = (head, (self.program, 1), self.message, self.output)
        in_column(*parts, gap=4, margins=(6, 6, 6, 6), inside=self)
        self._typing = QTimer(self)
        self._typing.setSingleShot(True)
        self._typing.setInterval(WRITE_MS)
        self._typing.timeout.connect(self._write)
        self.program.textChanged.connect(self._typing.start)
        for leaves in (self.program.left, self.run.pressed):  # before a button reports its intent
            leaves.connect(self._write)
        self._fill_menu()

    def _fill_menu(self) -> None:
        menu, texts = QMenu(self.file), self._texts
        menu.addAction(texts("code.from_presses"), lambda: self._leave(OpenProgram()))
        menu.addAction(texts("code.open"), self._open)
        menu.addAction(texts("code.save_as"), self._save_as)
        self.editor = menu.addAction(texts("code.editor"), self._edit_elsewhere)
        self.file.setMenu(menu)

    def show_view(self, view: CodeView) -> None:
        """Show the program and its run; while the user types, the typed text stays."""
        old, self._view = self._view, view
        changed = old is None or (old.reads, old.shown) != (view.reads, view.shown)
        if changed and self.program.toPlainText() == self._known:
            self.program.show_text(view.text, same_file=old is not None and old.file == view.file)
            self._known = self.program.toPlainText()
        if old is not None and old.reads != view.reads:
            self.opened.emit()
        self.run.show_view(view.run)
        self.title.setText(view.title)
        self.file.setToolTip(str(view.file or self._texts("code.file_tip")))
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

    def _write(self) -> None:
        """Report what the user has typed since the last report."""
        self._typing.stop()
        text = self.program.toPlainText()
        if text != self._known:
            self._known = text
            self.intent.emit(WriteProgram(text))

    def _leave(self, intent: Intent) -> None:
        self._write()
        self.intent.emit(intent)

    def _open(self) -> None:
        self._write()
        self._choose("open", QFileDialog.AcceptMode.AcceptOpen, OpenProgram)

    def _save_as(self) -> None:
        saves = QFileDialog.AcceptMode.AcceptSave
        self._choose("save_as", saves, lambda file: WriteProgram(self.program.toPlainText(), file))

    def _choose(self, name: str, mode: QFileDialog.AcceptMode, made: Callable[[Path], Intent]) -> None:
        view = self._view
        if view is not None:
            self.choose_file(
                self._texts(f"code.{name}"), mode, "py", made, folder=(view.file or view.folder / "x").parent
            )

    def _edit_elsewhere(self) -> None:
        """Open the file in the editor of the system."""
        file = None if self._view is None else self._view.file
        if file is None:
            return
        self._write()
        if sys.platform == "win32":
            os.startfile(file, "edit")  # noqa: S606 - the usual action would run it
        elif not QDesktopServices.openUrl(QUrl.fromLocalFile(str(file))):
            self.message.setText(self._texts("code.no_editor", file=str(file)))
