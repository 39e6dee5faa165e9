"""The simulated eyes: their scene, the process that draws it, its rate, and a computer without OpenGL."""

from __future__ import annotations

import math
import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import mujoco
import numpy as np
import numpy.typing as npt
import pytest
import simplejpeg
from robots import ROOT

from beatrix_zenoh.body.surface import Floats
from beatrix_zenoh.contract._generated.robot import ROBOT, SIZES
from beatrix_zenoh.motion.kinematics import Neck
from beatrix_zenoh.motion.rotation import Vector
from sim_node import gl
from sim_node import renderer as rendering
from sim_node.eyes import SHARE, SLOWEST_S, FrameRate
from sim_node.gl import GlPainter
from sim_node.model import eye_scene, scene_spec
from sim_node.painter import Image, PosedModel, SceneState
from sim_node.plant import Plant
from sim_node.renderer import HEIGHT, WIDTH, Renderer, open_painter
from sim_node.target import HOME
from sim_node.visuals import VISUAL

FOCUS = HEIGHT / 2 / math.tan(math.radians(ROBOT.head.eye_fov) / 2)
"""Focal length of the eyes (px)."""
OBJECTS = ("cube", "cylinder", "ball", "pyramid", "books", "plant")
NEAR: Vector = (0.7, 0.0, 0.16)


SCENE = scene_spec().compile()
PLACES = mujoco.MjData(SCENE)
mujoco.mj_kinematics(SCENE, PLACES)


def place_of(name: str) -> Floats:
    """Return the place (m) of an object of the room, in the frame of the neck."""
    place: Floats = PLACES.body(f"room/{name}").xpos
    return place


def posture(yaw: float = 0.0, pitch: float = 0.0) -> npt.NDArray[np.float64]:
    plant = Plant()
    plant.place(Neck().inverse(math.radians(yaw), math.radians(pitch), 0.0))
    return plant.posture()


def magenta(image: Image) -> npt.NDArray[np.bool_]:
    """Return a mask of the pixels of the person's cap and collar."""
    red, green, blue = (image[..., colour].astype(int) for colour in range(3))
    return (red > 100) & (green < 60) & (blue > 60)


def cap(image: Image) -> float:
    """Return the column (px) of the middle of the magenta pixels."""
    return float(np.nonzero(magenta(image))[1].mean())


@pytest.fixture(scope="module")
def backend() -> str:
    name = gl.backend()
    if name is None:
        pytest.skip("no OpenGL on this machine")
    return name


@pytest.fixture(scope="module")
def painter(backend: str) -> Iterator[GlPainter]:
    painter = open_painter(ROBOT, backend)
    yield painter
    painter.close()


@pytest.mark.parametrize("place", [NEAR, HOME, (2.0, 0.3, 0.2)])
def test_both_eyes_see_the_person_with_the_parallax_of_its_distance(
    painter: GlPainter, place: Vector
) -> None:
    painter.pose(posture(), place)
    left, right = (cap(painter.paint(f"eye_{eye}")) for eye in ("left", "right"))
    # The middle of the magenta parts is about 5 cm behind the person's eyes.
    expected = FOCUS * ROBOT.head.eye_baseline / (place[0] + 0.05 - SIZES.eye_forward)
    assert left - right == pytest.approx(expected, rel=0.08)


def test_the_page_lists_the_objects_and_their_places() -> None:
    page = (ROOT / "docs/how-to/simulated-eyes.md").read_text(encoding="utf-8")
    for name in OBJECTS:
        x, y, z = place_of(name)
        first = SCENE.geom(int(SCENE.body(f"room/{name}").geomadr[0]))
        colour = SCENE.material(int(first.matid[0])).name.removeprefix("room/").replace("_", " ")
        assert f"| {name} | {colour} | {x:.3f} | {y:.3f} | {z:.3f} |" in page


def test_only_the_outside_camera_sees_the_head() -> None:
    posed = PosedModel(eye_scene().compile())
    of_head = posed.model.geom_bodyid == posed.model.body("head").id
    visible = posed.model.geom_group == VISUAL
    assert (of_head & visible).sum() > 10
    for eye in ("eye_left", "eye_right"):
        seen = posed.groups_seen_from(eye) == VISUAL
        assert not (seen & of_head).any()
        assert (seen | of_head)[visible].all(), "all other objects are visible"
    assert ((posed.groups_seen_from("outside") == VISUAL) == visible).all()


