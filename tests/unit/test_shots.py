"""Photos and films of poses, read again: their sizes, their times, and what they show."""

from __future__ import annotations

import sys
from pathlib import Path

import av
import numpy as np
import pytest
from PIL import Image

from gui.console import shots
from gui.console.shots import PHOTO, Pose, Shot, written

HOME: Pose = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
LEFT: Pose = (30.0, 30.0, 30.0, 30.0, 0.0, 0.0)


def shot(*moments: tuple[Pose, ...]) -> Shot:
    titles = ("Simulation", "Hardware") if len(moments[0]) > 1 else ("",)
    return Shot("Zoë Müller · bea1", "2026-11-30", titles, list(moments))


def test_a_photo_shows_each_robot_and_the_caption(tmp_path: Path) -> None:
    path = written(tmp_path / "new" / "bea1", shot((LEFT, HOME)))
    picture = np.asarray(Image.open(path).convert("RGB")).astype(int)
    width, height = PHOTO
    assert (path.name, picture.shape) == ("bea1.png", (height * 13 // 12, width * 2, 3))
    face = picture[: height // 2]
    blue = (face[..., 2] - face[..., 0] > 60) & (face[..., 1] > 90)  # the irises
    left, ahead = (blue[:, k * width : (k + 1) * width].nonzero()[1].mean() for k in range(2))
    assert left > max(width / 2, ahead + 30), "it looks to its left"
    assert (picture[height:].max(axis=2) < 100).sum() > 500, "the caption is dark"
    assert [path.name for path in path.parent.iterdir()] == ["bea1.png"]


@pytest.mark.parametrize("ending", [".mp4", ".gif"])
def test_a_film_lasts_as_long_as_its_poses(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, ending: str
) -> None:
    for size in ("FILM", "GIF"):
        monkeypatch.setattr(shots, size, (160, 120))
    if ending == ".gif":
        monkeypatch.setitem(sys.modules, "beatrix_zenoh.body.video", None)
    path = written(tmp_path / "bea1", shot(*((HOME,), (LEFT,)) * 10))
    assert path.suffix == ending
    if ending == ".mp4":
        with av.open(str(path)) as film:
            times = [frame.time for frame in film.decode(video=0)]
        assert times == pytest.approx([k / 25 for k in range(20)])
    else:
        with Image.open(path) as film:
            assert (film.size, film.n_frames * film.info["duration"]) == ((160, 130), 800)  # type: ignore[attr-defined]
