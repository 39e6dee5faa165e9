"""The levels of the microphones in the window."""

from __future__ import annotations

from pytestqt.qtbot import QtBot

from gui.console.state.intents import Choose, Intent
from gui.console.state.views import LevelView, SoundView
from gui.console.texts import Texts
from gui.window.widgets.eyes import LevelsPanel

LOUD = LevelView("sim", "Simulation", 0.75, 0.5, "left -20 dB, right -40 dB")
ABSENT = LevelView("hw", "Hardware", 0.0, 0.0, "not online")


def test_bars_are_there_only_while_the_box_is_checked(qtbot: QtBot) -> None:
    panel = LevelsPanel(Texts("en"))
    qtbot.addWidget(panel)
    panel.show()
    panel.show_view(SoundView(False, (LOUD, ABSENT)))
    assert not any(bar.isVisible() for bar in panel.bars.values())
    panel.show_view(SoundView(True, (LOUD, ABSENT)))
    assert [bar.value() for bar in panel.bars.values()] == [75, 50, 0, 0]
    assert all(bar.isVisible() for bar in panel.bars.values())
    assert [text.text() for text in panel.texts.values()] == [LOUD.text, ABSENT.text]


def test_the_box_reports_what_the_user_wants(qtbot: QtBot) -> None:
    panel, intents = LevelsPanel(Texts("en")), list[Intent]()
    qtbot.addWidget(panel)
    panel.intent.connect(intents.append)
    panel.show_view(SoundView(False, (LOUD, ABSENT)))
    panel.box.click()
    assert intents == [Choose("microphones", value=True)]
    assert not panel.box.isChecked(), "only the view changes it"
