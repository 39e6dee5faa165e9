"""Pictures and levels of sound in the window: only visible pictures are decoded, and missing ones have a reason."""

from __future__ import annotations

import time
from dataclasses import replace

import msgspec
import numpy as np
import pytest
import simplejpeg
from PyQt5.QtWidgets import QApplication
from pytestqt.qtbot import QtBot

from beatrix_zenoh.client import CameraImage
from gui.console.state.intents import Choose, Intent
from gui.console.state.views import EyeView, LevelView, SoundView
from gui.console.texts import Texts
from gui.window.widgets.eyes import CameraPicture, EyesPanel, LevelsPanel, decode

RED, BLUE = (220, 20, 20), (20, 20, 220)
WORDS = Texts("en")
ON = EyeView("sim", "left", "Simulation, left eye", watched=True, text="")


LEVELS = (
    LevelView("sim", "Simulation", 0.75, 0.5, "left -20 dB, right -40 dB"),
    LevelView("hw", "Hardware", 0.0, 0.0, "not online"),
)
DAMAGED = replace(ON, text=WORDS("label.picture_damaged"))


def picture_of(colour: tuple[int, int, int], eye: str = "left") -> CameraImage:
    return of_bytes(simplejpeg.encode_jpeg(np.full((480, 640, 3), colour, dtype=np.uint8)), eye)


def of_bytes(jpeg: bytes, eye: str = "left") -> CameraImage:
    return CameraImage(
        jpeg=jpeg, eye=eye, seq=1, t_mono_ns=0, t_wall_ns=0, width=640, height=480, source="egl",
        arrived_mono_ns=time.monotonic_ns(), arrived_wall_ns=0,
    )  # fmt: skip


LARGE = picture_of(RED).jpeg.replace((480).to_bytes(2, "big") + (640).to_bytes(2, "big"), b"\xff\xdc" * 2, 1)
"""A picture whose header claims 65500 lines and columns."""


@pytest.fixture
def picture(qtbot: QtBot) -> CameraPicture:
    made = CameraPicture(WORDS)
    qtbot.addWidget(made)
    made.resize(400, 400)
    made.show_view(ON)
    return made


def colour(widget: CameraPicture | EyesPanel, x: float, y: float) -> tuple[int, int, int]:
    """Return the colour at a point of the widget; x and y are fractions of its size."""
    image = widget.grab().toImage()
    pixel = image.pixelColor(int(x * image.width()), int(y * image.height()))
    return pixel.red(), pixel.green(), pixel.blue()


def alike(one: tuple[int, int, int], other: tuple[int, int, int]) -> bool:
    return max(abs(a - b) for a, b in zip(one, other, strict=True)) < 20


def test_only_the_newest_picture_is_decoded_and_only_when_visible(picture: CameraPicture) -> None:
    decode.cache_clear()
    for shown in (RED, RED, BLUE):
        picture.show_image(picture_of(shown))
    QApplication.processEvents()
    assert decode.cache_info().misses == 0, "the widget is hidden"
    assert alike(colour(picture, 0.5, 0.5), BLUE)
    picture.grab()
    assert decode.cache_info().misses == 1, "each picture is decoded once"


def test_an_old_picture_shows_its_age(picture: CameraPicture) -> None:
    picture.show_image(
        msgspec.structs.replace(picture_of(RED), arrived_mono_ns=time.monotonic_ns() - 5_000_000_000)
    )
    before = picture.grab().toImage()
    picture.show_view(ON)
    assert picture.grab().toImage() != before


@pytest.mark.parametrize("jpeg", [b"", b"nonsense", LARGE], ids=["empty", "nonsense", "too large"])
@pytest.mark.qt_log_ignore("JPEG")  # libjpeg logs a warning
def test_a_damaged_picture_is_reported_and_the_next_is_shown(picture: CameraPicture, jpeg: bytes) -> None:
    picture.show_image(of_bytes(jpeg))
    shown = picture.grab().toImage()
    picture.show_view(DAMAGED)
    assert picture.grab().toImage() == shown
    picture.show_view(ON)
    picture.show_image(picture_of(BLUE))
    assert alike(colour(picture, 0.5, 0.5), BLUE)


def test_both_eyes_of_both_robots_have_their_places(qtbot: QtBot) -> None:
    shown = EyesPanel(WORDS)
    qtbot.addWidget(shown)
    shown.resize(640, 520)
    all_eyes = [
        EyeView(side, eye, f"{side} {eye}", watched=True, text="")
        for side in ("sim", "hw")
        for eye in ("left", "right")
    ]
    shown.show_view(tuple(all_eyes))
    colours = (RED, (20, 220, 20), (220, 220, 20), BLUE)
    for view, painted in zip(all_eyes, colours, strict=True):
        shown.show_image(view.side, picture_of(painted, view.eye))
    places = ((0.25, 0.25), (0.75, 0.25), (0.25, 0.75), (0.75, 0.75))
    for place, painted in zip(places, colours, strict=True):
        assert alike(colour(shown, *place), painted)


def test_bars_are_there_only_while_the_box_is_checked(qtbot: QtBot) -> None:
    panel, intents = LevelsPanel(WORDS), list[Intent]()
    qtbot.addWidget(panel)
    panel.show()
    panel.intent.connect(intents.append)
    panel.show_view(SoundView(False, LEVELS))
    assert not any(bar.isVisible() for bar in panel.bars.values())
    panel.box.click()
    assert intents == [Choose("microphones", value=True)]
    panel.show_view(SoundView(True, LEVELS))
    assert all(bar.isVisible() for bar in panel.bars.values())
    assert [bar.value() for bar in panel.bars.values()] == [75, 50, 0, 0]
    assert [text.text() for text in panel.texts.values()] == [level.text for level in LEVELS]
