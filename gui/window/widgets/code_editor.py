"""An editor for Python: line numbers, colours, indents of four spaces, and a mark at a line."""

from __future__ import annotations

import keyword
import re

from PyQt5.QtCore import QSignalBlocker, Qt
from PyQt5.QtGui import (
    QColor,
    QFontDatabase,
    QKeyEvent,
    QPainter,
    QPaintEvent,
    QResizeEvent,
    QSyntaxHighlighter,
    QTextCharFormat,
    QTextCursor,
    QTextFormat,
)
from PyQt5.QtWidgets import QPlainTextEdit, QTextEdit, QWidget

from gui.console.state.intents import Theme
from gui.window.theme import Style, style_of

INDENT = 4
AIR_PX = 10
"""Width beside the line numbers."""
TOKENS = re.compile(
    r"(?P<comment>#.*)|(?P<string>[rbfuRBFU]{0,2}(?:(?P<quotes>'''|\"\"\")(?:\\.|.)*?(?P<end>(?P=quotes)|$)"
    r"|'(?:\\.|[^'\\])*'?|\"(?:\\.|[^\"\\])*\"?))"
    rf"|(?P<keyword>\b(?:{'|'.join(keyword.kwlist)})\b)|(?P<number>\b\d[\w.]*)"
)
OPEN = ("", "'''", '"""')
"""Quotes of the string of several lines in which a line ends, by the state of its block."""


class Highlighter(QSyntaxHighlighter):
    """Colours keywords, numbers, strings and comments."""

    def show_style(self, style: Style) -> None:
        """Use the colours of a theme."""
        colours = {"keyword": style.sim, "number": style.hw, "string": style.good, "comment": style.dim}
        self._formats = {name: QTextCharFormat() for name in colours}
        for name, colour in colours.items():
            self._formats[name].setForeground(QColor(colour))
        self.rehighlight()

    def highlightBlock(self, text: str) -> None:  # noqa: N802
        before, state = OPEN[max(0, self.previousBlockState())], 0
        for found in TOKENS.finditer(before + text):
            start, end = (max(0, at - len(before)) for at in found.span())
            kind = next(name for name in self._formats if found[name])
            self.setFormat(start, end - start, self._formats[kind])
            state = OPEN.index(found["quotes"]) if found["quotes"] and not found["end"] else 0
        self.setCurrentBlockState(state)


class Numbers(QWidget):
    """The column of line numbers beside an editor."""

    def __init__(self, editor: PythonEditor) -> None:
        super().__init__(editor)
        self._editor = editor

    def paintEvent(self, event: QPaintEvent) -> None:  # noqa: N802
        editor, painter = self._editor, QPainter(self)
        painter.setFont(editor.font())
        block = editor.firstVisibleBlock()
        while block.isValid():
            place = editor.blockBoundingGeometry(block).translated(editor.contentOffset()).toAlignedRect()
            if place.top() > event.rect().bottom():
                break
            place.setWidth(self.width() - AIR_PX // 2)
            number = block.blockNumber() + 1
            painter.setPen(QColor(editor.colours.bad if number == editor.fault else editor.colours.dim))
            painter.drawText(place, Qt.AlignmentFlag.AlignRight, str(number))
            block = block.next()


class PythonEditor(QPlainTextEdit):
    """The editor. Space is a space here, and Shift+Tab leaves it."""

    def __init__(self) -> None:
        super().__init__()
        self.colours = style_of(Theme.DARK)
        self.fault = 0
        """the line at which the program has failed; 0: none"""
        self.setFont(QFontDatabase.systemFont(QFontDatabase.SystemFont.FixedFont))
        self.setLineWrapMode(QPlainTextEdit.LineWrapMode.NoWrap)
        self._numbers, self._highlighter = Numbers(self), Highlighter(self.document())
        self.blockCountChanged.connect(self._arrange)
        self.updateRequest.connect(lambda: self._numbers.update())  # noqa: PLW0108 - without its arguments
        self.cursorPositionChanged.connect(self._mark_lines)
        self.show_theme(Theme.DARK)

    def show_theme(self, theme: Theme) -> None:
        """Use the colours and sizes of a theme."""
        self.colours = style_of(theme)
        self._highlighter.show_style(self.colours)
        self._arrange()

    def show_text(self, text: str, *, same_file: bool) -> None:
        """Show another text, which is no change by the user; `same_file`: Ctrl+Z brings the present one back."""
        with QSignalBlocker(self):
            if same_file:
                cursor = self.textCursor()
                cursor.select(QTextCursor.SelectionType.Document)
                cursor.insertText(text)
            else:
                self.setPlainText(text)
        self._arrange()

    def show_fault(self, line: int) -> None:
        """Mark a line at which the program has failed, and show it; 0: none."""
        self.fault = line
        if line:
            self.setTextCursor(QTextCursor(self.document().findBlockByNumber(line - 1)))
        self._mark_lines()

    def _mark_lines(self) -> None:
        """Mark the line of the cursor, and the faulty one."""
        faulty = QTextCursor(self.document().findBlockByNumber(self.fault - 1))
        marks = [QTextEdit.ExtraSelection() for _ in range(1 + bool(self.fault))]
        lines = ((self.textCursor(), self.colours.raised), (faulty, self.colours.notice))
        for mark, (cursor, colour) in zip(marks, lines, strict=False):
            cursor.clearSelection()
            mark.cursor = cursor
            mark.format.setBackground(QColor(colour))
            mark.format.setProperty(QTextFormat.Property.FullWidthSelection, True)  # noqa: FBT003
        self.setExtraSelections(marks)

    def _arrange(self) -> None:
        digits = self.fontMetrics().horizontalAdvance("0" * max(2, len(str(self.blockCount()))))
        self.setViewportMargins(digits + AIR_PX, 0, 0, 0)
        room = self.contentsRect()
        self._numbers.setGeometry(room.left(), room.top(), digits + AIR_PX, room.height())
        self._mark_lines()

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802
        super().resizeEvent(event)
        self._arrange()

    def focusNextPrevChild(self, forward: bool) -> bool:  # noqa: N802, FBT001
        return not forward and QWidget.focusNextPrevChild(self, forward)

    def keyPressEvent(self, event: QKeyEvent) -> None:  # noqa: N802
        """Indent by Tab, back by Backspace, and at Enter as the line before, further after a colon."""
        cursor, key = self.textCursor(), event.key()
        before = cursor.block().text()[: cursor.positionInBlock()]
        if key == Qt.Key.Key_Tab:
            cursor.insertText(" " * (INDENT - len(before) % INDENT))
        elif key == Qt.Key.Key_Backspace and before.isspace() and not cursor.hasSelection():
            for _ in range((len(before) - 1) % INDENT + 1):
                cursor.deletePreviousChar()
        elif key in {Qt.Key.Key_Return, Qt.Key.Key_Enter}:
            more = INDENT if before.rstrip().endswith(":") else 0
            cursor.insertText("\n" + " " * (len(before) - len(before.lstrip(" ")) + more))
            self.ensureCursorVisible()
        else:
            super().keyPressEvent(event)
