from __future__ import annotations

from collections.abc import Iterator

import mujoco
import numpy as np
import pytest

from beatrix_zenoh.motion.gear import Arms
from sim_node import gl
from sim_node.gl import GlPainter
from sim_node.model import build_spec
from sim_node.painter import Image
from sim_node.picture import picture
from sim_node.plant import Plant
from sim_node.rays import RayPainter
from sim_node.visuals import VISUAL

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
