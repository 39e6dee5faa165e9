"""Gestures as buttons with pictures, and the program that follows a face."""

from __future__ import annotations

from enum import Enum
from importlib import resources

from PyQt5.QtCore import QByteArray, QSize, Qt, pyqtSignal
from PyQt5.QtGui import QIcon, QPainter, QPixmap, QResizeEvent
from PyQt5.QtSvg import QSvgRenderer
from PyQt5.QtWidgets import QHBoxLayout, QLayout, QSizePolicy, QToolButton, QVBoxLayout

from beatrix_zenoh.client.choreography import GESTURES
from gui.console.state.intents import Theme
from gui.console.state.views import ButtonView, GesturesView
from gui.console.texts import Texts
from gui.window.theme import style_of
from gui.window.widgets.controls import ElidedLabel, Panel, set_role, set_text

PICTURE_PX, SMALL_PX = 44, 26
"""Side of a picture at scale 1, in a wide and in a narrow panel."""
AIR_PX, GAP_PX = 5, 4
LOW_AIR_PX, LOW_GAP_PX = 3, 2
COLUMNS = 5
"""Number of buttons in the first row of a narrow panel."""


class Room(Enum):
    """How much room the panel has."""

    WIDE = "one row of large pictures with names, and the note below it"
    NARROW = "two rows of small pictures with names"
    LOW = "one row of small pictures, whose names are tooltips"


class PictureButton(QToolButton):
    """A button with a picture over its text."""

    intent = pyqtSignal(object)

    def __init__(self, picture: str) -> None:
        super().__init__()
        self._picture = picture
        self._view: ButtonView | None = None
        self._style = style_of(Theme.DARK)
        self._room = Room.WIDE
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setSizePolicy(QSizePolicy.Policy.Preferred, QSizePolicy.Policy.Preferred)
        self.clicked.connect(self._press)

    def _press(self) -> None:
        if self._view is not None:
            self.intent.emit(self._view.intent)

    def show_view(self, view: ButtonView) -> None:
        """Show the view's text, and enable or disable the button."""
        self._view = view
        self._show_text()
        self.setToolTip(f"{view.text}: {view.tooltip}")
        self.setAccessibleName(view.text)
        self.setEnabled(view.enabled)

    def show_theme(self, theme: Theme) -> None:
        """Use the colours and sizes of a theme."""
        self._style = style_of(theme)
        self.show_room(self._room)

    def show_room(self, room: Room) -> None:
        """Use the picture, and the name, for which there is room."""
        self._room, colours = room, self._style
        self._show_text()
        side = colours.px(PICTURE_PX if room is Room.WIDE else SMALL_PX)
        icon, ratio = QIcon(), self.devicePixelRatioF()
        for mode, line, mark in (
            (QIcon.Mode.Normal, colours.text, colours.accent),
            (QIcon.Mode.Disabled, colours.disabled, colours.disabled),
        ):
            icon.addPixmap(drawn(self._picture, side, ratio, (line, colours.field, mark)), mode)
        set_role(self, "wide", "yes" if room is Room.WIDE else "")
        self.setIcon(icon)
        self.setIconSize(QSize(side, side))
        self.updateGeometry()

    def _show_text(self) -> None:
        names = self._view is not None and self._room is not Room.LOW
        styles = Qt.ToolButtonStyle
        self.setToolButtonStyle(styles.ToolButtonTextUnderIcon if names else styles.ToolButtonIconOnly)
        self.setText(self._view.text.replace("&", "&&") if self._view is not None and names else "")

    def size_in(self, room: Room) -> QSize:
        """Return the size in a panel with this room."""
        side, metrics = self._style.px(PICTURE_PX if room is Room.WIDE else SMALL_PX), self.fontMetrics()
        if room is Room.LOW:
            return QSize(side + LOW_AIR_PX, side + LOW_AIR_PX)
        words = metrics.horizontalAdvance("" if self._view is None else self._view.text)
        air = self._style.px(2 * AIR_PX if room is Room.WIDE else AIR_PX)
        return QSize(max(side, words) + air + 4, side + metrics.height() + air + 4)

    def sizeHint(self) -> QSize:  # noqa: N802 - Qt's name
        return self.size_in(self._room)

    def minimumSizeHint(self) -> QSize:  # noqa: N802
        return self.sizeHint()


