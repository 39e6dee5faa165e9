"""An editor for Python: line numbers, colours, indents of four spaces, and a mark at a line."""

from __future__ import annotations

import keyword
import re

from PyQt5.QtCore import QRect, Qt, pyqtSignal
from PyQt5.QtGui import (
    QColor,
    QFocusEvent,
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
    rf"(?P<comment>#.*)|(?P<string>[rbfuRBFU]{{0,2}}(?:'''|\"\"\"|'(?:\\.|[^'\\])*'?|\"(?:\\.|[^\"\\])*\"?))"
    rf"|(?P<keyword>\b(?:{'|'.join(keyword.kwlist)})\b)|(?P<number>\b\d[\w.]*)"
)
QUOTES = ("'''", '"""')
"""Strings of several lines; the number of a block's state is that of the open one, from 1."""


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
        """Colour one line, which may begin in a string of several lines."""
        at, inside = 0, self.previousBlockState()
        self.setCurrentBlockState(0)
        while at < len(text):
            if inside > 0:
                end = text.find(QUOTES[inside - 1], at)
                stop = len(text) if end < 0 else end + len(QUOTES[0])
                self.setFormat(at, stop - at, self._formats["string"])
                at, inside = stop, inside if end < 0 else 0
            elif (found := TOKENS.search(text, at)) is None:
                break
            else:
                self.setFormat(found.start(), len(found[0]), self._formats[found.lastgroup or ""])
                at = found.end()
                inside = QUOTES.index(found[0][-3:]) + 1 if found[0][-3:] in QUOTES else 0
        self.setCurrentBlockState(max(inside, 0))


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
            room = QRect(0, place.top(), self.width() - AIR_PX // 2, place.height())
            number = block.blockNumber() + 1
            painter.setPen(QColor(editor.style_.bad if number == editor.fault else editor.style_.dim))
            painter.drawText(room, Qt.AlignmentFlag.AlignRight, str(number))
            block = block.next()


class PythonEditor(QPlainTextEdit):
    """The editor. Space is a space here, and Shift+Tab leaves it."""

    left = pyqtSignal()
    """it has lost the focus"""

    def __init__(self) -> None:
        super().__init__()
        self.style_ = style_of(Theme.DARK)
        self.fault = 0
        """the line at which the program has failed; 0: none"""
        self.setFont(QFontDatabase.systemFont(QFontDatabase.SystemFont.FixedFont))
        self.setLineWrapMode(QPlainTextEdit.LineWrapMode.NoWrap)
        self._numbers, self._colours = Numbers(self), Highlighter(self.document())
        self.blockCountChanged.connect(self._make_room)
        self.updateRequest.connect(lambda: self._numbers.update())  # noqa: PLW0108 - without its arguments
        self.cursorPositionChanged.connect(self._mark_lines)
        self.show_theme(Theme.DARK)

    def show_theme(self, theme: Theme) -> None:
        """Use the colours and sizes of a theme."""
        self.style_ = style_of(theme)
        self._colours.show_style(self.style_)
        self._make_room()
        self._mark_lines()

    def show_text(self, text: str, *, same_file: bool) -> None:
        """Show another text; `same_file`: Ctrl+Z brings the present one back, and the cursor stays."""
        if text == self.toPlainText():
            return
        if not same_file:
            self.setPlainText(text)
        else:
            cursor, at = self.textCursor(), self.textCursor().position()
            cursor.select(QTextCursor.SelectionType.Document)
            cursor.insertText(text)
            cursor.setPosition(min(at, len(text)))
            self.setTextCursor(cursor)

    def show_fault(self, line: int) -> None:
        """Mark a line at which the program has failed, and show it; 0: none."""
        self.fault = line
        if line:
            self.setTextCursor(QTextCursor(self.document().findBlockByNumber(line - 1)))
        self._mark_lines()

    def _mark_lines(self) -> None:
        """Mark the line of the cursor, and the faulty one."""
        marks = [(self.textCursor(), self.style_.raised)]
        if self.fault:
            marks.append((QTextCursor(self.document().findBlockByNumber(self.fault - 1)), self.style_.notice))
        selections = []
        for cursor, colour in marks:
            mark = QTextEdit.ExtraSelection()
            mark.cursor = cursor
            mark.cursor.clearSelection()
            mark.format.setBackground(QColor(colour))
            mark.format.setProperty(QTextFormat.Property.FullWidthSelection, True)  # noqa: FBT003
            selections.append(mark)
        self.setExtraSelections(selections)

    def _make_room(self) -> None:
        widest = self.fontMetrics().horizontalAdvance("0" * max(2, len(str(self.blockCount()))))
        self.setViewportMargins(widest + AIR_PX, 0, 0, 0)
        self._place()

    def _place(self) -> None:
        room = self.contentsRect()
        self._numbers.setGeometry(room.left(), room.top(), self.viewportMargins().left(), room.height())

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802
        super().resizeEvent(event)
        self._place()

    def focusNextPrevChild(self, forward: bool) -> bool:  # noqa: N802, FBT001
        return not forward and QWidget.focusNextPrevChild(self, forward)

    def focusOutEvent(self, event: QFocusEvent) -> None:  # noqa: N802
        super().focusOutEvent(event)
        self.left.emit()

    def keyPressEvent(self, event: QKeyEvent) -> None:  # noqa: N802
        """Indent by Tab, back by Backspace, and at Enter as the line before, further after a colon."""
        cursor = self.textCursor()
        before = cursor.block().text()[: cursor.positionInBlock()]
        if event.key() == Qt.Key.Key_Tab:
            cursor.insertText(" " * (INDENT - len(before) % INDENT))
        elif (
            event.key() == Qt.Key.Key_Backspace and before and before.isspace() and not cursor.hasSelection()
        ):
            cursor.movePosition(
                cursor.MoveOperation.Left, cursor.MoveMode.KeepAnchor, (len(before) - 1) % INDENT + 1
            )
            cursor.removeSelectedText()
        elif event.key() in {Qt.Key.Key_Return, Qt.Key.Key_Enter}:
            more = INDENT if before.rstrip().endswith(":") else 0
            cursor.insertText("\n" + " " * (len(before) - len(before.lstrip(" ")) + more))
            self.ensureCursorVisible()
        else:
            super().keyPressEvent(event)
