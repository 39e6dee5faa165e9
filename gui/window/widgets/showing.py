"""The buttons *Photo* and *Film* beside the head."""

from __future__ import annotations

from gui.console.state.views import ShowView
from gui.window.widgets.controls import NO_MARGINS, Panel, in_row
from gui.window.widgets.header import RecordButtons


class ShowButtons(Panel):
    """Photo, film with its clock, and the button that opens the last of them."""

    def __init__(self) -> None:
        super().__init__()
        self.photo, self.film = self.button(), RecordButtons()
        self.reports(self.film.intent)
        in_row(self.photo, self.film, gap=4, margins=NO_MARGINS, inside=self)

    def show_view(self, view: ShowView) -> None:
        """Show the buttons."""
        self.photo.show_view(view.photo)
        self.film.show_view(view.film)
