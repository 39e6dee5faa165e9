"""The arrangement of all widgets in one language: header, banner, three columns or the page of the class, STOP."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

from PyQt5.QtCore import QEvent, QLocale, QObject, QPoint, QRect, Qt, pyqtSignal
from PyQt5.QtGui import QResizeEvent
from PyQt5.QtWidgets import QFrame, QHBoxLayout, QScrollArea, QTabWidget, QVBoxLayout, QWidget

from gui.console.state.intents import Choose, Tab, Theme, WindowPage
from gui.console.state.views import HistoryRowView, RefusalView, View
from gui.console.texts import Texts
from gui.window.keys import KeySheet
from gui.window.theme import style_of
from gui.window.widgets.arms import ArmsPanel
from gui.window.widgets.class_page import ClassPage
from gui.window.widgets.controls import NO_MARGINS, ChoiceCheck, Panel, filled, spaced
from gui.window.widgets.eyes import EyesPanel
from gui.window.widgets.gestures import GesturesPanel
from gui.window.widgets.head import HeadPanel
from gui.window.widgets.head3d import Head3d
from gui.window.widgets.header import Header
from gui.window.widgets.history import CodePanel, HistoryPanel
from gui.window.widgets.notices import Banner, ConnectSheet, RefusalNotice, TroubleNotice
from gui.window.widgets.plots import PlotsPanel
from gui.window.widgets.sending import CommandsPanel, SendingPanel, StopBar
from gui.window.widgets.sequence import SequencePanel
from gui.window.widgets.strip import Strip

P = TypeVar("P", bound=Panel)
LOW_PX = 680
"""Window height at scale 1 below which the tabs of the right column are tabs of the middle, and less room is reserved."""
LOWER_PX = 138
"""Height at scale 1 of the low area in the middle, with its tabs."""
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
        self._low: bool | None = None
        self._refusal: RefusalView | None = None
        self._parts: list[tuple[Panel, Callable[[View], object]]] = []
        self._shown: dict[Panel, object] = {}
        """the part of the view that each panel shows; without an entry it shows nothing yet"""
        self.header = self._add(Header(texts), lambda view: view)
        self.banner = self._add(Banner(), lambda view: view.banner)
        self.guide = self._add(Strip(texts), lambda view: view.guide)
        self.head = self._add(HeadPanel(texts), lambda view: view.head)
        self.head3d = self._add(Head3d(texts), lambda view: view.head)
        self.arms = self._add(ArmsPanel(texts), lambda view: view)
        self.sending = self._add(SendingPanel(texts), lambda view: view)
        self.commands = self._add(CommandsPanel(texts), lambda view: view.commands)
        self.history = self._add(HistoryPanel(texts), lambda view: view.history)
        self.code = self._add(CodePanel(texts), lambda view: view.code)
        self.sequence = self._add(SequencePanel(texts), lambda view: view.sequence)
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

    def _add(self, panel: P, part: Callable[[View], object]) -> P:
        """Return a panel, after connecting it: it shows its part of each view, and reports intents."""
        panel.intent.connect(self.intent)
        self._parts.append((panel, part))
        return panel

    def _lay_out(self) -> None:
        for tabs in (self.tabs, self.side, self.low_area):
            tabs.setUsesScrollButtons(False)
        views = {Tab.HEADS: self.head3d, Tab.EYES: self.eyes, Tab.PLOTS: self.plots}
        for name, page in views.items():
            self.tabs.addTab(page, self._texts(f"label.tab_{name}"))
        self.low_area.addTab(self.gestures, self._texts("label.gestures"))
        self.low_area.addTab(self.sequence, self._texts("label.sequence"))
        self._lay_out_columns()
        inner = filled(spaced(QVBoxLayout(), 8, (8, 8, 8, 8)), self.header, self.banner, self.guide)
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
        left = filled(spaced(QVBoxLayout(), 8), (self.head, 1), self.sending, self.arms)
        self._below = filled(spaced(QHBoxLayout(), 8), (self.low_area, 1))
        """the low area, and in a low window the commands beside it"""
        middle = filled(spaced(QVBoxLayout(), 8), (self.tabs, 1), self._below)
        self._right = filled(spaced(QVBoxLayout(), 8), (self.side, 1), self.commands)
        self._columns = spaced(QHBoxLayout(self.body), 8, NO_MARGINS)
        filled(self._columns, left, middle, self._right)

    def _connect(self) -> None:
        for notice in (self.refusal, self.stop_bar):
            notice.intent.connect(self.intent)
        self.header.keys_asked.connect(self.key_sheet.toggle)
        self.tabs.currentChanged.connect(self._report_tab)

    def _report_tab(self, number: int) -> None:
        if 0 <= number < len(Tab):
            self.intent.emit(Choose("tab", list(Tab)[number]))

    def _arrange(self) -> None:
        """Arrange the widgets for the height of the window.

        In a low window, history and code move to the middle column: there is no right one, and the pad is wider.
        """
        colours = style_of(self._theme)
        self.area.widget().setMinimumSize(colours.px(LEAST_PX[0]), LEAST_PX[1])
        low = self.height() < colours.px(LOW_PX)
        self.low_area.setFixedHeight(colours.px(LOWER_PX))
        if low == self._low:
            return
        self._low = low
        for part in (self.sending, self.arms):
            part.show_compact(compact=low)
        home, shown = self.tabs if low else self.side, self.tabs.currentIndex()
        home.addTab(self.history, self._texts("label.history"))
        home.addTab(self.code, self._texts("label.code"))
        (self._below if low else self._right).addWidget(self.commands)
        self.side.setVisible(not low)
        for column, stretch in enumerate((3, 4, 0) if low else (3, 5, 2)):
            self._columns.setStretch(column, stretch)
        self.tabs.setCurrentIndex(min(shown, self.tabs.count() - 1))

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
        for panel, part in self._parts:
            shown = part(view)
            if shown != self._shown.get(panel):
                self._shown[panel] = shown
                panel.show_view(shown)  # type: ignore[arg-type]  # each panel shows the part that `_add` was given
        self._show_page(view.choices.page)
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
