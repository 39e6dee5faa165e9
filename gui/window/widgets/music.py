"""The menu of music and tones beside the sequence, and the marks of beats and tones on its cards."""

from __future__ import annotations

import math
from pathlib import Path

from PyQt5.QtCore import QPointF, QRect, QStandardPaths, pyqtSignal
from PyQt5.QtGui import QColor, QPainter
from PyQt5.QtWidgets import QAction, QActionGroup, QFileDialog, QMenu

from gui.console.state.music import ChooseMusic, SnapToBeat
from gui.console.state.views import CardView, MusicView
from gui.console.texts import Texts
from gui.window.theme import Style
from gui.window.widgets.controls import NO_MARGINS, in_row, named, plain_button
from gui.window.widgets.files import FilePanel

DOT_PX, STEP_PX = 4, 7
"""Size and distance of the dots of beats, at scale 1; many are nearer to each other."""
WHOLE = 0.02
"""Part of a beat by which a whole number of beats may be missed."""


class MusicMenu(FilePanel):
    """A button with the tempo, and its menu."""

    noted = pyqtSignal(int)
    """a tone for the selected card"""

    def __init__(self, texts: Texts) -> None:
        super().__init__(texts)
        self.choose = plain_button(texts("music.button"), texts("music.tip"), texts("music.name"))
        menu = QMenu(self.choose)
        self.title = menu.addAction("")
        self.title.setEnabled(False)
        self.open = menu.addAction(texts("music.open"), self._open)
        self.snap = menu.addAction(texts("music.snap"), lambda: self.intent.emit(SnapToBeat()))
        self.remove = menu.addAction(texts("music.remove"), lambda: self.intent.emit(ChooseMusic(None)))
        menu.setToolTipsVisible(True)
        self.tones = menu.addMenu(texts("music.tone"))
        group, self.notes = QActionGroup(self.tones), list[QAction]()
        for number, name in enumerate((texts("music.no_tone"), *texts("music.notes").split())):
            self.notes.append(entry := group.addAction(self.tones.addAction(name)))
            entry.setCheckable(True)
            entry.triggered.connect(lambda _on, note=number: self.noted.emit(note))
        self.choose.setMenu(menu)
        in_row((self.choose, 1), gap=0, margins=NO_MARGINS, inside=self)

    def show_view(self, view: MusicView) -> None:
        """Show the tempo, and what can be done."""
        self.choose.setText(view.text)
        name, tip = self._texts("music.name"), self._texts("music.tip")
        named(self.choose, f"{name}: {view.title}", f"{view.title}\n{tip}")
        self.title.setText(view.title.partition(". ")[0])  # a menu is as wide as its longest line
        for entry, shown in ((self.snap, view.snap), (self.remove, view.remove)):
            entry.setEnabled(shown.enabled)
            entry.setToolTip(shown.tooltip)

    def show_card(self, card: CardView | None) -> None:
        """Show the tone of the selected card."""
        self.tones.setEnabled(card is not None)
        self.notes[0 if card is None else card.note].setChecked(True)

    def _open(self) -> None:
        folder = QStandardPaths.writableLocation(QStandardPaths.StandardLocation.MusicLocation)
        opens = QFileDialog.AcceptMode.AcceptOpen
        self.choose_file(self._texts("music.open"), opens, "music", ChooseMusic, folder=Path(folder))


def paint_beats(painter: QPainter, place: QRect, beats: float, style: Style) -> None:
    """Draw a dot for each beat of a card at the top of its place; the last one is hollow if it is only a part."""
    whole = math.floor(beats + WHOLE)
    part = beats - whole > WHOLE
    size, step = style.px(DOT_PX), min(style.px(STEP_PX), (place.width() - 8) / (whole + 1))
    left = place.center().x() - (whole + part - 1) * step / 2
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    painter.setPen(QColor(style.warn if part else style.accent))
    for number in range(whole + part):
        painter.setBrush(painter.pen().color() if number < whole else QColor(0, 0, 0, 0))
        painter.drawEllipse(QPointF(left + number * step, place.top() + size / 2 + 1), size / 2, size / 2)
