"""What docs/how-to/window.md promises to show: the tabs, the marks of the pad, the page of the class, the keys."""

from __future__ import annotations

from dataclasses import replace

import pytest
from gui_views import example
from PyQt5.QtCore import QPointF
from PyQt5.QtGui import QColor
from pytestqt.qtbot import QtBot

from gui.console.state.intents import HeadOrientation, Theme
from gui.console.texts import Texts
from gui.window.theme import style_of
from gui.window.widgets.head import HeadPad

SIM, HW = HeadOrientation(-60.0, -15.0, 15.0), HeadOrientation(60.0, 15.0, -15.0)
DOTS = (HeadOrientation(90.0, 0.0, 20.0), HeadOrientation(120.0, 0.0, 25.0))


@pytest.mark.parametrize("theme", Theme)
def test_on_the_pad_the_simulation_is_a_cross_the_hardware_a_square_and_the_path_dots(
    qtbot: QtBot, theme: Theme
) -> None:
    pad = HeadPad(Texts("en"))
    qtbot.addWidget(pad)
    pad.resize(400, 400)
    pad.show_theme(theme)
    shown = example("ready", theme, "en").head
    pad.show_view(replace(shown, target=HeadOrientation(0.0, 0.0, 0.0), sim=SIM, hw=HW, path=DOTS))
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
