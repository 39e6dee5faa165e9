"""Gestures as buttons with pictures: emotions on a wheel, those of the user, and programs that turn to a person."""

from __future__ import annotations

from functools import partial

from msgspec import structs
from PyQt5.QtCore import Qt, pyqtSignal
from PyQt5.QtGui import QResizeEvent
from PyQt5.QtWidgets import (
    QFrame,
    QGridLayout,
    QMenu,
    QScrollArea,
    QStackedLayout,
    QToolButton,
    QVBoxLayout,
    QWidget,
)

from beatrix_zenoh.client.choreography import EMOTIONS, GESTURES
from gui.console.state.actions import FOLLOW, TURN
from gui.console.state.intents import SaveGesture, Theme
from gui.console.state.own_gestures import OpenGesture
from gui.console.state.views import ButtonView, GesturesView, OwnGestureView
from gui.console.texts import Texts
from gui.window.theme import style_of
from gui.window.widgets.controls import NO_MARGINS, Panel, filled, in_row, set_role, spaced
from gui.window.widgets.emotion_wheel import EmotionWheel
from gui.window.widgets.gesture_form import GestureForm
from gui.window.widgets.picture_button import PictureButton

HEIGHT_PX, LOW_PX = 48, 26
"""Least height of a button with its picture, and with its name alone, at scale 1."""
OWN_PX = 84
"""Longest name of a user's gesture that widens the buttons, at scale 1."""
AIR_PX, ARROW_PX, BAR_PX = 10, 14, 24
"""Width beside the name of a button, of the arrow of its menu, and of the scroll bar."""
WHEEL, WHEEL_MOST, WHEEL_LEAST = 2.0, 0.42, 0.3
"""Width of the wheel, of the panel's height; and its largest and least width, of that of the panel."""
MANY = 12
"""Number of buttons that keep their pictures, and are scrolled."""


