"""Drawing the scene: its state, and the model without physics."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import mujoco
import numpy as np
import numpy.typing as npt

from beatrix_zenoh.body.surface import Floats
from beatrix_zenoh.motion.rotation import Vector
from sim_node.visuals import COLLISION

_WORLD: Final = 0
Image = npt.NDArray[np.uint8]
"""Rows from the top, shape (height, width, 3): red, green, blue."""


@dataclass(frozen=True)
class SceneState:
    """The scene at one time."""

    t_mono_ns: int
    """monotonic clock of this computer"""
    posture: Floats
    """joint positions, from `Plant.posture`"""
    target: Vector
    """place of the person's eyes"""


class PosedModel:
    """A model in a given posture, without physics; only one thread may use it."""

    def __init__(self, model: mujoco.MjModel) -> None:
        self.model = model
        self.data = mujoco.MjData(model)
        self._groups = model.geom_group.copy()

    def pose(self, posture: Floats, target: Vector | None = None) -> None:
        """Set the robot's joint positions (of `Plant.posture`) and the place of the person's eyes (m) if it is given.

        The person faces the neck's axis.
        """
        data = self.data
        data.qpos[:] = posture
        if target is not None:
            half = math.atan2(-target[1], -target[0]) / 2
            data.mocap_pos[0] = target
            data.mocap_quat[0] = math.cos(half), 0.0, 0.0, math.sin(half)
        mujoco.mj_kinematics(self.model, data)
        mujoco.mj_camlight(self.model, data)

    def groups_seen_from(self, camera: str) -> npt.NDArray[np.integer]:
        """Return the group of each geom for a picture from a camera: the body that carries the camera is hidden."""
        carrier = int(self.model.camera(camera).bodyid[0])
        hidden = (self.model.geom_bodyid == carrier) & (carrier != _WORLD)
        groups: npt.NDArray[np.integer] = np.where(hidden, COLLISION, self._groups)
        return groups
