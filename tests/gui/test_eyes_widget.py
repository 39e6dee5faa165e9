"""Pictures in the window: only visible ones are decoded, and missing ones have a reason."""

from __future__ import annotations

import time

import numpy as np
import pytest
import simplejpeg
from present import present
from PyQt5.QtGui import QImage
from pytestqt.qtbot import QtBot

from beatrix_zenoh.client import CameraImage
from gui.console.state.views import EyeView
from gui.console.texts import Texts
from gui.window.widgets import eyes
from gui.window.widgets.eyes import CameraPicture, EyesPanel

RED, BLUE = (220, 20, 20), (20, 20, 220)
WORDS = Texts("en")
ON = EyeView("sim", "left", "Simulation, left eye", watched=True, text="")


def picture_of(
    colour: tuple[int, int, int], eye: str = "left", seq: int = 1, *, t_s: float = 0.0, age_s: float = 0.0
) -> CameraImage:
    pixels = np.full((480, 640, 3), colour, dtype=np.uint8)
    return of_bytes(simplejpeg.encode_jpeg(pixels), eye, seq, t_s=t_s, age_s=age_s)


def of_bytes(
    jpeg: bytes, eye: str = "left", seq: int = 1, *, t_s: float = 0.0, age_s: float = 0.0
) -> CameraImage:
    arrived_ns = time.monotonic_ns() - round(age_s * 1e9)
    return CameraImage(jpeg, eye, seq, round(t_s * 1e9), 0, 640, 480, "egl", arrived_ns, 0)


class Decoder:
    """Decodes pictures, and stores the data that it has decoded."""

    def __init__(self) -> None:
        self.seen: list[bytes] = []

    def __call__(self, jpeg: bytes) -> QImage | None:
        self.seen.append(jpeg)
        return real_decode(jpeg)


real_decode = eyes.decode


@pytest.fixture
def decoder(monkeypatch: pytest.MonkeyPatch) -> Decoder:
    made = Decoder()
    monkeypatch.setattr(eyes, "decode", made)
    return made


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


def test_only_the_newest_picture_is_decoded_and_only_when_visible(
    qtbot: QtBot, picture: CameraPicture, decoder: Decoder
) -> None:
    for seq in range(100):
        picture.show_image(picture_of(RED, seq=seq))
    picture.show_image(picture_of(BLUE, seq=100))
    qtbot.wait(2 * eyes.PERIOD_MS)
    assert decoder.seen == [], "the widget is hidden"
    picture.show()
    qtbot.waitUntil(lambda: len(decoder.seen) == 1)
    assert alike(colour(picture, 0.5, 0.5), BLUE)
    picture.repaint()
    assert len(decoder.seen) == 1, "each picture is decoded once"


@pytest.mark.parametrize(
    "jpeg", [b"", b"nonsense", bytes(1000), simplejpeg.encode_jpeg(np.zeros((8, 8, 3), np.uint8))[:40]]
)
@pytest.mark.qt_log_ignore("JPEG")  # libjpeg logs a warning
def test_a_damaged_picture_is_reported_and_the_next_is_shown(picture: CameraPicture, jpeg: bytes) -> None:
    picture.show_image(picture_of(RED))
    picture.show_image(of_bytes(jpeg, seq=2))
    shown = picture.grab().toImage()
    picture.show_view(EyeView(ON.side, ON.eye, ON.title, watched=True, text=WORDS("label.picture_damaged")))
    picture.show_view(EyeView(ON.side, ON.eye, ON.title, watched=True, text=WORDS("label.picture_damaged")))
    assert picture.grab().toImage() == shown
    picture.show_view(ON)
    picture.show_image(picture_of(BLUE, seq=3))
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


def test_a_picture_whose_header_claims_too_many_pixels_is_not_decoded(picture: CameraPicture) -> None:
    """Height and width follow the marker 0xFFC0, the length of its segment and the precision."""
    jpeg = bytearray(picture_of(RED).jpeg)
    at = jpeg.index(b"\xff\xc0") + 5
    assert jpeg[at : at + 4] == (480).to_bytes(2, "big") + (640).to_bytes(2, "big")
    jpeg[at : at + 4] = 2 * (65500).to_bytes(2, "big")
    began_s = time.monotonic()
    assert eyes.decode(bytes(jpeg)) is None
    assert time.monotonic() - began_s < 0.5
    picture.show_image(of_bytes(bytes(jpeg)))
    shown = picture.grab().toImage()
    picture.show_view(EyeView(ON.side, ON.eye, ON.title, watched=True, text=WORDS("label.picture_damaged")))
    assert picture.grab().toImage() == shown
    whole = present(eyes.decode(picture_of(RED).jpeg))
    assert (whole.width(), whole.height()) == (640, 480)
