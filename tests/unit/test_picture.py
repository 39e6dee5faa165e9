from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from robot_pictures import picture

from beatrix_zenoh.motion.gear import Arms
from sim_node import gl
from sim_node.painter import Image

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


ROOT = Path(__file__).resolve().parents[2]


def probed(environment: dict[str, str], before: str = "") -> str:
    """Return the OpenGL backend in a new process that has run the code `before`."""
    command = [sys.executable, "-c", f"{before}from sim_node.gl import backend; print(backend())"]
    done = subprocess.run(
        command,
        cwd=ROOT,
        env={**os.environ, **environment},
        capture_output=True,
        text=True,
        timeout=50,
        check=True,
    )
    return done.stdout.strip()


def test_without_opengl_libraries_physics_works_and_there_is_no_backend(tmp_path: Path) -> None:
    """With MUJOCO_GL=egl and without the library of EGL, even `import mujoco` fails."""
    (tmp_path / "OpenGL").mkdir()
    (tmp_path / "OpenGL" / "__init__.py").write_text("raise AttributeError('no library of this name')")
    absent = {"PYTHONPATH": str(tmp_path), "MUJOCO_GL": "egl"}
    bare = [sys.executable, "-c", "import mujoco"]
    assert subprocess.run(bare, env={**os.environ, **absent}, capture_output=True, check=False).returncode
    assert (
        probed(absent, "from sim_node.plant import Plant; Plant().step((0, 0, 0), drivers_on=True); ")
        == "None"
    )
