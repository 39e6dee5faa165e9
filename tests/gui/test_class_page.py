"""The page of the class and the buttons of leases, by mouse and keyboard."""

from __future__ import annotations

from dataclasses import replace

import pytest
from gui_views import class_world, full_class, lesson, turns
from present import present
from PyQt5.QtCore import Qt
from PyQt5.QtTest import QTest
from PyQt5.QtWidgets import QApplication
from recording_link import RecordingLink, WatchedState

from beatrix_zenoh.contract._generated.messages import LeaseAction
from gui.console.state.actions import ChooseRobot, Govern, SendStop, Watch
from gui.console.state.intents import LimitClass
from gui.window.widgets.class_page import ClassPage
from gui.window.window import Window

LEFT = Qt.MouseButton.LeftButton


@pytest.fixture
def link() -> RecordingLink:
    link = RecordingLink()
    link.known = class_world()
    return link


@pytest.fixture
def page(window: Window, link: RecordingLink, state: WatchedState) -> ClassPage:
    """The page of the class, shown by its key."""
    QTest.keyClick(window, Qt.Key.Key_F2)
    assert window.panels.class_page.isVisible()
    assert link.done[-1] == Watch(class_page=True)
    state.intents.clear()
    return window.panels.class_page


def test_the_page_takes_the_place_of_the_robot(window: Window, page: ClassPage) -> None:
    assert not window.panels.body.isVisible()
    assert page.list.topLevelItemCount() == 8
    assert page.list.hasFocus()
    assert window.panels.stop_bar.word.text() == "STOP ALL"
    QTest.mouseClick(window.panels.header.page, LEFT)
    assert window.panels.body.isVisible()
    assert not page.isVisible()


def shown(page: ClassPage) -> list[str]:
    """Return the texts of the first row in the columns that are shown."""
    item = present(page.list.topLevelItem(0))
    return [item.text(n) for n in range(page.list.columnCount()) if not page.list.isColumnHidden(n)]


def test_f11_shows_whose_turn_it_is_in_large_type_on_the_whole_screen(
    window: Window, page: ClassPage, link: RecordingLink
) -> None:
    link.known = turns(8)
    window.refresh()
    small = page.list.fontInfo().pixelSize()
    QTest.mouseClick(page.project, LEFT)
    window.showNormal()
    window.resize(1920, 1080)
    QApplication.processEvents()
    assert shown(page)[3:] == ["Ana Müller (ana) (taken)", "", ""]
    assert page.list.fontInfo().pixelSize() > 2 * small
    assert sum(page.list.columnWidth(n) for n in range(page.list.columnCount())) <= page.list.width()
    assert not any(
        part.isVisible() for part in (page.freeze_all, page.take, page.summary, page.tabs.tabBar())
    )
    assert window.panels.stop_bar.isVisible()
    QTest.keyClick(window, Qt.Key.Key_F11)
    assert (window.isFullScreen(), page.large, page.freeze_all.isVisible()) == (False, False, True)
    assert page.list.fontInfo().pixelSize() == small
    assert len(shown(page)) == page.list.columnCount()


def test_f11_opens_the_page_of_the_class_and_f2_ends_the_large_type(window: Window) -> None:
    QTest.keyClick(window, Qt.Key.Key_F11)
    assert (window.isFullScreen(), window.panels.class_page.isVisible()) == (True, True)
    assert not window.panels.header.isVisible()
    QTest.keyClick(window, Qt.Key.Key_F2)
    assert (window.isFullScreen(), window.panels.body.isVisible()) == (False, True)


def test_buttons_report_their_intents(page: ClassPage, state: WatchedState) -> None:
    for button, intent in (
        (page.freeze_all, Govern(0, LeaseAction.FREEZE)),
        (page.unfreeze_all, Govern(0, LeaseAction.UNFREEZE)),
        (page.freeze, Govern(0, LeaseAction.FREEZE, (("bea1", "sim"),))),
        (page.take, Govern(0, LeaseAction.TAKE, (("bea1", "sim"),))),
        (page.show_robot, ChooseRobot("bea1")),
    ):
        assert button.toolTip()
        QTest.mouseClick(button, LEFT)
        assert state.intents == [intent]
        state.intents.clear()


def test_a_limit_is_typed_and_sent_by_enter(
    page: ClassPage, state: WatchedState, link: RecordingLink
) -> None:
    page.limit.setFocus()
    QTest.keyClicks(page.limit, "20")
    QTest.keyClick(page.limit, Qt.Key.Key_Space)
    assert link.done[-1] == SendStop(1, everywhere=True), "Space stops all robots, also in a field"
    state.intents.clear()
    QTest.keyClick(page.limit, Qt.Key.Key_Return)
    page.limit.clear()
    QTest.mouseClick(page.set_limit, LEFT)
    assert state.intents == [LimitClass("20"), LimitClass("")]
    limits = [action.speed for action in link.done if isinstance(action, Govern)]
    assert limits == [pytest.approx(0.349, abs=0.001), 0.0]


def test_the_lessons_of_a_class_fit_and_follow_the_reports(
    window: Window, page: ClassPage, link: RecordingLink
) -> None:
    link.known = full_class()
    window.refresh()
    page.tabs.setCurrentIndex(1)
    QApplication.processEvents()
    table = page.lessons.list
    assert (page.tabs.tabText(1), table.topLevelItemCount()) == ("Lessons: 3 stuck", 30)
    first = present(table.topLevelItem(0))
    stuck = "▲ stuck for 5 checks; asked: a program that ends without an error"
    shown = ["Emil Müller (emil)", "05-inverse", stuck, "4", "✓", "✓", "✓", "✓", "▲", "–", "–"]
    assert [first.text(column) for column in range(table.columnCount())] == shown
    assert present(table.horizontalScrollBar()).maximum() == 0, "no column is outside"

    table.setCurrentItem(table.topLevelItem(2))
    reports = (*(full_class().reports or ()), lesson("zoe", "02-steps", stuck=9))
    link.known = replace(full_class(), reports=reports)
    window.refresh()
    assert table.chosen == "wim", "the selected seat stays selected"
    assert page.tabs.tabText(1) == "Lessons: 4 stuck"

    link.known = replace(full_class(), reports=())
    window.refresh()
    assert not table.isVisible()
    assert "beatrix join" in page.lessons.empty.text()
