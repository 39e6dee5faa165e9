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

SHARE: Final = 0.29
"""Share of the picture's width that each of both takes."""
MARGIN_PX, ABOVE_PX, BELOW_PX = 8, 32, 44
"""Free at the edges of the picture, and above and below for names and controls."""


class Room(Panel):
    """The map and the person's button, at the right of its parent, and the eye at the left; hidden without a view."""

    def __init__(self, texts: Texts, parent: QWidget) -> None:
        """Create it hidden."""
        super().__init__(parent=parent)
        self._view: RoomView | None = None
        self.map, self.eye, self.speak = PersonMap(texts), CameraPicture(texts), self.button()
        self.eye.setParent(parent)
        self.reports(self.map.intent)
        in_column((self.map, 1), in_row(None, self.speak, None), gap=2, margins=NO_MARGINS, inside=self)
        parent.installEventFilter(self)
        self.show_view(None)

    def show_theme(self, theme: Theme) -> None:
        """Use the colours of a theme."""
        self.map.show_style(style_of(theme))

    def show_view(self, room: RoomView | None) -> None:
        """Show the room, or hide it."""
        self._view = room
        if room is not None:
            self.map.show_room(room.person, room.eye.side, room.yaw)
            self.speak.show_view(room.speak)
            self.eye.show_view(room.eye)
        for part, shown in (
            (self.eye, room is not None),
            (self, room is not None and room.person is not None),
        ):
            if part.isHidden() == shown:
                part.setVisible(shown)
                part.raise_()  # over the texts of the parent, which would get the presses
                self._place()

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
        """Take the upper corners of the parent."""
        size = self.parentWidget().size()
        room = size.height() - ABOVE_PX - BELOW_PX
        width = round(min(size.width() * SHARE, room * 1.1))
        self.eye.setGeometry(MARGIN_PX, ABOVE_PX, width, min(room, round(0.75 * width) + ABOVE_PX))
        self.setGeometry(size.width() - width - MARGIN_PX, ABOVE_PX, width, min(room, width))
