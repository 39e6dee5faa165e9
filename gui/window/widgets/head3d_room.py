"""The room beside the head, in a corner of its picture: the map with the person, and what the left eye sees."""

from __future__ import annotations

from typing import Final

from PyQt5.QtCore import QEvent, QObject
from PyQt5.QtWidgets import QWidget

from beatrix_zenoh.client import CameraImage
from gui.console.state.intents import Theme
from gui.console.state.views import RoomView
from gui.console.texts import Texts
from gui.window.theme import style_of
from gui.window.widgets.controls import NO_MARGINS, Panel, in_column, in_row
from gui.window.widgets.eyes import CameraPicture
from gui.window.widgets.head3d_person import PersonMap

SHARE: Final = 0.30
"""Largest share of the picture's width."""
MARGIN_PX: Final = 6
BELOW_PX: Final = 40
"""Height of the controls below the picture."""


class Room(Panel):
    """Places itself at the right edge of its parent; hidden without a view."""

    def __init__(self, texts: Texts, parent: QWidget) -> None:
        """Create it hidden."""
        super().__init__(parent=parent)
        self._view: RoomView | None = None
        self.map, self.eye, self.speak = PersonMap(texts), CameraPicture(texts), self.button()
        self.reports(self.map.intent)
        in_column(
            (self.map, 1), in_row(None, self.speak), (self.eye, 1), gap=2, margins=NO_MARGINS, inside=self
        )
        parent.installEventFilter(self)
        self.hide()

    @property
    def taken(self) -> int:
        """Width of the picture that the room covers (px)."""
        return 0 if self.isHidden() else self.width() + MARGIN_PX

    def show_theme(self, theme: Theme) -> None:
        """Use the colours of a theme."""
        self.map.show_style(style_of(theme))

    def show_view(self, room: RoomView | None) -> None:
        """Show the room, or hide it."""
        self._view = room
        if room is not None:
            self.map.setVisible(room.person is not None)
            self.map.show_room(room.person, room.yaw)
            self.speak.show_view(None if room.person is None else room.speak)
            self.eye.show_view(room.eye)
        if self.isHidden() == (room is not None):
            self.setVisible(room is not None)
            self._place()
            self.raise_()  # over the texts of the parent, which would get its mouse presses
            self.parentWidget().update()

    def show_image(self, side: str, image: CameraImage) -> None:
        """Show a picture if it is that of the shown eye."""
        room = self._view
        if room is not None and (side, image.eye) == (room.eye.side, room.eye.eye):
            self.eye.show_image(image)

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:  # noqa: N802
        if event.type() == QEvent.Type.Resize:
            self._place()
        return super().eventFilter(watched, event)

    def _place(self) -> None:
        size = self.parentWidget().size()
        height = size.height() - BELOW_PX - 2 * MARGIN_PX
        width = round(min(size.width() * SHARE, height * 0.6))
        self.setGeometry(size.width() - width - MARGIN_PX, MARGIN_PX, width, height)
