"""Eyes and ears of both robots: the pictures of the cameras, and the levels of the microphones."""

from __future__ import annotations

import time
from functools import lru_cache
from typing import Final

from PyQt5.QtCore import QBuffer, QRect, Qt
from PyQt5.QtGui import QImage, QImageReader, QPainter, QPaintEvent
from PyQt5.QtWidgets import QGridLayout, QLabel, QProgressBar, QSizePolicy, QWidget

from beatrix_zenoh.client import CameraImage
from beatrix_zenoh.contract.names import EYES, SIDES
from gui.console.state.views import EyeView, SoundView
from gui.console.texts import Texts
from gui.window.widgets.controls import (
    NO_MARGINS,
    ChoiceCheck,
    ElidedLabel,
    Panel,
    in_column,
    in_row,
    label,
    set_role,
    spaced,
)

LEVEL_STEPS: Final = 100
LEVEL_PX: Final = 8
MARGIN_PX: Final = 12


class LevelsPanel(Panel):
    """One row for each robot: its name, a bar for the left and for the right ear, and their levels."""

    def __init__(self, texts: Texts) -> None:
        super().__init__()
        self.box = ChoiceCheck(texts, "microphones")
        self.reports(self.box.intent)
        self.bars = {(side, ear): QProgressBar() for side in SIDES for ear in (0, 1)}
        self.titles = {side: QLabel() for side in SIDES}
        self.texts = {side: ElidedLabel(least=0) for side in SIDES}
        grid = spaced(QGridLayout(self), 4, NO_MARGINS)
        grid.addWidget(self.box, 0, 0, len(SIDES), 1)
        for line, side in enumerate(SIDES):
            grid.addWidget(self.titles[side], line, 1)
            grid.addWidget(self.texts[side], line, 4)
        for (side, ear), bar in self.bars.items():
            bar.setProperty("side", side)
            bar.setRange(0, LEVEL_STEPS)
            bar.setTextVisible(False)
            bar.setFixedHeight(LEVEL_PX)
            bar.setInvertedAppearance(ear == 0)  # both grow from the middle
            grid.addWidget(bar, SIDES.index(side), 2 + ear)
        for column, stretch in ((2, 1), (3, 1), (4, 2)):
            grid.setColumnStretch(column, stretch)

    def show_view(self, view: SoundView) -> None:
        """Show the levels."""
        for level in view.levels:
            self.titles[level.side].setText(level.title)
            self.texts[level.side].setText(level.text)
            self.texts[level.side].setToolTip(level.text)
            for ear, share in enumerate((level.left, level.right)):
                bar = self.bars[level.side, ear]
                bar.setVisible(view.on)
                bar.setValue(round(share * LEVEL_STEPS))
                bar.setAccessibleName(f"{level.title}: {level.text}")


STALE_S: Final = 1.0
"""Age of the newest picture above which the title shows this age."""
NO_BREAK: Final = "\u2011"
"""A hyphen at which a line does not end."""


LARGEST_PX: Final = 10_000_000
"""Largest number of pixels of a picture: decoding a larger one would block the window."""


@lru_cache(maxsize=len(SIDES) * len(EYES))  # a picture is painted several times
def decode(jpeg: bytes) -> QImage | None:
    """Return the image of a JPEG file; None if it is damaged or has more than `LARGEST_PX` pixels."""
    buffer = QBuffer()
    buffer.setData(jpeg)
    reader = QImageReader(buffer, b"JPEG")
    size = reader.size()  # from the header alone
    if not size.isValid() or size.width() * size.height() > LARGEST_PX:
        return None
    image = reader.read()
    return None if image.isNull() else image


class CameraPicture(QWidget):
    """The newest picture of one camera under its title, or the reason why there is none.

    Pictures are decoded only when drawn: none while the widget is hidden.
    """

    def __init__(self, texts: Texts) -> None:
        super().__init__()
        self._damaged, self._waiting = texts("label.picture_damaged"), texts("eye.waiting")
        self._text = ""
        """the reason why there is no picture"""
        self._newest: CameraImage | None = None
        self.title, self.age = ElidedLabel(), label(role="warn")
        """the age of the newest picture; empty: it is new"""
        above = in_row((self.title, 1), self.age, margins=(6, 2, 6, 2))
        in_column(above, None, gap=0, margins=NO_MARGINS, inside=self)
        self.setToolTip(texts("tip.picture"))
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)
        self.setMinimumSize(100, 46)

    def show_view(self, view: EyeView) -> None:
        """Show title, text and note; with a text, or if the camera is not watched, remove the picture."""
        if view.text or not view.watched:
            self._newest = None
        age_s = 0.0 if self._newest is None else (time.monotonic_ns() - self._newest.arrived_mono_ns) / 1e9
        self.age.setText(f"{age_s:.0f} s" if age_s > STALE_S else "")
        set_role(self.title, "role", view.side)
        self.title.setText(view.title)
        self.setAccessibleName(view.title)
        self.setAccessibleDescription(view.text)
        self._text = view.text
        self.update()

    def show_image(self, image: CameraImage) -> None:
        """Show a new picture."""
        self._newest = image
        self.age.setText("")
        self.update()

    def paintEvent(self, event: QPaintEvent) -> None:  # noqa: N802, ARG002
        painter = QPainter(self)
        below = self.rect().adjusted(0, self.title.geometry().bottom() + 3, 0, 0)
        painter.fillRect(below, self.palette().base())
        image = None if self._text or self._newest is None else decode(self._newest.jpeg)
        if image is None:
            text = self._text or (self._waiting if self._newest is None else self._damaged)
            painter.setPen(self.palette().text().color())
            inner = below.adjusted(MARGIN_PX, MARGIN_PX, -MARGIN_PX, -MARGIN_PX)
            whole = text.replace("-", NO_BREAK)  # an option of a command stays on one line
            painter.drawText(inner, int(Qt.AlignmentFlag.AlignCenter) | int(Qt.TextFlag.TextWordWrap), whole)
        else:
            size = image.size().scaled(below.size(), Qt.AspectRatioMode.KeepAspectRatio)
            place = QRect(below.topLeft(), size)
            place.moveCenter(below.center())
            painter.setRenderHint(QPainter.RenderHint.SmoothPixmapTransform)
            painter.drawImage(place, image)


class EyesPanel(Panel):
    """The pictures of the eyes: a row for each robot, the left eye on the left; below them what its ears hear."""

    def __init__(self, texts: Texts) -> None:
        super().__init__()
        grid = spaced(QGridLayout(self), 6, NO_MARGINS)
        self.pictures = {(side, eye): CameraPicture(texts) for side in SIDES for eye in EYES}
        for (side, eye), picture in self.pictures.items():
            grid.addWidget(picture, SIDES.index(side), EYES.index(eye))
        self.cameras = ChoiceCheck(texts, "cameras")
        self.reports(self.cameras.intent)
        self.sound = LevelsPanel(texts)
        below = in_row(self.cameras, (self.sound, 1), gap=12)
        below.setAlignment(self.cameras, Qt.AlignmentFlag.AlignTop)
        grid.addLayout(below, len(SIDES), 0, 1, len(EYES))

    def show_view(self, eyes: tuple[EyeView, ...]) -> None:
        """Show the eyes of both robots."""
        for view in eyes:
            self.pictures[view.side, view.eye].show_view(view)

    def show_image(self, side: str, image: CameraImage) -> None:
        """Show a picture of an eye."""
        self.pictures[side, image.eye].show_image(image)
