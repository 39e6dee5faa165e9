"""The levels of the microphones: a box that switches them on, and two bars for each robot."""

from __future__ import annotations

from typing import Final

from PyQt5.QtWidgets import QGridLayout, QLabel, QProgressBar, QSizePolicy

from beatrix_zenoh.contract.names import SIDES
from gui.console.state.views import SoundView
from gui.console.texts import Texts
from gui.window.widgets.controls import NO_MARGINS, ChoiceCheck, ElidedLabel, Panel, spaced

STEPS: Final = 100
BAR_PX: Final = 8


class LevelsPanel(Panel):
    """One row for each robot: its name, a bar for the left and for the right ear, and their levels."""

    def __init__(self, texts: Texts) -> None:
        super().__init__()
        self._view: SoundView | None = None
        self.box = ChoiceCheck(texts, "microphones")
        self.box.intent.connect(self.intent)
        self.bars = {(side, ear): QProgressBar() for side in SIDES for ear in (0, 1)}
        self.titles = {side: QLabel() for side in SIDES}
        self.texts = {side: ElidedLabel() for side in SIDES}
        grid = spaced(QGridLayout(self), 4, NO_MARGINS)
        grid.addWidget(self.box, 0, 0, len(SIDES), 1)
        for row, side in enumerate(SIDES):
            grid.addWidget(self.titles[side], row, 1)
            grid.addWidget(self.texts[side], row, 4)
        for (side, ear), bar in self.bars.items():
            bar.setProperty("side", side)
            bar.setRange(0, STEPS)
            bar.setTextVisible(False)
            bar.setFixedHeight(BAR_PX)
            bar.setInvertedAppearance(
                ear == 0
            )  # both grow from the middle, as the ears are beside each other
            grid.addWidget(bar, SIDES.index(side), 2 + ear)
        for text in self.texts.values():  # a long reason must not widen the window
            text.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Preferred)
        for column, stretch in ((2, 1), (3, 1), (4, 2)):
            grid.setColumnStretch(column, stretch)

    def show_view(self, view: SoundView) -> None:
        """Show the levels."""
        if view == self._view:
            return
        self._view = view
        for level in view.levels:
            self.titles[level.side].setText(level.title)
            self.texts[level.side].setText(level.text)
            self.texts[level.side].setToolTip(level.text)
            for ear, share in enumerate((level.left, level.right)):
                bar = self.bars[level.side, ear]
                bar.setVisible(view.on)
                bar.setValue(round(share * STEPS))
                bar.setAccessibleName(f"{level.title}: {level.text}")
