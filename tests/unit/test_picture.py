from __future__ import annotations

import io
import math
import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import mujoco
import numpy as np
import PIL.Image
import pytest

from beatrix_zenoh.contract.errors import BeatrixError
from beatrix_zenoh.motion.gear import Arms
from beatrix_zenoh.motion.kinematics import Neck
from sim_node import gl
from sim_node.gl import GlPainter
from sim_node.model import build_spec
from sim_node.painter import Image
from sim_node.picture import picture, png
from sim_node.plant import Plant
from sim_node.rays import RayPainter
from sim_node.visuals import VISUAL

HOME: Arms = (0.0, 0.0, 0.0)
FACING_THE_CAMERA = Neck().inverse(math.radians(-30), 0.0, 0.0)
WIDTH, HEIGHT = 160, 120
ROOT = Path(__file__).resolve().parents[2]


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


def test_both_painters_draw_similar_pictures() -> None:
    name = gl.backend()
    if name is None:
        pytest.skip("no OpenGL on this machine")
    posture = Plant().posture()
    painter = GlPainter(build_spec(), WIDTH, HEIGHT, name=name, shadows=False, samples=0)
    painter.pose(posture)
    drawn = painter.paint("observer").astype(int)
    painter.close()
    rays = RayPainter(build_spec(), WIDTH, HEIGHT)
    rays.pose(posture)
    cast = rays.paint("observer").astype(int)
    assert np.median(np.abs(drawn - cast)) < 30


@pytest.mark.usefixtures("without_gl")
def test_the_head_turns_with_the_arms() -> None:
    ahead, turned = picture(HOME, WIDTH, HEIGHT), picture(FACING_THE_CAMERA, WIDTH, HEIGHT)
    upper, lower = slice(0, HEIGHT // 2), slice(7 * HEIGHT // 8, HEIGHT)
    assert (ahead[upper] != turned[upper]).mean() > 0.05
    assert (ahead[lower] == turned[lower]).all()


@pytest.mark.usefixtures("without_gl")
def test_impossible_arm_angles_are_an_error() -> None:
    with pytest.raises(BeatrixError):
        picture((2.0, 0.0, 0.0), WIDTH, HEIGHT)


@pytest.mark.parametrize("camera", ["observer", "eye_left", "eye_right"])
def test_rays_cast_together_hit_the_same_as_single_rays(camera: str) -> None:
    """MuJoCo culls more geoms if rays are cast together, but must not cull those that a ray hits."""
    painter = RayPainter(build_spec(), 48, 36)
    plant = Plant()
    painter.pose(plant.posture())
    painter.paint(camera)
    mujoco.mj_kinematics(plant.model, plant.data)
    mujoco.mj_camlight(plant.model, plant.data)
    eye = plant.data.camera(camera).xpos.copy()
    rays = painter._rays(camera)
    together = painter._cast(eye, rays)[0]
    group = np.zeros(mujoco.mjNGROUP, dtype=np.uint8)
    group[VISUAL] = 1
    hit_geom = np.zeros(1, dtype=np.int32)
    alone = []
    for ray in rays:
        mujoco.mj_ray(plant.model, plant.data, eye, ray, group, 1, -1, hit_geom)
        alone.append(int(hit_geom[0]))
    assert together.tolist() == alone


def test_a_png_file_contains_the_exact_pixels() -> None:
    image = np.arange(5 * 7 * 3, dtype=np.uint8).reshape(5, 7, 3)
    with PIL.Image.open(io.BytesIO(png(image))) as again:
        assert again.mode == "RGB"
        assert np.asarray(again).tolist() == image.tolist()


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


def test_a_backend_whose_probe_fails_is_not_used() -> None:
    assert probed({"PYOPENGL_PLATFORM": "egl", "MUJOCO_GL": "off"}) == "None"
    assert not gl._works("no_such_backend")