def drawn(name: str, side: int, ratio: float, colours: tuple[str, str, str]) -> QPixmap:
    """Return a picture with a side (px) on a screen with this ratio of pixels; colours of line, face and mark."""
    text = resources.files(__package__).joinpath("pictures", f"{name}.svg").read_text(encoding="utf-8")
    for variable, colour in zip(("currentColor", "var(--face)", "var(--mark)"), colours, strict=True):
        text = text.replace(variable, colour)
    pixmap = QPixmap(round(side * ratio), round(side * ratio))
    pixmap.fill(Qt.GlobalColor.transparent)
    painter = QPainter(pixmap)
    QSvgRenderer(QByteArray(text.encode())).render(painter)
    painter.end()
    pixmap.setDevicePixelRatio(ratio)
    return pixmap


class GesturesPanel(Panel):
    """A button for each gesture; after them the program that follows a face.

    `Room` lists its arrangements. Without room for the note it is only a tooltip.
    """

    def __init__(self, texts: Texts) -> None:
        super().__init__()
        self._room: Room | None = None
        self.buttons = {name: PictureButton(name) for name in GESTURES}
        self.follow, self.open = PictureButton("follow"), PictureButton("program")
        self.note = ElidedLabel("dim")
        self.setAccessibleName(texts("label.gestures"))
        self._all = (*self.buttons.values(), self.follow, self.open)
        for button in self._all:
            button.intent.connect(self.intent)
        self._lines, self._rows = QVBoxLayout(self), (QHBoxLayout(), QHBoxLayout())
        self._lines.setSizeConstraint(
            QLayout.SizeConstraint.SetNoConstraint
        )  # a wide panel may become narrow
        for row in self._rows:
            self._lines.addLayout(row, 1)
        self._lines.addWidget(self.note)
        self._arrange(Room.WIDE)

    def minimumSizeHint(self) -> QSize:  # noqa: N802
        least = self._all[0].size_in(Room.LOW)
        gaps = LOW_GAP_PX * (len(self._all) + 1)
        return QSize(least.width() * len(self._all) + gaps, least.height() + 2 * LOW_GAP_PX)

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802
        super().resizeEvent(event)
        wide = sum(button.size_in(Room.WIDE).width() + GAP_PX for button in self._all)
        sizes = [button.size_in(Room.NARROW) for button in self._all]
        rows = (sizes[:COLUMNS], sizes[COLUMNS:])
        least = max(sum(size.width() + GAP_PX for size in row) for row in rows) + GAP_PX
        narrow = QSize(least, 2 * sizes[0].height() + 3 * GAP_PX)
        if self.height() < narrow.height() or self.width() < narrow.width():
            self._arrange(Room.LOW)
        else:
            self._arrange(Room.NARROW if self.width() < wide else Room.WIDE)

    def _arrange(self, room: Room) -> None:
        """Put the buttons into rows that are all as wide as the panel."""
        if room is self._room:
            return
        self._room = room
        gap = LOW_GAP_PX if room is Room.LOW else GAP_PX
        self._lines.setContentsMargins(gap, gap, gap, gap)
        self._lines.setSpacing(gap)
        first = COLUMNS if room is Room.NARROW else len(self._all)
        for number, button in enumerate(self._all):
            button.show_room(room)
            self._rows[int(number >= first)].addWidget(button, 1)
        for row in self._rows:
            row.setSpacing(gap)
        self._lines.setStretch(1, int(room is Room.NARROW))
        self._show_note()

    def _show_note(self) -> None:
        """Show the note if there is room below the buttons; it never moves them sideways."""
        self.note.setVisible(self._room is Room.WIDE and bool(self.note.text()))

    def show_theme(self, theme: Theme) -> None:
        """Use the colours and sizes of a theme."""
        for button in self._all:
            button.show_theme(theme)

    def show_view(self, view: GesturesView) -> None:
        """Show the buttons, and what the program does."""
        for name, button_view in view.gestures:
            self.buttons[name].show_view(button_view)
        self.follow.show_view(view.follow)
        self.open.show_view(view.open)
        set_role(self.follow, "running", "yes" if view.following else "")
        tooltip = (f"{view.follow.text}: {view.follow.tooltip}", view.note, view.details)
        self.follow.setToolTip("\n".join(text for text in tooltip if text))
        set_text(self.note, view.note)
        self._show_note()
        self.note.setToolTip(view.details)
