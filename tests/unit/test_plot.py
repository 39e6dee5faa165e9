"""Figures are drawn without a display and show every curve."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from beatrix_zenoh.colours import ALL, hexadecimal, pale
from beatrix_zenoh.recording.compare import compare
from beatrix_zenoh.recording.plot import twin_figure
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
        assert [line.get_color() for line in sim] == [hexadecimal(pale(ALL[axis])) for axis in AXES[part]]
        assert [(line.get_label(), line.get_color()) for line in hw] == [
            (axis, hexadecimal(ALL[axis])) for axis in AXES[part]
        ]
    apart_deg = np.array([line.get_ydata() for line in apart.get_lines()])[:, found.compared]
    assert apart_deg == pytest.approx(np.full((6, apart_deg.shape[1]), 0.1), abs=1e-4)
    figure.savefig(tmp_path / "twin.png", dpi=50)
    with Image.open(tmp_path / "twin.png") as picture:
        assert np.asarray(picture.convert("L")).std() > 10
