"""The neck in MuJoCo with its stepper drive: pulses in, measured arms and head out.

The neck has neither clock nor thread; its owner controls the time.
"""

from __future__ import annotations

import copy
import logging
import math
from collections.abc import Sequence
from typing import Final

import mujoco
import numpy as np
import numpy.typing as npt

from beatrix_zenoh.body.figure import chains
from beatrix_zenoh.contract._generated.robot import ROBOT, DriveData, RobotData
from beatrix_zenoh.contract.errors import BeatrixError
from beatrix_zenoh.contract.names import ARMS
from beatrix_zenoh.motion.gear import Arms, Gear
from beatrix_zenoh.motion.kinematics import Neck
from beatrix_zenoh.motion.rotation import Rotation, ypr_of
from sim_node.model import TIMESTEP_MS, mechanics

CYCLE_FULL_STEPS: Final = 4
"""Full steps of a two-phase motor's electrical cycle."""

Counts = tuple[int, int, int]


class StepperDrive:
    """Three stepper motors with their gears."""

    def __init__(self, drive: DriveData = ROBOT.drive) -> None:
        self._gear = Gear(drive)
        # The electrical cycle as an angle of an arm (rad). It is positive, because Gear applies the direction of a motor.
        self._cycle = math.tau / (drive.full_steps * drive.gear_ring / drive.gear_pinion / CYCLE_FULL_STEPS)
        self._signs = drive.sign
        self._pulses: Counts = (0, 0, 0)
        self._home: Counts = (0, 0, 0)
        self._cycles = [0, 0, 0]
        self._lost = [0, 0, 0]
        self.on = False
        """whether the motors are switched on and so hold the arms"""
        self.set_points: Arms = (0.0, 0.0, 0.0)
        """angles that the coils pull the arms to (rad from home)"""

    @property
    def slipped(self) -> Counts:
        """Full steps by which each motor's counter is ahead of its rotor, lost by slipping since `set_home`."""
        x, y, z = (
            -CYCLE_FULL_STEPS * sign * lost for sign, lost in zip(self._signs, self._lost, strict=True)
        )
        return x, y, z

    def step(self, pulses: Counts, arms: Sequence[float], *, on: bool) -> bool:
        """Follow the board for one physics step; return True if the set points or the motor switch changed.

        `pulses` are microsteps since the board's start, `arms` the measured angles (rad).
        """
        changed = on != self.on
        if pulses != self._pulses:
            self._pulses = pulses
            self._update_set_points()
            changed = True
        if on:
            half = self._cycle / 2
            (x, y, z), (a, b, c) = self.set_points, arms
            if not (-half < a - x < half and -half < b - y < half and -half < c - z < half):
                # Motors that have just been switched on lock to the nearest position, which is not a slip.
                self._lock(arms, slip=self.on)
                changed = True
        self.on = on
        return changed

    def set_home(self) -> None:
        """Declare the present step counts to be home, and reset the slip."""
        self._home = self._pulses
        self._cycles = [0, 0, 0]
        self._lost = [0, 0, 0]
        self._update_set_points()

    def _lock(self, arms: Sequence[float], *, slip: bool) -> None:
        for i, (arm, set_point) in enumerate(zip(arms, self.set_points, strict=True)):
            if not math.isfinite(arm):
                continue
            cycles = round((arm - set_point) / self._cycle)
            self._cycles[i] += cycles
            if slip:
                self._lost[i] += cycles
        self._update_set_points()

    def _update_set_points(self) -> None:
        (i, j, k), (h, m, n) = self._pulses, self._home
        x, y, z = self._gear.to_rad((i - h, j - m, k - n))
        (a, b, c), cycle = self._cycles, self._cycle
        self.set_points = x + a * cycle, y + b * cycle, z + c * cycle


_log = logging.getLogger(__name__)

_UPRIGHT: Final[Arms] = (0.0, 0.0, 0.0)
_ALL_MOTORS: Final = 1 << 0
"""Bit of actuator group 0, which contains all motors, because they have no group of their own."""
_REST_SPEED: Final = 1e-10
"""Speed (rad/s) of the fastest joint below which the neck rests; held by its motors it does so 15 s after a motion. It
would move another 1e-10 rad, by a factor of 300 less than a published number resolves (float32: 3e-8 rad)."""
_CHECK_STEPS: Final = 50
_CHECKS: Final = 5
"""The neck sleeps when so many checks in a row, each _CHECK_STEPS physics steps after the last, find it at rest."""


