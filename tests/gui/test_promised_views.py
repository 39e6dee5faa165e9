"""What docs/how-to/window.md promises to show: the tabs, the marks of the pad, the page of the class, the keys."""

from __future__ import annotations

import re
from dataclasses import replace

import pytest
from gui_views import example
from PyQt5.QtCore import QPointF, Qt
from PyQt5.QtGui import QColor
from PyQt5.QtTest import QTest
from PyQt5.QtWidgets import QLabel
from pytestqt.qtbot import QtBot
from robots import ROOT

from gui.console.state.intents import Theme
from gui.console.state.views import Orientation
from gui.console.texts import Texts
from gui.window.theme import style_of
from gui.window.widgets.eyes import EyesPanel, OutsideView
from gui.window.widgets.head import HeadPad
from gui.window.widgets.plots import PlotsPanel
from gui.window.window import Window

PAGE = (ROOT / "docs/how-to/window.md").read_text(encoding="utf-8")
SIM, HW = Orientation(-60.0, -15.0, 15.0), Orientation(60.0, 15.0, -15.0)
DOTS = (Orientation(90.0, 0.0, 20.0), Orientation(120.0, 0.0, 25.0))


def test_the_tabs_of_the_middle_are_heads_eyes_and_plots(window: Window) -> None:
    tabs = window.panels.tabs
    names = [tabs.tabText(number) for number in range(tabs.count())]
    assert f"| {', '.join(names)} |" in PAGE
    for number, kind in enumerate((OutsideView, EyesPanel, PlotsPanel)):
        tabs.setCurrentIndex(number)
        page = tabs.currentWidget()
        assert page is not None
        assert [
            kind
            for kind in (OutsideView, EyesPanel, PlotsPanel)
            if isinstance(page, kind) or page.findChildren(kind)
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
