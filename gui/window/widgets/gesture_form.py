"""The form for the name and the emoji of a gesture."""

from __future__ import annotations

from collections.abc import Sequence

from PyQt5.QtCore import QRegularExpression, QSize, Qt, QTimer, pyqtSignal
from PyQt5.QtGui import QIcon, QRegularExpressionValidator, QResizeEvent
from PyQt5.QtWidgets import (
    QButtonGroup,
    QGridLayout,
    QLineEdit,
    QSizePolicy,
    QToolButton,
    QVBoxLayout,
    QWidget,
)

from gui.console.state.intents import Theme
from gui.console.state.own_gestures import EMOJI
from gui.console.texts import Texts
from gui.window.theme import style_of
from gui.window.widgets.controls import filled, in_row, named, plain_button, spaced
from gui.window.widgets.picture_button import emoji

COLUMNS = 12
PICTURE_PX, AIR_PX = 24, 8
"""Side of an emoji at scale 1, and the width around it."""
LONGEST = 24
WORD = QRegularExpression(r"[\w-]+", QRegularExpression.PatternOption.UseUnicodePropertiesOption)
"""Without spaces, because the space bar is STOP."""


class GestureForm(QWidget):
    """A field for the name, and a button for each emoji; shown in the place of a panel."""

    given = pyqtSignal(str, str)
    """name and emoji"""
    closed = pyqtSignal()

    def __init__(self, texts: Texts) -> None:
        super().__init__()
        self._texts = texts
        self._names: Sequence[str] = ()
        self._side = PICTURE_PX
        self.name = named(QLineEdit(), texts("gesture.name"), texts("gesture.name_tip"))
        self.name.setMaxLength(LONGEST)
        self.name.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Fixed)
        self.name.setPlaceholderText(texts("gesture.name"))
        self.name.setValidator(QRegularExpressionValidator(WORD, self.name))
        self.save = plain_button(texts("gesture.save"), texts("gesture.save_tip"))
        self.save.setProperty("main", True)  # noqa: FBT003
        self.cancel = plain_button(texts("gesture.cancel"), texts("gesture.cancel_tip"))
        self.group = QButtonGroup(self)
        self._grid = spaced(QGridLayout(), 2)
        for number, sign in enumerate(EMOJI):
            button = QToolButton(self)
            button.setCheckable(True)
            button.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
            button.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Fixed)
            button.setAccessibleName(f"{texts('gesture.emoji')} {sign}")
            self.group.addButton(button, number)
        line = in_row((self.name, 1), self.save, self.cancel, gap=6)
        filled(spaced(QVBoxLayout(self), 4, (6, 4, 6, 4)), line, self._grid, None)
        self.name.textChanged.connect(self._show_save)
        # Later: otherwise the same Enter would press the button that has the focus next.
        self.name.returnPressed.connect(lambda: QTimer.singleShot(0, self._give))
        self.save.clicked.connect(self._give)
        self.cancel.clicked.connect(self.closed)

    def ask(self, name: str, sign: str, names: Sequence[str] = ()) -> None:
        """Begin with a name and an emoji; a gesture of one of `names` would be replaced."""
        self._names = [other.casefold() for other in names]
        self.group.button(EMOJI.index(sign) if sign in EMOJI else 0).setChecked(True)
        self.name.setText(name)
        self._show_save()
        self.name.setFocus()
        self.name.selectAll()

    def show_theme(self, theme: Theme) -> None:
        """Use the colours and sizes of a theme."""
        style, ratio = style_of(theme), self.devicePixelRatioF()
        self._side = side = style.px(PICTURE_PX)
        colours = (style.text, style.field, style.accent)
        for number, sign in enumerate(EMOJI):
            button = self.group.button(number)
            button.setIcon(QIcon(emoji(sign, sign, side, ratio, colours)))
            button.setIconSize(QSize(side, side))
        self.setStyleSheet(
            f"QToolButton:checked {{ background: {style.line}; border: 2px solid {style.accent}; }}"
        )

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802
        super().resizeEvent(event)
        self._arrange()

    def _arrange(self) -> None:
        """Arrange the emoji in as many columns as fit."""
        columns = max(1, min(COLUMNS, (self.width() - 2 * AIR_PX) // (self._side + AIR_PX)))
        for number, button in enumerate(self.group.buttons()):
            self._grid.addWidget(button, *divmod(number, columns))

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
            self.given.emit(self.name.text(), EMOJI[self.group.checkedId()])
