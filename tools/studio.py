"""The robot alone, on a tiled floor in the light of a studio: the model of the pictures in the pages."""

from __future__ import annotations

from typing import Final

import mujoco

from beatrix_zenoh.contract._generated.robot import ROBOT, SIZES, RobotData
from sim_node.model import build_spec
from sim_node.visuals import SKY, VISUAL, add_camera

TILES: Final = ((0.88, 0.885, 0.875), (0.845, 0.855, 0.85))
TILE: Final = 0.1
"""Side of the floor's tiles (m)."""
CAMERA: Final = "observer"


def studio(robot: RobotData = ROBOT) -> mujoco.MjSpec:
    """Return the editable model of the robot on a tiled floor in the light of a studio."""
    spec = build_spec(robot)
    world = spec.worldbody
    spec.add_texture(
        name="sky",
        type=mujoco.mjtTexture.mjTEXTURE_SKYBOX,
        builtin=mujoco.mjtBuiltin.mjBUILTIN_GRADIENT,
        rgb1=[0.80, 0.86, 0.92],
        rgb2=SKY,
        width=256,
        height=256 * 6,
    )
    spec.add_texture(
        name="tiles",
        type=mujoco.mjtTexture.mjTEXTURE_2D,
        builtin=mujoco.mjtBuiltin.mjBUILTIN_CHECKER,
        rgb1=TILES[0],
        rgb2=TILES[1],
        width=256,
        height=256,
    )
    floor = spec.add_material(name="floor", texrepeat=[0.5 / TILE, 0.5 / TILE], texuniform=True, specular=0.1)
    floor.textures[mujoco.mjtTextureRole.mjTEXROLE_RGB] = "tiles"
    plane = world.add_geom(
        name="floor",
        type=mujoco.mjtGeom.mjGEOM_PLANE,
        size=[0, 0, 0.1],
        pos=[0, 0, SIZES.floor],
        material="floor",
        group=VISUAL,
    )
    plane.contype = plane.conaffinity = 0
    sun = mujoco.mjtLightType.mjLIGHT_DIRECTIONAL
    world.add_light(type=sun, pos=[0.6, -0.5, 1.2], dir=[-0.5, 0.55, -1.1], diffuse=[0.60, 0.59, 0.56])
    fill = world.add_light(type=sun, pos=[1.0, -1.2, 0.6], dir=[-0.8, 1.0, -0.5], diffuse=[0.20, 0.21, 0.23])
    fill.castshadow = False
    add_camera(world, CAMERA, (0.80, -0.56, 0.20), (0.0, 0.0, 0.012), 28.0)
    visual = spec.visual
    visual.headlight.ambient = [0.30, 0.30, 0.32]
    visual.headlight.diffuse = [0.20, 0.20, 0.20]
    visual.headlight.specular = [0.1, 0.1, 0.1]
    visual.quality.shadowsize = 4096
    visual.map.znear = 0.02
    visual.map.shadowclip = 0.8
    visual.map.zfar = 12.0
    visual.rgba.haze = [*SKY, 1.0]
    spec.stat.center, spec.stat.extent = [0.0, 0.0, 0.0], 1.0
    return spec
