"""Gestures as buttons with pictures, and the program that follows a face."""

from __future__ import annotations

from PyQt5.QtCore import QRectF, QSize, Qt, pyqtSignal
from PyQt5.QtGui import QColor, QPainter, QPaintEvent, QResizeEvent
from PyQt5.QtWidgets import QGridLayout, QLayout, QSizePolicy, QStyle, QStyleOptionButton, QWidget

from beatrix_zenoh.client.choreography import GESTURES
from gui.console.state.intents import Theme
from gui.console.state.views import GesturesView
from gui.console.texts import Texts
from gui.window.theme import style_of
from gui.window.widgets.controls import IntentButton, label, set_role, set_text
from gui.window.widgets.gesture_icons import FOLLOW, PROGRAM, paint

PICTURE_PX, SMALL_PX = 44, 26
"""Side of a picture at scale 1, in a wide and in a narrow panel."""
AIR_PX, GAP_PX = 5, 4
COLUMNS = 5
"""Number of buttons in a row of a narrow panel."""
NOTE_PX = 100
"""Least width of the note in a wide panel."""


class PictureButton(IntentButton):
    """A button with a picture over its text."""

    def __init__(self, picture: str) -> None:
        super().__init__()
        self._picture = picture
        self._style = style_of(Theme.DARK)
        self._narrow = False
        self.setSizePolicy(QSizePolicy.Policy.Preferred, QSizePolicy.Policy.Preferred)

    def show_theme(self, theme: Theme) -> None:
        """Use the colours and sizes of a theme."""
        self._style = style_of(theme)
        self.updateGeometry()
        self.update()

    def show_narrow(self, *, narrow: bool) -> None:
        """Use the small picture, or the large one."""
        self._narrow = narrow
        self.updateGeometry()

    def size_of(self, *, narrow: bool) -> QSize:
        """Return the size with the small or the large picture."""
        side, metrics = self._style.px(SMALL_PX if narrow else PICTURE_PX), self.fontMetrics()
        words = metrics.horizontalAdvance(self.text().replace("&&", "&"))
        air = self._style.px(AIR_PX if narrow else 2 * AIR_PX)
        return QSize(max(side, words) + air + 4, side + metrics.height() + air + 4)

    def sizeHint(self) -> QSize:  # noqa: N802 - Qt's name
        return self.size_of(narrow=self._narrow)

    def minimumSizeHint(self) -> QSize:  # noqa: N802
        return self.sizeHint()

    def paintEvent(self, _event: QPaintEvent) -> None:  # noqa: N802
        option = QStyleOptionButton()
        self.initStyleOption(option)
        option.text = ""
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        style = self.style()
        if style is not None:
            style.drawControl(QStyle.ControlElement.CE_PushButton, option, painter, self)
        words = self.fontMetrics().height()
        side = self._style.px(SMALL_PX if self._narrow else PICTURE_PX)
        top = max(2.0, (self.height() - side - words - 2) / 2)
        colours = self._style
        line, mark = (
            (colours.text, colours.accent) if self.isEnabled() else (colours.disabled, colours.disabled)
        )
        box = QRectF((self.width() - side) / 2, top, side, side)
        paint(painter, self._picture, box, QColor(line), QColor(colours.field), QColor(mark))
        painter.setPen(QColor(line))
        place = QRectF(0.0, box.bottom() + 2, self.width(), words)
        painter.drawText(place, int(Qt.AlignmentFlag.AlignCenter), self.text().replace("&&", "&"))


class GesturesPanel(QWidget):
    """A button for each gesture; after them the program that follows a face.

    In a narrow panel the pictures are smaller and stand in two rows, and the note is only a tooltip.
    """

    intent = pyqtSignal(object)

    def __init__(self, texts: Texts) -> None:
        super().__init__()
        self._view: GesturesView | None = None
        self._narrow: bool | None = None
        self.buttons = {name: PictureButton(name) for name in GESTURES}
        self.follow, self.open = PictureButton(FOLLOW), PictureButton(PROGRAM)
        self.note = label(role="dim", wrap=True)
        self.setAccessibleName(texts("label.gestures"))
        self._all = (*self.buttons.values(), self.follow, self.open)
        for button in self._all:
            button.intent.connect(self.intent)
        self._grid = QGridLayout(self)
        self._grid.setContentsMargins(GAP_PX, GAP_PX, GAP_PX, GAP_PX)
        self._grid.setSpacing(GAP_PX)
        self._grid.setSizeConstraint(QLayout.SizeConstraint.SetNoConstraint)  # a wide panel may become narrow
        self._arrange(narrow=False)

    def minimumSizeHint(self) -> QSize:  # noqa: N802
        sizes = [button.size_of(narrow=True) for button in self._all]
        widths = (max(size.width() for size in sizes[column::COLUMNS]) for column in range(COLUMNS))
        return QSize(sum(widths) + GAP_PX * (COLUMNS + 1), 2 * sizes[0].height() + 3 * GAP_PX)

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802
        super().resizeEvent(event)
        wide = sum(button.size_of(narrow=False).width() + GAP_PX for button in self._all)
        self._arrange(narrow=self.width() < wide + NOTE_PX)

    def _arrange(self, *, narrow: bool) -> None:
        if narrow == self._narrow:
            return
        self._narrow = narrow
        columns = COLUMNS if narrow else len(self._all)
        for number, button in enumerate(self._all):
            button.show_narrow(narrow=narrow)
            self._grid.addWidget(button, number // columns, number % columns)
        self._grid.addWidget(self.note, 0, len(self._all))
        self._grid.setColumnStretch(len(self._all), 0 if narrow else 1)
        self.note.setVisible(not narrow)

    def show_theme(self, theme: Theme) -> None:
        """Use the colours and sizes of a theme."""
        for button in self._all:
            button.show_theme(theme)

    def show_view(self, view: GesturesView) -> None:
        """Show the buttons, and what the program does."""
        if view == self._view:
            return
        self._view = view
        for name, button_view in view.gestures:
            self.buttons[name].show_view(button_view)
        self.follow.show_view(view.follow)
        self.open.show_view(view.open)
        set_role(self.follow, "running", "yes" if view.following else "")
        tooltip = (view.follow.tooltip, view.note, view.details)
        self.follow.setToolTip("\n".join(text for text in tooltip if text))
        set_text(self.note, view.note)
        self.note.setToolTip(view.details)
