"""A box for a number with its unit, which reads comma and point in every language."""

from __future__ import annotations

import re
from typing import Final

from PyQt5.QtCore import Qt, QTimer
from PyQt5.QtGui import QValidator
from PyQt5.QtWidgets import QDoubleSpinBox, QLabel, QSizePolicy

from gui.console.texts import Texts

NUMBER: Final = re.compile(r"[-−]?(\d+[.,]?\d*|[.,]\d+)")
BEGUN: Final = re.compile(r"[-−]?\d*[.,]?\d*")
"""What may become a number."""
SHOWN_MS: Final = 6000
"""Time for which a changed number is explained."""


class NumberBox(QDoubleSpinBox):
    """Reports a typed number at Enter or when it loses the focus; says what it changed if the number is out of range."""

    def __init__(self, texts: Texts, unit: str, least: float) -> None:
        super().__init__()
        self._texts = texts
        self.says = QLabel(self, Qt.WindowType.ToolTip)  # QToolTip hides when the focus or the pointer moves
        self.says.setProperty("role", "tooltip")
        self.setDecimals(1)
        self.setMinimum(least)
        self.setSuffix(unit)
        self.setKeyboardTracking(False)
        self.setButtonSymbols(QDoubleSpinBox.ButtonSymbols.NoButtons)
        self.setAlignment(Qt.AlignmentFlag.AlignRight)
        self.setSizePolicy(QSizePolicy.Policy.Fixed, QSizePolicy.Policy.Fixed)

    def validate(self, text: str | None, position: int) -> tuple[QValidator.State, str, int]:
        """Accept numbers within the limits; let others be typed, so that `fixup` can name the limit."""
        typed = self._typed(text)
        if not BEGUN.fullmatch(typed):
            state = QValidator.State.Invalid
        elif NUMBER.fullmatch(typed) and self.minimum() <= self.valueFromText(text) <= self.maximum():
            state = QValidator.State.Acceptable
        else:
            state = QValidator.State.Intermediate
        return state, text or "", position

    def valueFromText(self, text: str | None) -> float:  # noqa: N802
        """Return the number, with comma or point; the present one if the text is none."""
        typed = self._typed(text)
        if not NUMBER.fullmatch(typed):
            return self.value()
        return round(float(typed.replace(",", ".").replace("−", "-")), self.decimals())

    def fixup(self, text: str | None) -> str:
        """Return the nearest number within the limits, and say so beside the box."""
        asked = self.valueFromText(text)
        nearest = self.textFromValue(min(max(asked, self.minimum()), self.maximum()))
        if NUMBER.fullmatch(self._typed(text)):
            says = self._texts(
                "number.limited",
                asked=self._typed(text),
                nearest=f"{nearest}{self.suffix()}",
                least=f"{self.textFromValue(self.minimum())}{self.suffix()}",
                most=f"{self.textFromValue(self.maximum())}{self.suffix()}",
            )
            self.says.setText(says)
            self.says.adjustSize()
            self.says.move(self.mapToGlobal(self.rect().bottomLeft()))
            self.says.show()
            QTimer.singleShot(SHOWN_MS, self.says.hide)
        return nearest

    def _typed(self, text: str | None) -> str:
        return (text or "").removesuffix(self.suffix()).strip()
