from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest

from beatrix_zenoh.motion.gear import Arms
from sim_node import gl
from sim_node.painter import Image
from sim_node.picture import picture

HOME: Arms = (0.0, 0.0, 0.0)
WIDTH, HEIGHT = 160, 120


@pytest.fixture
def without_gl(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    gl.backend.cache_clear()
    monkeypatch.setenv("MUJOCO_GL", "off")
    yield
    gl.backend.cache_clear()


def share(image: Image, dominant: int) -> float:
    """Return the share of the pixels in which one colour is stronger than the two others."""
    strongest = image[..., dominant].astype(int)
    rest = np.delete(image, dominant, axis=2).max(axis=2)
    return float((strongest > rest * 1.25).mean())


def shows_the_robot(image: Image) -> bool:
    """Return whether the red, green and blue rings and the dark base are in their places."""
    red, green, blue = (share(image, colour) for colour in range(3))
    base = image[-HEIGHT // 6 :, WIDTH // 3 : 2 * WIDTH // 3].mean()
    corner = image[: HEIGHT // 6, : WIDTH // 6].mean()
    return min(red, green, blue) > 0.0005 and base < corner


@pytest.mark.usefixtures("without_gl")
def test_ray_casting_draws_the_robot_without_opengl() -> None:
    image = picture(HOME, WIDTH, HEIGHT)
    assert image.shape == (HEIGHT, WIDTH, 3)
    assert shows_the_robot(image)


def test_opengl_draws_the_robot() -> None:
    if gl.backend() is None:
        pytest.skip("no OpenGL on this machine")
    assert shows_the_robot(picture(HOME, WIDTH, HEIGHT))
