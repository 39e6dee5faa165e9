"""Figures are drawn without a display and show every curve."""

from __future__ import annotations

import io
import math
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from viewer_pictures import pictures
from written_recordings import BEGAN_NS, write_lesson

from beatrix_zenoh.body.figure import Figure
from beatrix_zenoh.colours import ALL, STYLES, hexadecimal, pale
from beatrix_zenoh.motion.kinematics import Neck
from beatrix_zenoh.motion.rotation import rotation_of
from beatrix_zenoh.recording.compare import compare
from beatrix_zenoh.recording.plot import twin_figure
from beatrix_zenoh.recording.rows import BodyTurn, Numbers, RecordingRow, of_model, of_robot
from beatrix_zenoh.recording.rrd.scene import BACKGROUND
from beatrix_zenoh.recording.series import AXES, Recording


def test_two_recordings_are_drawn(tmp_path: Path) -> None:
    t = np.arange(0.0, 4.0, 0.02)
    first = Recording(t, np.sin(t)[:, None] * np.arange(1, 7))
    found = compare(first, Recording(t, first.angles + 0.1))
    figure = twin_figure(found, "two robots")
    arms, head, apart = figure.axes
    for panel, part in ((arms, slice(0, 3)), (head, slice(3, 6))):
        hw, sim = panel.get_lines()[:3], panel.get_lines()[3:]
        assert np.array([line.get_ydata() for line in sim]) == pytest.approx(found.first[:, part].T)
        assert np.array([line.get_ydata() for line in hw]) == pytest.approx(found.first[:, part].T + 0.1)
        assert [line.get_color() for line in hw] == [hexadecimal(ALL[axis]) for axis in AXES[part]]
        assert [line.get_color() for line in sim] == [hexadecimal(pale(ALL[axis])) for axis in AXES[part]]
        assert {line.get_alpha() for line in (*hw, *sim)} == {None}, "as in the viewer"
        assert [line.get_label() for line in hw] == list(AXES[part])
        assert min(line.get_linewidth() for line in hw) > 2 * max(line.get_linewidth() for line in sim)
    apart_deg = np.array([line.get_ydata() for line in apart.get_lines()])[:, found.compared]
    assert apart_deg == pytest.approx(0.1, abs=1e-4)
    assert len(apart.get_lines()) == 6
    assert arms.get_title(loc="left") == STYLES
    assert [panel.get_ylabel() for panel in figure.axes] == [
        "arms (°)",
        "head (°)",
        "hardware - simulation (°)",
    ]
    figure.savefig(tmp_path / "twin.png", dpi=50)
    with Image.open(tmp_path / "twin.png") as picture:
        assert np.asarray(picture.convert("L")).std() > 10


# -- pictures of a recording, drawn without a screen and checked by their pixels -------------------


SIM, HW = ("bea", "sim"), ("bea", "hw")


def rows(place: tuple[str, str], yaw: float) -> list[RecordingRow]:
    """Return rows of a robot whose head is turned by `yaw` (rad)."""
    arms = Neck().inverse(yaw, 0.0, 0.0)
    turns = Figure().rotations(arms, rotation_of(yaw, 0.0, 0.0))
    poses: list[RecordingRow] = [
        BodyTurn(of_model(place, path), BEGAN_NS, BEGAN_NS, turn) for path, turn in turns.items()
    ]
    numbers = (math.degrees(yaw),) * 3
    return [*poses, Numbers(of_robot(place, "arms"), BEGAN_NS, BEGAN_NS, numbers)]


@pytest.fixture
def path(tmp_path: Path) -> Path:
    """A recording of two robots, of which the simulation has turned."""
    path = tmp_path / "lesson.rrd"
    write_lesson(path, [SIM, HW], 0, [*rows(SIM, 0.8), *rows(HW, 0.0)])
    return path


@pytest.mark.long("a renderer without a graphics card")
def test_the_ghost_is_visible_beside_the_hardware_and_both_robots_side_by_side(path: Path) -> None:
    overlay, beside = (
        np.asarray(Image.open(io.BytesIO(png)).convert("RGB"), dtype=np.int64)
        for png in pictures(path, [(0, BEGAN_NS / 1e9), (1, BEGAN_NS / 1e9)])
    )
    assert np.mean(background(overlay)) > 0.5
    assert share_of_blue(overlay) > 0.005  # without the ghost, the long arm alone has 0.003
    left, right = np.array_split(beside, 2, axis=1)
    for half in (left, right):
        assert 0.01 < np.mean(~background(half[150:])) < 0.5, "one robot; titles are above"
        assert 0.001 < share_of_blue(half) < 0.008, "its long arm, and no ghost"
    assert np.mean(background(left) != background(right)) > 0.005, "the simulation has turned"


Picture = np.ndarray[tuple[int, ...], np.dtype[np.int64]]


def background(picture: Picture) -> np.ndarray[tuple[int, ...], np.dtype[np.bool_]]:
    """Return which pixels show no robot."""
    return np.all(np.abs(picture - BACKGROUND) < 6, axis=2)  # type: ignore[no-any-return]


def share_of_blue(picture: Picture) -> float:
    """Return the share of blue pixels: the long arm and the ghost."""
    red, green, blue = np.moveaxis(picture, 2, 0)
    return float(np.mean((blue > red + 60) & (blue > green + 20)))
