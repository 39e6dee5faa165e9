"""The neck as a MuJoCo model, built from the robot's data, and the scene for pictures: robot, room and person.

Every body's frame has its origin in the neck centre and is unrotated at home, so that joint axes are plain vectors
and home is qpos0. Frames: x forward, y left, z up. Three chains base -> arm -> rod are closed on the head, which
turns on a ball joint, by one `connect` each: 9 degrees of freedom, 6 of them taken by the loops.

The model of the physics contains the robot only. The room is the file `room/room.xml`; its origin is on the desk, below
the neck. Other places are in m in the frame of the neck centre.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from pathlib import Path
from typing import Final

import mujoco
import numpy as np

from beatrix_zenoh.body.figure import Chain, chains, direction, scaled
from beatrix_zenoh.contract import names
from beatrix_zenoh.contract._generated.robot import ROBOT, SIZES, DriveData, RobotData
from beatrix_zenoh.contract.names import ARMS
from sim_node.visuals import COLLISION, add_camera, add_visuals

TIMESTEP_MS: Final = 2
"""Length of a physics step (ms)."""
FOLD_MARGIN: Final = math.radians(80.0)
"""Angle of a rod's stops from the middle of its range (rad); at 90 deg arm and rod are in one plane, and the loop could
snap."""

LINK_RADIUS: Final = 0.006

_SOLREF: Final = (0.002, 1.0)
_SOLIMP: Final = (0.99, 0.9999, 0.001, 0.5, 2.0)


def rod_range(chain: Chain) -> tuple[float, float]:
    """Return the rod angles (rad) at the mechanical stops; 0 is home.

    The home assembly ends where (elbow x mount)_z changes sign. As a function of the rod angle r this component is
    A cos r + B sin r, which is largest at atan2(B, A), the middle of the range.
    """
    normal = np.cross(chain.elbow, chain.mount)
    sign = math.copysign(1.0, float(normal[2]))
    middle = math.atan2(sign * float(np.cross(chain.elbow, normal)[2]), sign * float(normal[2]))
    return middle - FOLD_MARGIN, middle + FOLD_MARGIN


def ratio(drive: DriveData) -> float:
    """Return the motor turns per arm turn."""
    return drive.gear_ring / drive.gear_pinion


def mechanics(robot: RobotData = ROBOT) -> mujoco.MjSpec:
    """Return the editable model (nq 10, nv 9, nu 3) without the shapes that only pictures show.

    Each of them would be moved in each step.
    """
    spec = mujoco.MjSpec()
    spec.modelname = "beatrix"
    spec.compiler.degree = False
    _set_options(spec)
    head = _add_head(spec, robot)
    for name, chain in zip(ARMS, chains(robot.geometry), strict=True):
        _add_chain(spec, robot, name, chain)
        head.add_site(name=f"mount_{name}", pos=scaled(chain.mount, robot.head.mount_radius), group=COLLISION)
        loop = spec.add_equality(name=f"loop_{name}", type=mujoco.mjtEq.mjEQ_CONNECT)
        loop.objtype = mujoco.mjtObj.mjOBJ_SITE
        loop.name1, loop.name2 = f"rod_{name}", f"mount_{name}"
        loop.solref, loop.solimp = _SOLREF, _SOLIMP
        _add_motor(spec, robot.drive, name)
    return spec


def build_spec(robot: RobotData = ROBOT) -> mujoco.MjSpec:
    """Return the editable model with all shapes; its `to_xml()` returns MJCF."""
    spec = mechanics(robot)
    add_visuals(spec, robot)
    return spec


def _set_options(spec: mujoco.MjSpec) -> None:
    option = spec.option
    option.timestep = TIMESTEP_MS / 1000
    # This integrator solves loops and drives together; with drives this stiff other integrators oscillate or lag.
    option.integrator = mujoco.mjtIntegrator.mjINT_DISCRETE
    option.solver = mujoco.mjtSolver.mjSOL_NEWTON
    option.jacobian = mujoco.mjtJacobian.mjJAC_DENSE
    option.tolerance = 1e-10
    # No automatic reset, which would move the neck to home, but not the drive.
    option.disableflags = mujoco.mjtDisableBit.mjDSBL_AUTORESET


def _add_head(spec: mujoco.MjSpec, robot: RobotData) -> mujoco.MjsBody:
    size = robot.head
    head = spec.worldbody.add_body(name="head")
    head.add_joint(name="head", type=mujoco.mjtJoint.mjJNT_BALL)
    skull = _add_solid(head, "skull", mujoco.mjtGeom.mjGEOM_ELLIPSOID, [0.075, 0.07, 0.08], size.mass)
    skull.pos = [0.0, 0.0, size.centre_height]
    for side, name in ((1, "eye_left"), (-1, "eye_right")):
        # The cameras are in front of the lenses, so that no eye sees its own housing.
        head.add_camera(
            name=name,
            pos=[SIZES.eye_forward, side * size.eye_baseline / 2, size.centre_height + SIZES.eye_up],
            xyaxes=[0.0, -1.0, 0.0, 0.0, 0.0, 1.0],
            fovy=size.eye_fov,
        )
    return head


def _add_chain(spec: mujoco.MjSpec, robot: RobotData, name: str, chain: Chain) -> None:
    size = robot.head
    arm = spec.worldbody.add_body(name=f"arm_{name}")
    hinge = arm.add_joint(name=f"arm_{name}", type=mujoco.mjtJoint.mjJNT_HINGE, axis=[0.0, 0.0, 1.0])
    hinge.armature = robot.drive.rotor_inertia * ratio(robot.drive) ** 2
    hinge.frictionloss = size.arm_friction
    hinge.solref_friction, hinge.solimp_friction = _SOLREF, _SOLIMP
    ring = SIZES.ring_heights[ARMS.index(name)]
    disc = [SIZES.ring_radius, SIZES.ring_thickness / 2, 0.0]
    _add_solid(arm, "ring", mujoco.mjtGeom.mjGEOM_CYLINDER, disc, size.arm_mass / 2).pos = [0.0, 0.0, ring]
    elbow = np.array(chain.elbow) * size.arm_length
    base = direction(chain.azimuth, SIZES.post_radius, ring)
    _add_link(arm, base, elbow * 1.2, size.arm_mass / 2)

    rod = arm.add_body(name=f"rod_{name}")
    joint = rod.add_joint(name=f"rod_{name}", type=mujoco.mjtJoint.mjJNT_HINGE, axis=chain.elbow)
    joint.limited, joint.range = mujoco.mjtLimited.mjLIMITED_TRUE, rod_range(chain)
    joint.solref_limit, joint.solimp_limit = _SOLREF, _SOLIMP
    mount = np.array(chain.mount) * size.mount_radius
    middle = (elbow + mount) / np.linalg.norm(elbow + mount) * size.arm_length
    _add_link(rod, elbow, middle, size.rod_mass / 2)
    _add_link(rod, middle, mount, size.rod_mass / 2)
    rod.add_site(name=f"rod_{name}", pos=mount, group=COLLISION)


def _add_motor(spec: mujoco.MjSpec, drive: DriveData, name: str) -> None:
    """Add a position servo as stiff as a microstepping motor near its set point.

    With p pole pairs, the torque T sin(p e) at the rotor for an error e is about T p per rad; the arm has this times
    the ratio squared.
    """
    geared = drive.holding_torque * ratio(drive) * drive.efficiency
    motor = spec.add_actuator(name=f"motor_{name}", target=f"arm_{name}")
    motor.trntype = mujoco.mjtTrn.mjTRN_JOINT
    motor.set_to_position(kp=geared * ratio(drive) * drive.full_steps / 4, dampratio=1.0)
    motor.forcelimited, motor.forcerange = mujoco.mjtLimited.mjLIMITED_TRUE, (-geared, geared)


def _add_link(body: mujoco.MjsBody, start: Iterable[float], end: Iterable[float], mass: float) -> None:
    link = _add_solid(body, "link", mujoco.mjtGeom.mjGEOM_CAPSULE, [LINK_RADIUS, 0.0, 0.0], mass)
    link.fromto = [*start, *end]


def _add_solid(
    body: mujoco.MjsBody, kind: str, shape: mujoco.mjtGeom, size: list[float], mass: float
) -> mujoco.MjsGeom:
    """Add a hidden geom that has mass; all geoms but rings can touch each other."""
    solid = body.add_geom(type=shape, size=size, mass=mass, group=COLLISION)
    touches = kind != "ring"
    solid.contype = solid.conaffinity = int(touches)
    return solid


ROOM: Final = Path(__file__).with_name("room") / "room.xml"
PREFIX: Final = "room/"
"""Before the names of bodies and geoms of the room; the body `room/person` is the person."""
OUTSIDE: Final = ((0.655, 0.235, 0.13), (0.0, 0.0, 0.058), 32.0)
"""The outside camera: its place and the point that it looks at (m), and its vertical angle of view (deg)."""


def scene_spec(robot: RobotData = ROBOT) -> mujoco.MjSpec:
    """Return the editable model of robot, room and person; its joints, and so its qpos, are those of `build_spec`."""
    spec = build_spec(robot)
    room = mujoco.MjSpec.from_file(str(ROOM))
    spec.visual.headlight, spec.visual.map = room.visual.headlight, room.visual.map
    spec.visual.quality, spec.stat = room.visual.quality, room.stat
    spec.attach(room, prefix=PREFIX, frame=spec.worldbody.add_frame(pos=[0.0, 0.0, SIZES.floor]))
    add_camera(spec.worldbody, names.OUTSIDE, *OUTSIDE)
    return spec


def eye_scene(robot: RobotData = ROBOT) -> mujoco.MjSpec:
    """Return the model of `scene_spec` for published pictures, simplified to save time."""
    spec = scene_spec(robot)
    quality = spec.visual.quality
    # All light is directional, so one quad for each wall is enough.
    quality.numquads = 1
    quality.numslices, quality.numstacks = 16, 10
    spec.delete(spec.texture(f"{PREFIX}sky"))
    return spec