class GesturesPanel(Panel):
    """The wheel of emotions, and a button for each other gesture and for the program that follows a face."""

    shown = pyqtSignal(bool)
    """this panel, or the sequence, has to be visible"""

    def __init__(self, texts: Texts) -> None:
        super().__init__()
        self._theme, self._in_class = Theme.DARK, False
        self._own: tuple[OwnGestureView, ...] = ()
        self._asked = SaveGesture("", "")
        """what the form is about"""
        self.setAccessibleName(texts("label.gestures"))
        self.wheel = EmotionWheel(texts("gesture.emotions"))
        others = {name: PictureButton(name) for name in GESTURES if name not in EMOTIONS}
        self.buttons = others | self.wheel.buttons
        self.follow, self.turn = map(PictureButton, ("follow", "listen"))
        self.fetch = PictureButton("fetch")
        self.own: dict[str, PictureButton] = {}
        """buttons of the user's gestures, by name"""
        self._cells = [*others.values(), self.follow, self.turn, self.fetch]
        self.form = GestureForm(texts)
        self._lay_out()
        self.reports(*(button.intent for button in (*self.wheel.buttons.values(), *self._cells)))

    def _lay_out(self) -> None:
        self._inner, self._area = QWidget(), QScrollArea()
        self._grid = spaced(QGridLayout(self._inner), 3, NO_MARGINS)
        for button in self._cells:
            button.setParent(self._inner)
        self._area.setWidget(self._inner)
        self._area.setWidgetResizable(True)
        self._area.setFrameShape(QFrame.Shape.NoFrame)
        self._area.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self._area.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        main = QWidget()
        line = in_row(self.wheel, (self._area, 1), gap=4)
        filled(spaced(QVBoxLayout(main), 2, (3, 3, 3, 3)), (line, 1))
        self._stack = QStackedLayout(self)
        for page in (main, self.form):
            self._stack.addWidget(page)
        self.form.closed.connect(lambda: self._stack.setCurrentIndex(0))
        self.form.given.connect(self._give)

    def show_theme(self, theme: Theme) -> None:
        """Use the colours and sizes of a theme."""
        self._theme = theme
        self.wheel.show_theme(theme)
        self.form.show_theme(theme)
        for button in (*self._cells, *self.own.values()):
            button.show_theme(theme)
        self._arrange()

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802
        super().resizeEvent(event)
        self._arrange()

    def _arrange(self) -> None:
        """Arrange the buttons in columns as wide as the longest name: with a narrower wheel, or without pictures, if all fit so."""
        metrics, px, styles = self.fontMetrics(), style_of(self._theme).px, Qt.ToolButtonStyle
        cells = [*(self._cells if self._in_class else self._cells[:-1]), *self.own.values()]
        names = [button.text() for button in self._cells]
        own = [metrics.horizontalAdvance(name) + ARROW_PX for name in self.own]
        least = AIR_PX + max(*map(metrics.horizontalAdvance, names), min(px(OWN_PX), max(own, default=0)))
        wide = min(round(WHEEL * self.height()), round(WHEEL_MOST * self.width()))
        narrow = min(wide, max(round(WHEEL_LEAST * self.width()), self.wheel.least_width))

        def arranged(wheel: int) -> tuple[int, int]:
            """Return the room beside the wheel (px), and how many columns fit there."""
            room = self.width() - wheel - BAR_PX
            return room, max(1, room // least)

        def fit(wheel: int) -> bool:
            return -(-len(cells) // arranged(wheel)[1]) * px(HEIGHT_PX) <= self.height()

        wheel = wide if fit(wide) else narrow
        pictures = fit(wheel) or len(cells) > MANY
        row = px(HEIGHT_PX if pictures else LOW_PX)
        style = styles.ToolButtonTextUnderIcon if pictures else styles.ToolButtonTextOnly
        room, columns = arranged(wheel)
        self.wheel.setFixedWidth(wheel)
        for number, button in enumerate(cells):
            self._grid.addWidget(button, *divmod(number, columns))
            button.setToolButtonStyle(style)
        for line in range(self._grid.rowCount()):
            self._grid.setRowMinimumHeight(line, row if line * columns < len(cells) else 0)
        for name, button in self.own.items():
            width = room // columns - AIR_PX - ARROW_PX
            button.setText(metrics.elidedText(name, Qt.TextElideMode.ElideRight, width))

    def show_view(self, view: GesturesView) -> None:
        """Show the buttons, and what the program does."""
        for name, button_view in view.gestures:
            self.buttons[name].show_view(button_view)
        if view.own != self._own:
            self._show_own(view.own)
        self._in_class = view.fetch is not None
        self.fetch.setVisible(self._in_class)
        if view.fetch is not None:
            self.fetch.show_view(view.fetch)
        for file, button, shown in ((FOLLOW, self.follow, view.follow), (TURN, self.turn, view.turn)):
            button.show_view(shown)
            set_role(button, "running", "yes" if view.running == file else "")
        self._arrange()

    def _show_own(self, own: tuple[OwnGestureView, ...]) -> None:
        """Make the buttons of the user's gestures again; a gesture that was just saved has the focus."""
        self._own, known = own, {*self.own}
        for button in self.own.values():
            self._grid.removeWidget(button)
            button.deleteLater()
        self.own = {}
        for gesture in own:
            button = self.own[gesture.name] = PictureButton(gesture.name, gesture.emoji)
            button.setParent(self._inner)
            button.show_theme(self._theme)
            button.show_view(gesture.play)
            self.reports(button.intent)
            menu = QMenu(button)
            for entry in gesture.menu:
                action = menu.addAction(entry.text)
                action.setEnabled(entry.enabled)
                action.setToolTip(entry.tooltip)
                action.triggered.connect(partial(self._change, gesture, entry))
            button.setMenu(menu)
            button.setPopupMode(QToolButton.ToolButtonPopupMode.MenuButtonPopup)
            if gesture.name == self._asked.name and gesture.name not in known:
                button.show()  # the layout would do it later
                button.setFocus()

    def _change(self, gesture: OwnGestureView, entry: ButtonView) -> None:
        if isinstance(entry.intent, SaveGesture):
            self.ask(entry.intent)
            return
        self.intent.emit(entry.intent)
        if isinstance(entry.intent, OpenGesture):
            self._asked = SaveGesture(gesture.name, gesture.emoji)
            self.shown.emit(False)  # noqa: FBT003

    def ask(self, intent: SaveGesture) -> None:
        """Ask for the name and the emoji of a gesture to save or to rename; begin with those of one that was opened."""
        if intent.old or self._asked.old:
            self._asked = intent
        self._stack.setCurrentIndex(1)
        self.shown.emit(True)  # noqa: FBT003
        self.form.ask(self._asked.name, self._asked.emoji, [*self.own])

    def _give(self, name: str, emoji: str) -> None:
        self._asked = structs.replace(self._asked, name=name, emoji=emoji)
        self.intent.emit(self._asked)