# -- the process that draws --------------------------------------------------------------------------

NOW = SceneState(0, Plant().posture(), HOME)


def test_only_the_requested_views_are_drawn(backend: str) -> None:
    renderer = Renderer(ROBOT, backend)
    renderer.open()
    both = dict(renderer.draw(NOW, ["left", "right"]))
    assert list(both) == ["left", "right"]
    assert both["left"] != both["right"]
    assert [eye for eye, _ in renderer.draw(NOW, ["right"])] == ["right"]
    assert simplejpeg.decode_jpeg(both["left"]).shape == (HEIGHT, WIDTH, 3)
    again = dict(renderer.draw(NOW, ["left"]))
    assert again["left"] == both["left"]
    renderer.close()
    renderer.close()
    with pytest.raises(OSError, match="closed"):
        list(renderer.draw(NOW, ["left"]))


def test_a_late_picture_raises_timeout_error(backend: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(rendering, "PICTURE_S", 0.0)
    renderer = Renderer(ROBOT, backend)
    renderer.open()
    assert dict(renderer.draw(NOW, ["left"])), "the first picture may take longer"
    with pytest.raises(TimeoutError, match="hangs"):
        dict(renderer.draw(NOW, ["left"]))
    renderer.close()


def test_without_opengl_libraries_physics_works_and_there_is_no_backend(tmp_path: Path) -> None:
    """With MUJOCO_GL=egl and without the library of EGL, even `import mujoco` fails."""
    (tmp_path / "OpenGL").mkdir()
    (tmp_path / "OpenGL" / "__init__.py").write_text("raise AttributeError('no library of this name')")
    absent = {**os.environ, "PYTHONPATH": str(tmp_path), "MUJOCO_GL": "egl"}
    assert subprocess.run(
        [sys.executable, "-c", "import mujoco"], env=absent, capture_output=True, check=False
    ).returncode
    code = "from sim_node.plant import Plant; Plant().step((0, 0, 0), drivers_on=True)\n"
    code += "from sim_node.gl import backend; print(backend())"
    assert subprocess.check_output([sys.executable, "-c", code], env=absent, cwd=ROOT, text=True) == "None\n"


# -- the frame rate ----------------------------------------------------------------------------------

REQUESTED_HZ = 15.0


class Drawer:
    """Draws when a picture is due, on its own clock; each picture takes `cost_s`."""

    def __init__(self, rate: FrameRate, cost_s: float) -> None:
        self.rate, self.cost_s, self.now_s = rate, cost_s, 100.0

    def draw(self, count: int, *, late: bool = False) -> float:
        """Draw `count` pictures; return their rate (Hz)."""
        begin_s = self.now_s
        for _ in range(count):
            self.now_s += self.rate.wait_s(self.now_s)
            drawn_s = self.now_s
            self.now_s += self.cost_s
            self.rate.drawn(drawn_s, self.cost_s, late=late)
        self.now_s += self.rate.wait_s(self.now_s)
        return count / (self.now_s - begin_s)


def test_a_slow_computer_draws_for_its_share_of_the_time() -> None:
    hz = Drawer(FrameRate(REQUESTED_HZ), 0.2).draw(100)
    assert abs(hz * 0.2 - SHARE) < 0.01


def test_late_physics_slows_drawing_to_the_lowest_rate() -> None:
    drawer = Drawer(FrameRate(REQUESTED_HZ), 0.02)
    drawer.draw(10)
    assert drawer.draw(3, late=True) < 0.8 * REQUESTED_HZ
    drawer.draw(50, late=True)
    assert drawer.rate.period_s == SLOWEST_S


def test_the_rate_recovers_when_physics_is_no_longer_late() -> None:
    drawer = Drawer(FrameRate(REQUESTED_HZ), 0.02)
    drawer.draw(50, late=True)
    drawer.draw(200)
    assert abs(drawer.draw(100) - REQUESTED_HZ) < 0.01
