"""Off-screen drawing with OpenGL, if this computer has it."""

from __future__ import annotations

import importlib
import os
import subprocess
import sys
from functools import cache
from typing import Final

import mujoco
import numpy as np

from sim_node.painter import Image, PosedModel
from sim_node.piped_process import environment

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
    """Return the name of an OpenGL backend that works here, or None.

    MUJOCO_GL names the first to try; with `off` the result is None.

    Each is tried once, in a subprocess, because a broken driver hangs or crashes, and a library cannot be unloaded.
    """
    preferred = os.environ.get("MUJOCO_GL", "").lower().strip()
    if preferred in _OFF:
        return None
    known = _BACKENDS.get(sys.platform, ())
    names = sorted(known, key=lambda name: name != preferred)
    return next((name for name in names if _works(name)), None)


def _works(name: str) -> bool:
    command = [sys.executable, "-P", "-c", _PROBE, name]
    try:
        probe = subprocess.run(
            command,
            env=environment(),
            stdin=subprocess.DEVNULL,
            capture_output=True,
            timeout=_PROBE_S,
            check=False,
        )
    except (OSError, subprocess.TimeoutExpired):
        return False
    return probe.returncode == 0


class GlPainter(PosedModel):
    """Draws a model from its cameras; created, used and closed in one thread."""

    def __init__(
        self, spec: mujoco.MjSpec, width: int, height: int, *, name: str, shadows: bool, samples: int
    ) -> None:
        """Prepare images of `width` x `height` pixels with backend `name`; shadows and samples per pixel take time."""
        # Mesa's software driver would use all cores, and physics needs one.
        os.environ.setdefault("LP_NUM_THREADS", "0")
        model = spec.compile()
        super().__init__(model)
        self._context = importlib.import_module(f"mujoco.{name}").GLContext(width, height)
        self._context.make_current()
        model.vis.global_.offwidth, model.vis.global_.offheight = width, height
        model.vis.quality.offsamples = samples
        self._render = mujoco.MjrContext(model, mujoco.mjtFontScale.mjFONTSCALE_100)
        mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN, self._render)
        self._scene = mujoco.MjvScene(model, maxgeom=model.ngeom + 100)
        self._scene.flags[mujoco.mjtRndFlag.mjRND_SHADOW] = shadows
        # Draw the sky only if the model has one: behind walls it would take a third of the time of a frame.
        self._scene.flags[mujoco.mjtRndFlag.mjRND_SKYBOX] = any(
            texture.type == mujoco.mjtTexture.mjTEXTURE_SKYBOX for texture in spec.textures
        )
        self._option = mujoco.MjvOption()
        self._camera = mujoco.MjvCamera()
        self._camera.type = mujoco.mjtCamera.mjCAMERA_FIXED
        self._size = mujoco.MjrRect(0, 0, width, height)

    def paint(self, camera: str) -> Image:
        """Draw the picture from the camera of this name."""
        self._context.make_current()
        self._camera.fixedcamid = self.model.camera(camera).id
        self.model.geom_group[:] = self.groups_seen_from(camera)
        everything = mujoco.mjtCatBit.mjCAT_ALL
        mujoco.mjv_updateScene(
            self.model, self.data, self._option, None, self._camera, everything, self._scene
        )
        mujoco.mjr_render(self._size, self._scene, self._render)
        image = np.empty((self._size.height, self._size.width, 3), dtype=np.uint8)
        mujoco.mjr_readPixels(image, None, self._size, self._render)
        return image[::-1]

    def close(self) -> None:
        """Free the context."""
        self._context.make_current()
        self._render.free()
        self._context.free()
