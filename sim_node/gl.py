"""Drawing with OpenGL, off screen, where the machine has it."""

from __future__ import annotations

import importlib
import os
import subprocess
import sys
from functools import cache
from typing import Final

import mujoco
import numpy as np
import numpy.typing as npt

from beatrix_zenoh._generated.robot import RobotData
from sim_node.model import Vector, build

Image = npt.NDArray[np.uint8]
"""Rows from the top, shape (height, width, 3): red, green, blue."""

_BACKENDS: Final = {"linux": ("egl", "osmesa"), "darwin": ("cgl",), "win32": ("glfw",)}
_OFF: Final = {"off", "disable", "disabled", "false", "0"}
_PROBE_S: Final = 20.0
_PROBE: Final = """
import importlib, os, sys
import sim_node, mujoco
context = importlib.import_module("mujoco." + sys.argv[1]).GLContext(32, 32)
context.make_current()
mujoco.MjrContext(mujoco.MjModel.from_xml_string("<mujoco/>"), mujoco.mjtFontScale.mjFONTSCALE_100)
os._exit(0)
"""


@cache
def backend() -> str | None:
    """Name of the OpenGL backend that works here, None if none does; MUJOCO_GL is tried first, or says `off`.

    Tried in a process of its own, once: a broken driver hangs or crashes, and a library once loaded stays.
    """
    wish = os.environ.get("MUJOCO_GL", "").lower().strip()
    if wish in _OFF:
        return None
    known = _BACKENDS.get(sys.platform, ())
    names = sorted(known, key=lambda name: name != wish)
    return next((name for name in names if _works(name)), None)


def _works(name: str) -> bool:
    command = [sys.executable, "-c", _PROBE, name]
    # A child finds what this process finds, however its path was made.
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    environment.pop("PYOPENGL_PLATFORM", None)
    try:
        probe = subprocess.run(
            command,
            env=environment,
            stdin=subprocess.DEVNULL,
            capture_output=True,
            timeout=_PROBE_S,
            check=False,
        )
    except (OSError, subprocess.TimeoutExpired):
        return False
    return probe.returncode == 0


class GlPainter:
    """Draws the robot from one of its model's cameras; to be made, used and closed in one thread."""

    def __init__(
        self, robot: RobotData, width: int, height: int, *, name: str, shadows: bool, samples: int
    ) -> None:
        """Images of `width` x `height` pixels with backend `name`; shadows and samples a pixel cost time."""
        self._model = model = build(robot)
        self._data = mujoco.MjData(model)
        self._context = importlib.import_module(f"mujoco.{name}").GLContext(width, height)
        self._context.make_current()
        model.vis.global_.offwidth, model.vis.global_.offheight = width, height
        model.vis.quality.offsamples = samples
        self._render = mujoco.MjrContext(model, mujoco.mjtFontScale.mjFONTSCALE_100)
        mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN, self._render)
        self._scene = mujoco.MjvScene(model, maxgeom=model.ngeom + 100)
        self._scene.flags[mujoco.mjtRndFlag.mjRND_SHADOW] = shadows
        self._option = mujoco.MjvOption()
        self._camera = mujoco.MjvCamera()
        self._camera.type = mujoco.mjtCamera.mjCAMERA_FIXED
        self._size = mujoco.MjrRect(0, 0, width, height)

    def paint(self, posture: Vector, camera: str) -> Image:
        """What a named camera sees of the robot in this posture, as `Plant.posture`."""
        self._data.qpos[:] = posture
        mujoco.mj_kinematics(self._model, self._data)
        mujoco.mj_camlight(self._model, self._data)
        self._context.make_current()
        self._camera.fixedcamid = self._model.camera(camera).id
        everything = mujoco.mjtCatBit.mjCAT_ALL
        mujoco.mjv_updateScene(
            self._model, self._data, self._option, None, self._camera, everything, self._scene
        )
        mujoco.mjr_render(self._size, self._scene, self._render)
        image = np.empty((self._size.height, self._size.width, 3), dtype=np.uint8)
        mujoco.mjr_readPixels(image, None, self._size, self._render)
        return image[::-1]

    def close(self) -> None:
        """Give the context back."""
        self._context.make_current()
        self._render.free()
        self._context.free()
