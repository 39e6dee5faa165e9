"""The window: shows the world that the link returns, and passes the actions of intents to the link."""

from __future__ import annotations

import time
from collections.abc import Callable

from PyQt5.QtCore import Qt, QTimer
from PyQt5.QtGui import QCloseEvent
from PyQt5.QtWidgets import QApplication, QMainWindow, QWidget

from beatrix_zenoh.client import CameraImage
from gui.console.link import Link
from gui.console.state.actions import AskLease, MakeReady, Outcome, Send, SendCommand
from gui.console.state.connecting import CloseConnect
from gui.console.state.intents import (
    EmergencyStop,
    GrabHead,
    Intent,
    ReleaseHead,
    SendHead,
    Stop,
    Tab,
    TogglePage,
    Undo,
    WindowPage,
)
from gui.console.state.lesson_strip import ShowSheet
from gui.console.state.state import State
from gui.console.state.views import View
from gui.console.texts import Texts
from gui.window.keys import Keys
from gui.window.panels import Panels
from gui.window.theme import apply_theme, style_of

PERIOD_MS = 50
DRAG_PERIOD_MS = 33
"""Period while the user drags the head: 30 pictures a second look smooth, and cost half a core for two robots."""
REFRESH_DELAY_MS = 10
"""Time between a request and the refresh that shows it: most replies come sooner, and drawing must not delay them."""
ANSWERED = (Send, SendCommand, AskLease, MakeReady)
"""Actions that a robot answers within milliseconds."""
YIELD_S = 0.0003
"""Pause in which the link's threads send, before the window draws: Python runs one thread at a time."""


class Window(QMainWindow):
    """The main window; used in Qt's thread only."""

    def __init__(self, link: Link, state: State) -> None:
        super().__init__()
        self._link, self._state = link, state
        self._view: View | None = None
        self._world = link.world()
        self.panels: Panels
        self._show(self._state.view(self._world))
        acts: dict[str, Callable[[], object]] = {
            "stop": lambda: self.handle(Stop()),
            "send": lambda: self.handle(SendHead()),
            "undo": lambda: self.handle(Undo()),
            "record": lambda: self.panels.header.record.toggle.click(),  # noqa: PLW0108 - panels are replaced
            "help": lambda: self.panels.key_sheet.toggle(),  # noqa: PLW0108
            "page": lambda: self.handle(TogglePage()),
            "projector": lambda: self._project(on=not self.panels.class_page.large),
            "escape": self._close_sheets,
        }
        self.keys = Keys(lambda: self.panels.stop_bar, acts)
        self._timer = QTimer(self)
        self._timer.timeout.connect(self._refresh_in_turn)
        self._timer.start(PERIOD_MS)
        self._delayed_refresh = QTimer(self)
        self._delayed_refresh.setSingleShot(True)
        self._delayed_refresh.setInterval(REFRESH_DELAY_MS)
        self._delayed_refresh.timeout.connect(self.refresh)

    @property
    def refresh_pending(self) -> bool:
        """Whether the window does not show the newest request or outcome completely yet."""
        return self._delayed_refresh.isActive()

    def refresh(self) -> None:
        """Show the present world."""
        self._world = self._link.world()
        self._delayed_refresh.stop()
        for action in (*self._state.follow(self._world), *self._state.celebration(self._world)):
            self._link.do(action)
        self._show(self._state.view(self._world))
        self.panels.plots.append(self._world)  # views do not contain the positions

    def _refresh_in_turn(self) -> None:
        if not self.refresh_pending:  # a robot may be about to answer, and drawing would delay its reply
            self.refresh()

    def _refresh_soon(self) -> None:
        if not self.refresh_pending:  # each of many outcomes must not put the refresh off again
            self._delayed_refresh.start()

    def handle(self, intent: Intent) -> None:
        """Carry out an intent and show its effect: at once, or after REFRESH_DELAY_MS if a robot answers it."""
        if not isinstance(intent, Stop | EmergencyStop):  # reading the world would delay STOP
            self._world = self._link.world()
        if isinstance(intent, GrabHead | ReleaseHead):
            self._timer.setInterval(DRAG_PERIOD_MS if isinstance(intent, GrabHead) else PERIOD_MS)
        actions = self._state.handle(intent, self._world)
        for action in actions:
            self._link.do(action)
        if actions:
            time.sleep(YIELD_S)
        if any(isinstance(action, ANSWERED) for action in actions):
            self._refresh_soon()
        else:
            self.refresh()

    def report(self, outcome: Outcome) -> None:
        """Show the outcome of an action: history and last line at once, the rest after REFRESH_DELAY_MS."""
        self._state.report(outcome)
        self.panels.show_outcome(*self._state.outcomes(self._world))
        self._refresh_soon()

    def show_image(self, side: str, image: CameraImage) -> None:
        """Show a picture of a camera."""
        for panel in (self.panels.eyes, self.panels.head3d.room):
            panel.show_image(side, image)

    def show_error(self, text: str) -> None:
        """Show an error of the window itself in a line over the panels."""
        self.panels.trouble.show_text(text)

    def closeEvent(self, event: QCloseEvent) -> None:  # noqa: N802
        self._timer.stop()
        self._delayed_refresh.stop()
        self.keys.remove()
        super().closeEvent(event)

    def _close_sheets(self) -> None:
        self.panels.key_sheet.hide()
        if self.panels.guide.shows_sheet:
            self.handle(ShowSheet(""))
        if self.panels.connect_sheet.isVisible():
            self.handle(CloseConnect())

    def _project(self, *, on: bool) -> None:
        """Show the class in large type on the whole screen, with STOP below; only the teacher's window can."""
        if self._view is None or self._view.class_page is None:
            return
        if on and self._view.choices.page is not WindowPage.CLASS:
            self.handle(TogglePage())
        full, panels = Qt.WindowState.WindowFullScreen, self.panels
        self.setWindowState(Qt.WindowStates(self.windowState() | full if on else self.windowState() & ~full))
        panels.header.setVisible(not on)
        panels.class_page.show_large(on=on)

    def _show(self, view: View) -> None:
        old, self._view = self._view, view
        if old is None or old.choices.language != view.choices.language:
            self._build(view)
            old = None
        if old is None or old.choices.theme != view.choices.theme:
            apply_theme(self, style_of(view.choices.theme))
            self.panels.show_theme(view.choices.theme)
        self.setWindowTitle(view.title)
        focus: QWidget | None = QApplication.focusWidget()
        self.panels.show_view(view)
        same_page = old is not None and old.choices.page is view.choices.page
        if same_page and focus is not None and self.panels.isAncestorOf(focus) and not usable(focus):
            self.panels.stop_bar.setFocus()  # Qt alone would choose the next control, which may be Record
        if view.choices.page is not WindowPage.CLASS and self.panels.class_page.large:
            self._project(on=False)

    def _build(self, view: View) -> None:
        """Create all widgets, at the start and for another language."""
        if self.centralWidget() is not None:
            self.panels.plots.close()
        self.panels = Panels(Texts(view.choices.language))
        self.panels.tabs.setCurrentIndex(list(Tab).index(view.choices.tab))
        self.panels.intent.connect(self.handle)
        self.panels.class_page.projector_asked.connect(lambda: self._project(on=True))
        self.setCentralWidget(self.panels)
        self.panels.head.pad.setFocus()  # so that arrows and Enter work at once


def usable(control: QWidget) -> bool:
    """Return whether the user can use a control."""
    return control.isVisible() and control.isEnabled()