class Plant:
    """The simulated neck; starts upright with motors off. Angles in rad from home, lengths in m.

    After half a second at rest it sleeps: a step then changes only the time of the physics. The first microstep, the
    motor switch, a force on a body and a placement wake it. Whether it sleeps depends on the steps only, not on the
    clock of the computer, so the same steps always give the same numbers.
    """

    def __init__(self, robot: RobotData = ROBOT, model: mujoco.MjModel | None = None) -> None:
        """Create the neck of this robot; `model` is a compiled model of it that no other plant uses."""
        # Without a handler MuJoCo writes warnings to a file in the working directory.
        mujoco.set_mju_user_warning(_log.warning)
        self._robot = robot
        self._neck = Neck(robot.geometry)
        self.drive = StepperDrive(robot.drive)
        """motors and gears, with their set points and slip"""
        self.re_placed = 0
        """Number of times that the neck was reassembled."""
        self.model = mechanics(robot).compile() if model is None else model
        self.data = mujoco.MjData(self.model)
        # Views are created once: creating one takes as long as reading it.
        arms = [self.model.joint(f"arm_{name}") for name in ARMS]
        rods = [self.model.joint(f"rod_{name}") for name in ARMS]
        self._arms = self.data.qpos[_stride([int(joint.qposadr[0]) for joint in arms])]
        self._rods = self.data.qpos[_stride([int(joint.qposadr[0]) for joint in rods])]
        self._velocities = self.data.qvel[_stride([int(joint.dofadr[0]) for joint in arms])]
        head = int(self.model.joint("head").qposadr[0])
        self._quaternion = self.data.qpos[head : head + 4]
        self._forces, self._speeds = self.data.xfrc_applied, self.data.qvel
        self._pulled_to, self._options = self.data.ctrl, self.model.opt
        self._until_check, self._checks = _CHECK_STEPS, 0
        self.straighten()

    def step(self, pulses: Counts, *, drivers_on: bool, count: int = 1) -> None:
        """Make `count` physics steps of TIMESTEP_MS towards `pulses`: microsteps of each motor since the board's start."""
        for left in range(count, 0, -1):
            if self.drive.step(pulses, self._arms.tolist(), on=drivers_on):
                self._apply_drive()
            elif self.asleep:
                if not np.count_nonzero(self._forces):  # quicker than `any`
                    self.data.time += left * TIMESTEP_MS / 1000
                    return
                self._checks = 0
            mujoco.mj_step(self.model, self.data)
            self._until_check -= 1
            if self._until_check == 0:
                self._until_check = _CHECK_STEPS
                rests = not self._forces.any() and np.abs(self._speeds).max() < _REST_SPEED
                self._checks = self._checks + 1 if rests else 0

    @property
    def asleep(self) -> bool:
        """Whether the neck rests, and steps change nothing until something wakes it."""
        return self._checks >= _CHECKS

    def arms(self) -> Arms:
        """Return the arm angles (rad), measured at the joints."""
        x, y, z = self._arms.tolist()
        return x, y, z

    def velocities(self) -> Arms:
        """Return the arm velocities (rad/s), measured at the joints."""
        x, y, z = self._velocities.tolist()
        return x, y, z

    def rotation(self) -> Rotation:
        """Return the rows of the head's orientation, measured at the head."""
        w, x, y, z = self._quaternion.tolist()
        return (
            (1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
            (2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)),
            (2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)),
        )

    def head(self) -> Arms:
        """Return yaw, pitch, roll (rad), measured at the head; yaw includes the full turns that the arms have made."""
        yaw, pitch, roll = ypr_of(self.rotation())
        mean = sum(self.arms()) / 3
        return yaw + math.tau * round((mean - yaw) / math.tau), pitch, roll

    def tilt(self) -> float:
        """Return the angle (rad) between the head's axis and the vertical."""
        _, x, y, _ = self._quaternion.tolist()
        return 2 * math.asin(min(1.0, math.hypot(x, y)))

    def gap(self) -> float:
        """Return the smallest angle (rad) between neighbouring arms."""
        return min(self._neck.gaps(self._arms.tolist()))

    def posture(self) -> npt.NDArray[np.float64]:
        """Return a copy of all joint positions, for a painter; shape (10,)."""
        posture: npt.NDArray[np.float64] = self.data.qpos.copy()
        return posture

    def home_assembly_left(self) -> bool:
        """Return whether the loop has snapped into another assembly, or the state contains NaN."""
        return not self._neck.in_home_assembly(self.arms(), self.rotation())

    def straighten(self) -> None:
        """Set the head upright and reset the slip, as a person does before calibrating."""
        self.drive.set_home()
        self.place(_UPRIGHT)

    def place(self, arms: Arms) -> None:
        """Set all bodies at rest at these arm angles (rad).

        Raises BeatrixError if the head cannot be assembled with them.
        """
        time = self.data.time
        mujoco.mj_resetData(self.model, self.data)
        self.data.time = time
        rotation = self._neck.rotation(arms)
        self._arms[:] = arms
        self._rods[:] = [
            chain.rod_angle(arm, rotation)
            for chain, arm in zip(chains(self._robot.geometry), arms, strict=True)
        ]
        mujoco.mju_mat2Quat(self._quaternion, np.ravel(rotation))
        self._apply_drive()
        mujoco.mj_kinematics(self.model, self.data)

    def reassemble(self) -> None:
        """Reassemble the neck at its set points, or upright if the head cannot be assembled with those."""
        self.re_placed += 1
        try:
            self.place(self.drive.set_points)
        except BeatrixError:
            self.place(_UPRIGHT)

    def copy(self) -> Plant:
        """Return an independent plant in the same state."""
        # The model is copied, too, because switching the motors changes it.
        plant = Plant(self._robot, copy.copy(self.model))
        plant.drive, plant.re_placed = copy.deepcopy(self.drive), self.re_placed
        plant._until_check, plant._checks = self._until_check, self._checks
        mujoco.mj_copyData(plant.data, plant.model, self.data)
        # A new plant has its motors off, and a step changes the switch only when the board does.
        plant._options.disableactuator = self._options.disableactuator
        return plant

    def _apply_drive(self) -> None:
        """Pass set points and motor switch to MuJoCo; wakes the neck."""
        self._checks = 0
        angles = self._pulled_to
        angles[0], angles[1], angles[2] = self.drive.set_points
        self._options.disableactuator = 0 if self.drive.on else _ALL_MOTORS


def _stride(addresses: Sequence[int]) -> slice:
    """Return a slice of three equally spaced indices, because a slice gives a view and a list of indices a copy."""
    first, second, third = addresses
    return slice(first, third + 1, second - first)
