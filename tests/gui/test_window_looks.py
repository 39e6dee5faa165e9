"""At the sizes of school laptops nothing is cut off, and every text has enough contrast, in each theme and language."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import product

import pytest
from contrast import contrast, luminance
from gui_views import STATES, example
from msgspec import structs
from present import present
from PyQt5.QtCore import QRect, QSize, Qt
from PyQt5.QtGui import QTextDocumentFragment
from PyQt5.QtWidgets import QAbstractButton, QApplication, QLabel, QToolButton, QWidget
from pytestqt.qtbot import QtBot
from recording_link import RecordingLink, ShownState, WatchedState

from gui.console.state.actions import LookForPorts
from gui.console.state.intents import Choose, Theme
from gui.console.state.views import Condition, View
from gui.console.state.world import Trouble
from gui.console.texts import LANGUAGES
from gui.window.run import SIZE, show
from gui.window.theme import Style, style_of
from gui.window.widgets.controls import ElidedLabel
from gui.window.widgets.sending import STOP_PX
from gui.window.window import Window

SIZES = [(1366, 768), (1024, 768), (1024, 600), (1024, 560)]
SCALED = [(910, 456)]
"""A usual screen without frame and panel, divided by its scale: 1366x768 by 1.5."""
READABLE, LEGIBLE = 4.5, 3.0
"""Least contrast of text, and of disabled text and large symbols."""

PROJECTED_PX = 14
DARK = 0.05
"""Largest luminance of a dark ground."""


def pairs(colours: Style) -> Iterator[tuple[str, str, str, float]]:
    """Yield each pair of text and background colour, with the contrast that it needs."""
    for ground in ("ground", "panel", "field"):
        for text in ("text", "dim", "good", "warn", "bad"):
            yield text, getattr(colours, text), getattr(colours, ground), READABLE
        for sign in ("edge", "disabled"):
            yield sign, getattr(colours, sign), getattr(colours, ground), LEGIBLE
    for side in ("sim", "hw"):
        for ground in ("panel", "field"):
            yield side, colours.side(side), getattr(colours, ground), READABLE
    for condition in Condition:
        yield condition, colours.condition(condition), colours.panel, READABLE
    yield "refusal", colours.text, colours.notice, READABLE
    yield "border of a refusal", colours.warn, colours.notice, LEGIBLE
    yield "button", colours.text, colours.raised, READABLE
    yield "button with focus", colours.accent, colours.raised, LEGIBLE
    yield "button to press next", colours.accent_text, colours.accent, READABLE
    yield "STOP", colours.stop_text, colours.stop, READABLE
    yield "STOP, pressed", colours.stop_text, colours.stop_pressed, READABLE
    yield "STOP in the window", colours.stop, colours.ground, 2.5
    yield "message beside STOP", colours.message_text, colours.message, READABLE


@pytest.mark.parametrize("theme", Theme)
def test_every_text_has_enough_contrast(theme: Theme) -> None:
    found = {
        name: round(contrast(*colours), 2)
        for name, *colours, least in pairs(style_of(theme))
        if contrast(*colours) < least
    }
    assert found == {}
    assert luminance(style_of(theme).message) < DARK, "the message beside STOP"


def cut(widget: QWidget) -> str:
    """Return a description of a widget whose text is cut off; empty if all of it has room."""
    if isinstance(widget, QLabel) and widget.text() and not isinstance(widget, ElidedLabel):
        inside = widget.contentsRect()
        flags = int(widget.alignment()) | (int(Qt.TextFlag.TextWordWrap) if widget.wordWrap() else 0)
        room = QRect(0, 0, inside.width(), 10_000)
        plain = QTextDocumentFragment.fromHtml(widget.text()).toPlainText()
        text = plain if "</" in widget.text() else widget.text()
        needed = widget.fontMetrics().boundingRect(room, flags, text)
        if needed.width() > inside.width() or needed.height() > inside.height() + 1:
            return f"{widget.text()!r} needs {needed.width()}x{needed.height()}, has {inside.width()}x{inside.height()}"
    elif isinstance(widget, ElidedLabel) and widget.least:
        needed_px = widget.fontMetrics().horizontalAdvance(widget.text())
        if needed_px > widget.width():
            return f"{widget.text()!r} needs {needed_px}, has {widget.width()}"
    elif (
        isinstance(widget, QToolButton) and widget.toolButtonStyle() == Qt.ToolButtonStyle.ToolButtonIconOnly
    ):
        return ""
    elif isinstance(widget, QAbstractButton) and widget.text() and widget.objectName() != "stop":
        needed_px = widget.fontMetrics().horizontalAdvance(widget.text().replace("&&", "&"))
        if needed_px > widget.width() - 4:
            return f"button {widget.text()!r} needs {needed_px}, has {widget.width()}"
    return ""


def outside(window: Window) -> Iterator[str]:
    """Yield a description of each visible widget that extends beyond its parent."""
    for widget in window.findChildren(QWidget):
        parent = widget.parentWidget()
        inner = widget.window() is window and widget.isVisible() and parent is not None
        if (
            inner
            and not parent.rect().contains(widget.geometry())
            and not widget.inherits("QWidgetLineControl")
        ):
            name = type(widget).__name__
            if name not in INNER:
                yield f"{name} {widget.accessibleName()} {widget.geometry()} in {type(parent).__name__} {parent.rect()}"


INNER = {"QListWidget", "QScrollBar", "QWidget", "Strip"}
"""Inner parts of scroll areas. They may extend beyond their parents, because Qt scrolls them."""


def faults(window: Window, size: tuple[int, int], name: str) -> Iterator[str]:
    """Yield a description of each fault of a window of this size."""
    for _ in range(3):  # a layout that changes asks its parent for a new layout
        QApplication.processEvents()
    assert (window.width(), window.height()) == size
    if size in SIZES and (needed := window.panels.area.widget().size()) != window.panels.area.size():
        yield f"{size} {name}: needs {needed.width()}x{needed.height()} above STOP, so it scrolls"
    for widget in window.findChildren(QWidget):
        if widget.isVisible() and widget.window() is window and (text := cut(widget)):
            yield f"{size} {name}: {text}"
    for text in outside(window):
        yield f"{size} {name}: {text}"


LARGEST = (Theme.PROJECTOR, "de")
"""Theme and language that need most room."""
LOOKS = [
    LARGEST,
    *(
        pytest.param(*look, marks=pytest.mark.long("needs less room"))
        for look in product(Theme, LANGUAGES)
        if look != LARGEST
    ),
]


@pytest.mark.parametrize(("theme", "language"), LOOKS)
def test_no_text_and_no_widget_is_cut_off(qtbot: QtBot, theme: Theme, language: str) -> None:
    state = ShownState(example("well", theme, language))
    window = Window(RecordingLink(), state)
    window.show()
    found: list[str] = []
    for size in (*SIZES, *SCALED):
        window.resize(*size)
        for name in STATES:
            state.shown = example(name, theme, language)
            window.refresh()
            found += faults(window, size, name)
        for tab in range(1, window.panels.tabs.count()):
            window.panels.tabs.setCurrentIndex(tab)
            found += faults(window, size, f"tab {tab}")
        window.panels.side.setCurrentIndex(1)
        window.panels.low_area.setCurrentIndex(window.panels.low_area.count() - 1)
        found += faults(window, size, "code and sequence")
        window.panels.low_area.setCurrentIndex(0)
        window.panels.tabs.setCurrentIndex(0)
        for name, drawer in product(("preview", "refusal", "taken"), (False, True)):
            state.shown = simple(example(name, theme, language), drawer=drawer)
            window.refresh()
            found += faults(window, size, f"{name}, simple, code {drawer}")
    window.close()
    window.deleteLater()
    assert not found, "\n".join(sorted(set(found)))


def simple(view: View, *, drawer: bool) -> View:
    """Return a view of the simple window."""
    return replace(view, choices=structs.replace(view.choices, simple=True, drawer=drawer))


def test_in_the_simple_window_the_head_is_the_star(window: Window, state: WatchedState) -> None:
    panels = window.panels
    hidden = (
        panels.arms,
        panels.head.table,
        panels.history,
        panels.sequence,
        panels.sending.lead,
        panels.head3d.live,
    )
    window.handle(Choose("tab", "plots"))
    for share, drawer in ((0.5, False), (0.25, True)):
        for name, value in (("simple", True), ("drawer", drawer)):
            window.handle(Choose(name, value))
        assert not list(faults(window, SIZE, "simple"))
        area = panels.head3d.width() * panels.head3d.height()
        assert area / (window.width() * window.height()) > share
        assert panels.head3d.isVisible(), "not the tab that was chosen before"
        assert panels.code.isVisible() is drawer
        assert not any(part.isVisible() for part in hidden)
        for part in (
            panels.head.pad,
            panels.sending.send,
            panels.gestures,
            panels.stop_bar,
            panels.head3d.code,
        ):
            assert part.isVisible()
    window.handle(Choose("simple", value=False))
    assert all(part.isVisible() for part in hidden if part is not panels.sequence)


def test_tab_reaches_every_control_as_the_eye_does(window: Window, qtbot: QtBot) -> None:
    panels = window.panels
    for small in (True, False):
        window.handle(Choose("simple", small))
        first, seen = panels.guide.buttons[0], list[QWidget]()
        first.setFocus()
        qtbot.waitUntil(first.hasFocus)
        while (now := present(QApplication.focusWidget())) not in seen:
            seen.append(now)
            window.focusNextChild()
        assert now is first
        assert all(widget.accessibleName() or widget.inherits("QTabBar") for widget in seen)
        expected = [panels.guide, panels.header, panels.head, panels.sending]
        expected += (
            [panels.commands, panels.head3d] if small else [panels.arms, panels.head3d, panels.commands]
        )
        places = [min(n for n, widget in enumerate(seen) if part.isAncestorOf(widget)) for part in expected]
        assert sorted(places) == places
        assert seen[-1] is panels.stop_bar


def test_letters_are_large_enough_to_be_read_from_the_last_row(window: Window) -> None:
    window.handle(Choose("theme", Theme.PROJECTOR))
    for tab in range(window.panels.tabs.count()):
        window.panels.tabs.setCurrentIndex(tab)
        QApplication.processEvents()
        shown = [widget for widget in window.findChildren(QWidget) if widget.isVisible()]
        assert [
            type(widget).__name__ for widget in shown if widget.fontInfo().pixelSize() < PROJECTED_PX
        ] == []


def test_the_sheet_that_connects_grows_with_its_message(window: Window, link: RecordingLink) -> None:
    """In German and in the theme with the largest letters it needs most room."""
    for intent in (Choose("theme", Theme.PROJECTOR), Choose("language", "de"), LookForPorts()):
        window.handle(intent)
    assert not list(faults(window, SIZE, "fresh"))
    for address in ("???", "the computer of " * 4):
        trouble = Trouble("connect.bad_address", slots={"address": address})
        link.known = replace(link.known, router_trouble=trouble)
        window.refresh()
        assert not list(faults(window, SIZE, address))


def test_stop_keeps_its_height_and_spans_more_than_half_the_window(qtbot: QtBot, window: Window) -> None:
    for size in (*SIZES, *SCALED, (640, 360)):
        window.resize(*size)
        QApplication.processEvents()
        bar = window.panels.stop_bar
        assert (window.width(), window.height()) == size
        assert bar.height() == bar.last.height() == STOP_PX
        assert bar.width() > size[0] / 2
        assert bar.mapTo(window, bar.rect().bottomLeft()).y() == size[1] - 1
        assert bar.last.mapTo(window, bar.last.rect().bottomRight()).x() == size[0] - 1


@pytest.mark.parametrize(
    ("room", "maximized"),
    [((1024, 600), True), ((1366, 768), True), ((1920, 800), True), ((1920, 1053), False)],
)
def test_a_window_that_would_not_fit_with_its_frame_begins_maximized(
    qtbot: QtBot, room: tuple[int, int], maximized: bool
) -> None:
    shown = QWidget()
    qtbot.add_widget(shown)
    show(shown, QSize(*room))
    assert (shown.isVisible(), shown.isMaximized()) == (True, maximized)
    assert maximized or shown.size() == QSize(*SIZE)
