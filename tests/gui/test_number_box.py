"""Boxes for numbers in the window."""

from __future__ import annotations

import itertools

import pytest
from PyQt5.QtCore import QLocale, Qt
from PyQt5.QtGui import QValidator
from PyQt5.QtTest import QTest
from PyQt5.QtWidgets import QHBoxLayout, QPushButton, QWidget
from pytestqt.qtbot import QtBot

from gui.console.texts import Texts
from gui.window.widgets.controls import SliderBox
from gui.window.widgets.number_box import NumberBox

TYPED = {
    "1,5": (1.5, False),
    "1.5": (1.5, False),
    "12": (12.0, False),
    ",5": (0.5, False),
    "999": (90.0, True),
    "1,234": (1.2, False),
    "90,01": (90.0, False),
    "0": (0.1, True),
}
"""Typed text, the number that is used, and whether the box says that it has changed the number."""


@pytest.mark.parametrize("language", ["en", "de"])
def test_a_number_is_read_with_comma_and_point_in_every_language(qtbot: QtBot, language: str) -> None:
    both = QWidget()
    layout = QHBoxLayout(both)
    box, other = NumberBox(Texts(language), " °", 0.1), QPushButton()
    layout.addWidget(box)
    layout.addWidget(other)
    qtbot.addWidget(both)
    box.setLocale(QLocale(language))
    box.setMaximum(90.0)
    with qtbot.waitActive(both):
        both.show()
    ends = (lambda: QTest.keyClick(box, Qt.Key.Key_Return), other.setFocus)
    for (typed, (number, changed)), end in itertools.product(TYPED.items(), ends):
        box.says.hide()
        box.setValue(9.0)
        box.setFocus()
        box.selectAll()
        QTest.keyClicks(box, typed)
        end()
        assert box.value() == pytest.approx(number), typed
        assert box.says.isVisible() is changed, typed
        assert not changed or (typed in box.says.text() and "90" in box.says.text())
    for typed in ("1.2,3", "x", "1 2", "--1"):
        assert box.validate(typed + " °", 0)[0] == QValidator.State.Invalid, "it cannot be typed"


def test_a_number_that_is_being_typed_stays_while_its_limit_is_no_tenth(qtbot: QtBot) -> None:
    both = SliderBox(Texts("en"), "speed", least=0.1)
    qtbot.addWidget(both)
    limit = 90.00000250447816  # of 1.5708 rad, as a robot sends it
    both.show_value(30.0, limit)
    with qtbot.waitActive(both):
        both.show()
    both.box.setFocus()
    both.box.selectAll()
    QTest.keyClicks(both.box, "5")
    both.show_value(30.0, limit)
    assert both.box.text().startswith("5")
