"""What docs/how-to/window.md promises to show: the tabs, the marks of the pad, the page of the class, the keys."""

from __future__ import annotations

import re
from dataclasses import replace

import pytest
from gui_views import class_world, example
from PyQt5.QtCore import QPointF, Qt
from PyQt5.QtGui import QColor
from PyQt5.QtTest import QTest
from PyQt5.QtWidgets import QLabel
from pytestqt.qtbot import QtBot
from recording_link import RecordingLink
from robots import ROOT

from gui.console.state.intents import Theme
from gui.console.state.views import Orientation
from gui.console.texts import Texts
from gui.window.theme import style_of
from gui.window.widgets.eyes import Eyes, OutsideView
from gui.window.widgets.head_pad import HeadPad
from gui.window.widgets.plots import Plots
from gui.window.window import Window

PAGE = (ROOT / "docs/how-to/window.md").read_text(encoding="utf-8")
SIM, HW = Orientation(-60.0, -15.0, 15.0), Orientation(60.0, 15.0, -15.0)
DOTS = (Orientation(90.0, 0.0, 20.0), Orientation(120.0, 0.0, 25.0))


def test_the_tabs_of_the_middle_are_heads_eyes_and_plots(window: Window) -> None:
    tabs = window.panels.tabs
    names = [tabs.tabText(number) for number in range(tabs.count())]
    assert f"| {', '.join(names)} |" in PAGE
    for number, kind in enumerate((OutsideView, Eyes, Plots)):
        tabs.setCurrentIndex(number)
        page = tabs.currentWidget()
        assert page is not None
        assert [
            kind for kind in (OutsideView, Eyes, Plots) if isinstance(page, kind) or page.findChildren(kind)
        ] == [kind]


@pytest.mark.parametrize("theme", Theme)
def test_on_the_pad_the_simulation_is_a_cross_the_hardware_a_square_and_the_path_dots(
    qtbot: QtBot, theme: Theme
) -> None:
    pad = HeadPad(Texts("en"))
    qtbot.addWidget(pad)
    pad.resize(400, 400)
    pad.show_theme(theme)
    shown = example("ready", theme, "en").head
    pad.show_view(replace(shown, target=Orientation(0.0, 0.0, 0.0), sim=SIM, hw=HW, path=DOTS))
    picture, style = pad.grab().toImage(), style_of(theme)

    def shows(at: QPointF, colour: str) -> bool:
        seen, wanted = QColor(picture.pixel(int(at.x()), int(at.y()))), QColor(colour)
        return all(abs(a - b) < 30 for a, b in zip(seen.getRgb()[:3], wanted.getRgb()[:3], strict=True))

    for centre in (pad.tilt_point(SIM, shown.tilt_max), pad.yaw_point(SIM.yaw)):
        assert shows(centre + QPointF(8, 0), style.sim)
        assert shows(centre + QPointF(0, 8), style.sim)
        assert not shows(centre + QPointF(6, 6), style.sim), "a cross has no corners"
    for centre in (pad.tilt_point(HW, shown.tilt_max), pad.yaw_point(HW.yaw)):
        for corner in (QPointF(6, 6), QPointF(-6, 6), QPointF(6, -6), QPointF(-6, -6)):
            assert shows(centre + corner, style.hw)
    for at in DOTS:
        for centre in (pad.tilt_point(at, shown.tilt_max), pad.yaw_point(at.yaw)):
            assert shows(centre, style.dim)
            assert not shows(centre + QPointF(5, 5), style.dim)


def test_the_page_of_the_class_shows_state_driver_queue_rate_and_age_of_each_robot(
    window: Window, link: RecordingLink
) -> None:
    link.known = class_world()
    window.refresh()
    QTest.keyClick(window, Qt.Key.Key_F2)
    page = window.panels.class_page
    head = page.list.headerItem()
    assert head is not None
    titles = [head.text(column) for column in range(page.list.columnCount())]
    assert titles == ["Robot", "Twin", "State", "Driven by", "Waiting", "Pos./s", "Age", "Remarks"]
    items = [page.list.topLevelItem(row) for row in range(page.list.topLevelItemCount())]
    rows = [[item.text(column) for column in range(7)] for item in items if item is not None]
    assert [row[0] for row in rows] == [name for name in ("bea1", "bea2", "bea3", "bea4") for _ in range(2)]
    assert [row[1] for row in rows] == ["Simulation", "Hardware"] * 4
    states = ["► moving", "■ frozen", "○ motors off", "▲ board lost"]
    assert [row[2] for row in rows[::2]] == states
    assert [(row[3], row[4]) for row in rows[::2]] == [
        ("ana (taken)", "ben, cleo"),
        ("dora", ""),
        ("", ""),
        ("", ""),
    ]
    assert rows[0][5:7] == ["50", "0.0 s"]
    assert (rows[-1][2], rows[-1][5:7]) == ("◌ silent", ["0", "3.2 s"])
    assert all(seat in page.summary.text() for seat in ("ana", "ben", "cleo", "dora", "teacher"))


def test_the_sheet_shows_each_key_of_the_page(window: Window) -> None:
    QTest.keyClick(window, Qt.Key.Key_F1)
    sheet = window.panels.key_sheet
    assert sheet.isVisible()
    shown = " ".join(label.text() for label in sheet.findChildren(QLabel))
    table = PAGE.partition("## Keys")[2].partition("\n## ")[0]
    keys = [row for row in re.findall(r"^\| (.+?) \|", table, re.MULTILINE) if row not in ("key", "---")]
    words = {
        word for row in keys for word in re.findall(r"Space|Esc|Pause|rrow|Page up|Enter|Ctrl\+\w|F\d", row)
    }
    assert len(words) == 10
    assert not [word for word in words if word not in shown]
