"""The strip below the header: the present step, mission or lesson, and the sheets with its page and picture."""

from __future__ import annotations

from itertools import zip_longest

from PyQt5.QtCore import QPoint, QSize
from PyQt5.QtGui import QResizeEvent
from PyQt5.QtSvg import QSvgWidget
from PyQt5.QtWidgets import QAction, QBoxLayout, QMenu, QTextBrowser, QWidget

from gui.console.state.lesson_strip import ShowSheet
from gui.console.state.views import ButtonView, StripView
from gui.console.texts import Texts
from gui.window.widgets.controls import Panel, Sheet, in_column, in_row, label, named, plain_button, set_role

BUTTONS = 7
"""Largest number of buttons."""
SHEET = QSize(760, 480)
"""Least size of page and picture (px), if the window is as large."""
EDGE = 8
"""Distance of the sheet from the left edge of the window (px)."""


class LessonSheet(Sheet):
    """The page of a lesson, or the picture of a check."""

    def __init__(self, texts: Texts, parent: QWidget, strip: QWidget) -> None:
        super().__init__(texts("strip.lessons"), parent, SHEET.width())
        self._text, self._strip = "", strip
        self.page, self.picture = QTextBrowser(), QSvgWidget()
        self.page.setOpenLinks(False)
        self.page.setAccessibleName(texts("strip.lessons"))
        named(self.picture, texts("strip.picture"), texts("strip.picture_tip"))
        self.close_button = plain_button(texts("strip.hide"), texts("strip.hide_tip"))
        self.close_button.clicked.connect(lambda: self.intent.emit(ShowSheet("")))
        picture = in_row(None, self.picture, None)
        in_column((self.page, 1), picture, in_row(None, self.close_button), inside=self)

    def show_view(self, view: StripView | None) -> None:
        """Show what the view contains, or hide the sheet."""
        if view is None or not (view.page or view.picture):
            self.hide()
            return
        self.page.setVisible(bool(view.page))
        self.picture.setVisible(bool(view.picture))
        if view.page and view.page != self._text:
            self._text = view.page
            self.page.setMarkdown(view.page)
            document, room = self.page.document(), min(SHEET.height(), self.parentWidget().height() - 120)
            document.setTextWidth(SHEET.width() - 60)
            self.page.setFixedHeight(min(round(document.size().height()) + 12, room))
        if view.picture:
            self.picture.load(view.picture)
            self.picture.setFixedSize(self._picture_size())
        self.appear(self.close_button)

    def place(self) -> None:
        """Move to the left edge below the strip, so that the strip and the code beside the head stay visible."""
        super().place()
        top = self.parentWidget().mapFromGlobal(self._strip.mapToGlobal(QPoint(0, self._strip.height()))).y()
        self.move(EDGE, min(top, self.parentWidget().height() - self.height()))

    def _picture_size(self) -> QSize:
        """Return the size of the picture, smaller in a low window."""
        size, room = self.picture.renderer().defaultSize(), self.parentWidget().height() - 180
        return size if size.height() <= room else QSize(size.width() * room // size.height(), room)


class Strip(Panel):
    """Progress, text, buttons, and a menu of all lessons; hidden without a view."""

    def __init__(self, texts: Texts) -> None:
        super().__init__("panel")
        self._texts = texts
        self._entries: tuple[ButtonView, ...] = ()
        self._sheet: LessonSheet | None = None
        self.progress, self.text = label(role="good"), label(wrap=True)
        self.buttons = [self.button() for _ in range(BUTTONS)]
        self.menu = QMenu(self)
        self.lessons = plain_button(f"{texts('strip.lessons')} ▾", texts("strip.lessons_tip"))
        self.lessons.clicked.connect(self._open_menu)
        words = in_row(self.progress, (self.text, 1))
        self._controls = in_row(*self.buttons, self.lessons)
        self._row = in_row((words, 1), self._controls, margins=(10, 1, 6, 1), inside=self)
        self.hide()

    @property
    def shows_sheet(self) -> bool:
        """Whether a page, hint or picture lies over the window."""
        return self._sheet is not None and self._sheet.isVisible()

    def show_view(self, view: StripView | None) -> None:
        """Show the present task or lesson, or hide the strip."""
        self.setVisible(view is not None)
        if view is not None:
            self.progress.setText(view.progress)
            named(self.progress, view.count, view.count)
            self.text.setText(view.text)
            set_role(self.text, "role", {True: "good", False: "warn", None: ""}[view.good])
            for button, shown in zip_longest(self.buttons, view.buttons):
                button.show_view(shown)
            self._fill(view.lessons)
            self._arrange()
        wanted = view is not None and (view.page or view.picture)
        if self._sheet is None and wanted:
            self._sheet = LessonSheet(self._texts, self.parentWidget(), self)
            self.reports(self._sheet.intent)
        if self._sheet is not None:
            self._sheet.show_view(view)

    def _fill(self, entries: tuple[ButtonView, ...]) -> None:
        if entries == self._entries:
            return
        self._entries = entries
        self.menu.clear()
        for entry in entries:
            action = QAction(entry.text.replace("&", "&&"), self.menu)
            action.setToolTip(entry.tooltip)
            action.triggered.connect(lambda _, intent=entry.intent: self.intent.emit(intent))
            self.menu.addAction(action)

    def _open_menu(self) -> None:
        """Open the menu without blocking the window."""
        corner = self.lessons.mapToGlobal(QPoint(self.lessons.width(), self.lessons.height()))
        self.menu.popup(corner - QPoint(self.menu.sizeHint().width(), 0))

    def _arrange(self) -> None:
        """Put the buttons below the text if they would leave it less than half of the width."""
        narrow = self._controls.sizeHint().width() > self.width() / 2
        self._row.setDirection(
            QBoxLayout.Direction.TopToBottom if narrow else QBoxLayout.Direction.LeftToRight
        )

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802
        super().resizeEvent(event)
        self._arrange()
        if self._sheet is not None and self.shows_sheet:
            self._sheet.place()
