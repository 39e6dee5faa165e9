"""The scene in the pictures of the eyes."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path

import mujoco
import numpy as np
import numpy.typing as npt
import pytest

from beatrix_zenoh.body.surface import Floats
from beatrix_zenoh.contract._generated.robot import ROBOT, SIZES
from beatrix_zenoh.motion.kinematics import Neck
from beatrix_zenoh.motion.rotation import Vector
from sim_node import gl
from sim_node.gl import GlPainter
from sim_node.model import eye_scene, scene_spec
from sim_node.painter import Image, PosedModel
from sim_node.plant import Plant
from sim_node.renderer import HEIGHT, open_painter
from sim_node.target import HOME
from sim_node.visuals import VISUAL

FOCUS = HEIGHT / 2 / math.tan(math.radians(ROBOT.head.eye_fov) / 2)
"""Focal length of the eyes (px)."""
ROOT = Path(__file__).resolve().parents[2]
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
def painter() -> Iterator[GlPainter]:
    name = gl.backend()
    if name is None:
        pytest.skip("no OpenGL on this machine")
    painter = open_painter(ROBOT, name)
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
