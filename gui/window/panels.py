"""The arrangement of all widgets in one language: header, banner, three columns or the page of the class, STOP."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from typing import TypeVar

from PyQt5.QtCore import QEvent, QLocale, QObject, QPoint, QRect, Qt, pyqtSignal
from PyQt5.QtGui import QResizeEvent
from PyQt5.QtWidgets import QFrame, QHBoxLayout, QScrollArea, QTabWidget, QVBoxLayout, QWidget

from gui.console.state.intents import Choose, Tab, Theme, WindowPage
from gui.console.state.views import HistoryRowView, RefusalView, View
from gui.console.texts import Texts
from gui.window.keys import KeySheet, Steering
from gui.window.theme import style_of
from gui.window.widgets.arms import ArmsPanel
from gui.window.widgets.class_page import ClassPage
from gui.window.widgets.code import CodePanel
from gui.window.widgets.controls import NO_MARGINS, ChoiceCheck, Panel, filled, spaced
from gui.window.widgets.eyes import EyesPanel
from gui.window.widgets.gestures import GesturesPanel
from gui.window.widgets.head import HeadPanel
from gui.window.widgets.head3d import Head3d
from gui.window.widgets.header import Header, ShowButtons
from gui.window.widgets.history import HistoryPanel
from gui.window.widgets.notices import Banner, ConnectSheet, RefusalNotice, TroubleNotice
from gui.window.widgets.plots import PlotsPanel
from gui.window.widgets.sending import CommandsPanel, SendingPanel, StopBar
from gui.window.widgets.sequence import SequencePanel
from gui.window.widgets.strip import Strip

P = TypeVar("P", bound=Panel)
LOW_PX, NARROW_PX = 680, 1060
"""Height and width of the window, at scale 1, below which the tabs of the right column are tabs of the middle, and less
room is reserved."""
LOWER_PX = 138
"""Height at scale 1 of the low area in the middle, with its tabs."""
SIMPLE_PX = 111
"""The same without its tabs, in the simple window."""
LEAST_PX = 818, 502
"""Width at scale 1, and height, of the room above STOP that texts need: Qt counts neither wrapped nor shortened ones."""


class Scroll(QScrollArea):
    """Scrolls its widget where the window is smaller than the widget's least size.

    Qt would compare with the preferred height instead, which the pictures of the cameras make very large.
    """

    def fit(self) -> None:
        """Give the widget all room, and never less than its least size."""
        content = self.widget()
        least = content.minimumSizeHint().expandedTo(content.minimumSize())
        content.resize(self.viewport().size().expandedTo(least))

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802
        super().resizeEvent(event)
        self.fit()

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:  # noqa: N802
        if event.type() == QEvent.Type.LayoutRequest:
            self.fit()
        return super().eventFilter(watched, event)


class Panels(QWidget):
    """All widgets of the window; they show a view and report intents."""

    intent = pyqtSignal(object)

    def __init__(self, texts: Texts) -> None:
        super().__init__()
        self.setObjectName("central")
        self.setLocale(QLocale(texts.code))
        self._texts = texts
        self._theme = Theme.DARK
        self._simple = self._drawer = False
        self._arranged: tuple[bool, ...] | None = None
        """low, simple and with the drawer: the present arrangement; None: there is none yet"""
        self._refusal: RefusalView | None = None
        self._parts: list[tuple[Panel, Callable[[View], object]]] = []
        self._shown: dict[Panel, object] = {}
        """the part of the view that each panel shows; without an entry it shows nothing yet"""
        self.header = self._add(Header(texts), lambda view: view)
        self.banner = self._add(Banner(), lambda view: view.banner)
        self.guide = self._add(Strip(texts), lambda view: view.guide)
        self.head = self._add(HeadPanel(texts), lambda view: view.head)
        self.head3d = self._add(Head3d(texts), lambda view: view.head)
        self._add(self.head3d.room, lambda view: view.room)
        self.show_buttons = self._add(ShowButtons(), lambda view: view.show)
        self.head3d.top.addWidget(self.show_buttons)
        self.arms = self._add(ArmsPanel(texts), lambda view: view)
        self.sending = self._add(SendingPanel(texts), lambda view: view)
        self.commands = self._add(CommandsPanel(texts), lambda view: view.commands)
        self.history = self._add(HistoryPanel(texts), lambda view: view.history)
        self.code = self._add(CodePanel(texts), lambda view: view.code)
        self.sequence = self._add(SequencePanel(texts), lambda view: view.sequence)
        self._add(self.sequence.music, lambda view: view.music)
        self.gestures = self._add(GesturesPanel(texts), lambda view: view.gestures)
        self.eyes = self._add(EyesPanel(texts), lambda view: view.eyes)
        self._add(self.eyes.sound, lambda view: view.sound)
        self.plots = self._add(PlotsPanel(texts), lambda view: view)
        self.class_page = self._add(ClassPage(texts), lambda view: view.class_page)
        self.class_page.hide()
        self.stop_bar, self.trouble = StopBar(texts), TroubleNotice(texts)
        self.tabs, self.side, self.low_area = QTabWidget(), QTabWidget(), QTabWidget()
        """the low area of the middle column is visible beside every tab"""
        self.body = QWidget()
        self.pages, self.area = QWidget(), Scroll()
        self._lay_out()
        self.connect_sheet = self._add(ConnectSheet(texts, self.pages), lambda view: view.connect)
        self.refusal = RefusalNotice(texts, self.pages)
        self.key_sheet = KeySheet(texts, self.pages)
        self._boxes = self.findChildren(ChoiceCheck)
        self._connect()

    def _order(self) -> None:
        """Let Tab reach the controls as the eye does: first what to do, then from the top to STOP."""
        top = self.banner, self.guide, self.header
        middle = self.arms, self.tabs, self.low_area, self.side
        below = (self.commands, *middle) if self._simple else (*middle, self.commands)
        controls = [
            control
            for part in (*top, self.head, self.sending, *below, self.class_page, self.stop_bar)
            for control in (part, *part.findChildren(QWidget))
            if control.focusPolicy() & Qt.FocusPolicy.TabFocus and not control.focusProxy()
            if control.window() is self.window()  # not in a menu
        ]
        for control, after in pairwise(controls):
            self.setTabOrder(control, after)

    def _add(self, panel: P, part: Callable[[View], object]) -> P:
        """Return a panel, after connecting it: it shows its part of each view, and reports intents."""
        panel.intent.connect(self.intent)
        self._parts.append((panel, part))
        return panel

    def _lay_out(self) -> None:
        for tabs in (self.tabs, self.side, self.low_area):
            tabs.setUsesScrollButtons(False)
            # A hidden tab bar would hold the focus of the area.
            tabs.setFocusProxy(None)  # type: ignore[arg-type]  # the stubs forget None
            tabs.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        views = {Tab.HEADS: self.head3d, Tab.EYES: self.eyes, Tab.PLOTS: self.plots}
        for name, page in views.items():
            self.tabs.addTab(page, self._texts(f"label.tab_{name}"))
        self.low_area.addTab(self.gestures, self._texts("label.gestures"))
        self.low_area.addTab(self.sequence, self._texts("label.sequence"))
        self._lay_out_columns()
        inner = filled(spaced(QVBoxLayout(), 6, (8, 5, 8, 5)), self.header, self.banner, self.guide)
        filled(spaced(QVBoxLayout(self.pages), None, NO_MARGINS), self.body, self.class_page)
        filled(inner, (self.pages, 1), self.trouble)
        self.area.setFrameShape(QFrame.Shape.NoFrame)
        self.area.setFocusPolicy(Qt.FocusPolicy.NoFocus)  # Tab reaches the controls, and scrolls to them
        content = QWidget()
        content.setLayout(inner)
        self.area.setWidget(content)
        bottom = filled(spaced(QHBoxLayout(), 0), (self.stop_bar, 3), (self.stop_bar.last, 2))
        filled(spaced(QVBoxLayout(self), 0, NO_MARGINS), (self.area, 1), bottom)
        self._arrange()

    def _lay_out_columns(self) -> None:
        self._left = filled(spaced(QVBoxLayout(), 8), (self.head, 1), self.sending, self.arms)
        self._below = filled(spaced(QHBoxLayout(), 8), (self.low_area, 1))
        """the low area, and in a low window the commands beside it"""
        middle = filled(spaced(QVBoxLayout(), 8), (self.tabs, 1), self._below)
        self._right = filled(spaced(QVBoxLayout(), 8), (self.side, 1), self.commands)
        self._columns = spaced(QHBoxLayout(self.body), 8, NO_MARGINS)
        filled(self._columns, self._left, middle, self._right)

    def _connect(self) -> None:
        for notice in (self.refusal, self.stop_bar):
            notice.intent.connect(self.intent)
        self.header.keys_asked.connect(self.key_sheet.toggle)
        self.tabs.currentChanged.connect(self._report_tab)
        self.steering = Steering((self.head.pad, self.head3d), self.intent.emit)
        self.sequence.gesture.intent.connect(self.gestures.ask)
        self.gestures.shown.connect(
            lambda own: self.low_area.setCurrentWidget(self.gestures if own else self.sequence)
        )
        self.code.opened.connect(self._show_code)

    def _show_code(self) -> None:
        if self._simple and not self._drawer:
            self.intent.emit(Choose("drawer", value=True))
        for tabs in (self.tabs, self.side):
            if tabs.indexOf(self.code) >= 0:
                tabs.setCurrentWidget(self.code)

    def _report_tab(self, number: int) -> None:
        if self._simple:
            self.tabs.setCurrentIndex(0)  # Ctrl+Tab would show hidden tabs
        elif 0 <= number < len(Tab):
            self.intent.emit(Choose("tab", list(Tab)[number]))

    def _arrange(self) -> None:
        """Arrange the widgets for the size of the window, and the simple window or all.

        In a low window, history and code move to the middle column: there is no right one, and the pad is wider.
        The simple window has no tabs; at its right is the code, if the user opens it.
        """
        colours = style_of(self._theme)
        self.area.widget().setMinimumSize(colours.px(LEAST_PX[0]), LEAST_PX[1])
        low, simple = self.height() < colours.px(LOW_PX), self._simple
        low = low or (self.width() < colours.px(NARROW_PX) and not simple)
        self.low_area.setFixedHeight(colours.px(SIMPLE_PX if simple else LOWER_PX))
        for tabs in (self.tabs, self.low_area):  # the hidden tabs are wider
            tabs.setMinimumWidth(self.head3d.minimumSizeHint().width() if simple else 0)
        if (arranged := (low, simple, self._drawer)) == self._arranged:
            return
        self._arranged = arranged
        self.sending.show_compact(compact=low or simple)
        self.arms.show_compact(compact=low)
        for part in (self.head3d, self.sending, self.commands):
            part.show_simple(simple=simple)
        self.head3d.room_box.setHidden(simple and self._drawer)  # there is no room
        for widget in (
            self.head.table,
            self.arms,
            self.tabs.tabBar(),
            self.low_area.tabBar(),
            self.side.tabBar(),
        ):
            widget.setHidden(simple)
        home, shown = self.tabs if low and not simple else self.side, self.tabs.currentIndex()
        home.addTab(self.history, self._texts("label.history"))
        home.addTab(self.code, self._texts("label.code"))
        (self._left if simple else self._below if low else self._right).addWidget(self.commands)
        self.side.setVisible(self._drawer if simple else not low)
        widths = (1, 4, 3 * self._drawer) if simple else (3, 4, 0) if low else (3, 5, 2)
        for column, stretch in enumerate(widths):
            self._columns.setStretch(column, stretch)
        self.tabs.setCurrentIndex(0 if simple else min(shown, self.tabs.count() - 1))
        if simple:
            self.low_area.setCurrentWidget(self.gestures)
            self.side.setCurrentWidget(self.code)
        self._order()

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802
        super().resizeEvent(event)
        self._arrange()
        for sheet in (self.key_sheet, self.connect_sheet):
            if sheet.isVisible():
                sheet.place()
        self._show_notice()

    def show_theme(self, theme: Theme) -> None:
        """Use the colours and sizes of a theme."""
        self._theme = theme
        for panel, _ in self._parts:
            panel.show_theme(theme)
        self._arrange()

    def show_view(self, view: View) -> None:
        """Pass each part of the view that has changed to its widget."""
        for box in self._boxes:
            box.setChecked(getattr(view.choices, box.name))
        self._simple, self._drawer = view.choices.simple, view.choices.simple and view.choices.drawer
        self.head3d.code.setChecked(self._drawer)
        self._arrange()
        for panel, part in self._parts:
            shown = part(view)
            if shown != self._shown.get(panel):
                self._shown[panel] = shown
                panel.show_view(shown)  # type: ignore[arg-type]  # each panel shows the part that `_add` was given
        self._show_page(view.choices.page)
        self.steering.mirrored = view.head.facing
        self.stop_bar.show_view(view)
        self.stop_bar.show_last(view.last)
        refusals = (view.head.refusal, view.arms.refusal, view.commands.refusal, view.gestures.refusal)
        self._refusal = next((refusal for refusal in refusals if refusal is not None), None)
        self._show_notice()

    def _show_page(self, page: WindowPage) -> None:
        shows_class = page is WindowPage.CLASS
        if self.class_page.isHidden() == shows_class:
            self.body.setVisible(not shows_class)
            self.class_page.setVisible(shows_class)
            (self.class_page.list if shows_class else self.head.pad).setFocus()

    def show_outcome(self, rows: tuple[HistoryRowView, ...], last: str) -> None:
        """Update only the history and the last line, after an outcome."""
        self.history.show_view(rows)
        self.stop_bar.show_last(last)

    def _show_notice(self) -> None:
        """Show the refusal, for which the head moves aside."""
        self.refusal.show_over(self._picture(), None if self.body.isHidden() else self._refusal)
        self.head3d.keep_clear(0 if self.refusal.isHidden() else self.refusal.width())

    def _picture(self) -> QRect:
        """Return the part of the middle that a refusal may cover: no control is there in the view of the head."""
        shown = self.tabs.currentWidget()
        area = QRect(shown.mapTo(self.pages, QPoint(0, 0)), shown.size())
        return area.adjusted(0, 0, 0, -self.head3d.controls_height)
