"""The form for the name and the emoji of a gesture."""

from __future__ import annotations

from collections.abc import Sequence

from PyQt5.QtCore import QRegularExpression, QSize, Qt, QTimer, pyqtSignal
from PyQt5.QtGui import QRegularExpressionValidator
from PyQt5.QtWidgets import QLineEdit, QListWidget, QListWidgetItem, QSizePolicy, QWidget

from beatrix_zenoh.client.own_gestures import LONGEST
from gui.console.state.intents import Theme
from gui.console.state.own_gestures import EMOJI
from gui.console.texts import Texts
from gui.window.theme import style_of
from gui.window.widgets.controls import in_column, in_row, named, plain_button
from gui.window.widgets.picture_button import emoji_font

PICTURE_PX, CELL_PX = 22, 34
"""Height of an emoji, and side of its place, at scale 1."""
WORD = QRegularExpression(r"[\w-]+", QRegularExpression.PatternOption.UseUnicodePropertiesOption)
"""Without spaces, because the space bar is STOP."""


class GestureForm(QWidget):
    """A field for the name, and a list of emoji; shown in the place of a panel."""

    given = pyqtSignal(str, str)
    """name and emoji"""
    closed = pyqtSignal()

    def __init__(self, texts: Texts) -> None:
        super().__init__()
        self._texts = texts
        self._names: Sequence[str] = ()
        self.name = named(QLineEdit(), texts("gesture.name"), texts("gesture.name_tip"))
        self.name.setMaxLength(LONGEST)
        self.name.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Fixed)
        self.name.setPlaceholderText(texts("gesture.name"))
        self.name.setValidator(QRegularExpressionValidator(WORD, self.name))
        self.save = plain_button(texts("gesture.save"), texts("gesture.save_tip"))
        self.save.setProperty("main", True)  # noqa: FBT003
        self.cancel = plain_button(texts("gesture.cancel"), texts("gesture.cancel_tip"))
        self.emoji = named(QListWidget(), texts("gesture.emoji"), texts("gesture.emoji"))
        self._items = [QListWidgetItem(sign, self.emoji) for sign in EMOJI]
        self.emoji.setViewMode(QListWidget.ViewMode.IconMode)
        self.emoji.setMovement(QListWidget.Movement.Static)
        self.emoji.setResizeMode(QListWidget.ResizeMode.Adjust)
        self.emoji.setTextElideMode(Qt.TextElideMode.ElideNone)
        line = in_row((self.name, 1), self.save, self.cancel, gap=6)
        in_column(line, (self.emoji, 1), gap=4, margins=(6, 4, 6, 4), inside=self)
        self.name.textChanged.connect(self._show_save)
        # Later: otherwise the same Enter would press the button that has the focus next.
        self.name.returnPressed.connect(lambda: QTimer.singleShot(0, self._give))
        self.save.clicked.connect(self._give)
        self.cancel.clicked.connect(self.closed)

    def ask(self, name: str, sign: str, names: Sequence[str]) -> None:
        """Begin with a name and an emoji; a gesture of one of `names` would be replaced."""
        self._names = [other.casefold() for other in names]
        self.emoji.setCurrentRow(EMOJI.index(sign) if sign in EMOJI else 0)
        self.name.setText(name)
        self._show_save()
        self.name.setFocus()
        self.name.selectAll()

    def show_theme(self, theme: Theme) -> None:
        """Use the sizes of a theme."""
        px = style_of(theme).px
        self.emoji.setGridSize(QSize(px(CELL_PX), px(CELL_PX)))
        for item in self._items:
            item.setFont(emoji_font(px(PICTURE_PX)))
            item.setTextAlignment(Qt.AlignmentFlag.AlignCenter)

    def _show_save(self) -> None:
        name = self.name.text()
        self.save.setEnabled(bool(name))
        self.save.setText(
            self._texts("gesture.replace" if name.casefold() in self._names else "gesture.save")
        )

    def _give(self) -> None:
        if self.name.text():
            for part in (self.name, self.save):
                part.clearFocus()  # else Qt would give it to the next button
            self.closed.emit()
            self.given.emit(self.name.text(), EMOJI[self.emoji.currentRow()])
