"""Stepper motors: from pulses to set points of the arms, with slip.

A stepper has no position sensor. Its coils hold the rotor at the nearest of the positions that repeat every
electrical cycle, four full steps. If the rotor is pushed further than half a cycle, it slips to the next such position:
four full steps are lost, and the firmware's counter no longer matches the arm.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final

from beatrix_zenoh.contract._generated.robot import ROBOT, DriveData
from beatrix_zenoh.motion.gear import Arms, Gear

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
        self._on = False
        self._set_points: Arms = (0.0, 0.0, 0.0)

    @property
    def cycle(self) -> float:
        """Arm angle of an electrical cycle (rad)."""
        return self._cycle

    @property
    def on(self) -> bool:
        """Whether the motors are switched on and so hold the arms."""
        return self._on

    @property
    def set_points(self) -> Arms:
        """Angles that the coils pull the arms to (rad from home)."""
        return self._set_points

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
        changed = on != self._on
        if pulses != self._pulses:
            self._pulses = pulses
            self._update_set_points()
            changed = True
        if on:
            half = self._cycle / 2
            x, y, z = self._set_points
            if not (-half < arms[0] - x < half and -half < arms[1] - y < half and -half < arms[2] - z < half):
                # Motors that have just been switched on lock to the nearest position, which is not a slip.
                self._lock(arms, slip=self._on)
                changed = True
        self._on = on
        return changed

    def set_home(self) -> None:
        """Declare the present step counts to be home, and reset the slip."""
        self._home = self._pulses
        self._cycles = [0, 0, 0]
        self._lost = [0, 0, 0]
        self._update_set_points()

    def _lock(self, arms: Sequence[float], *, slip: bool) -> None:
        for i, (arm, set_point) in enumerate(zip(arms, self._set_points, strict=True)):
            if not math.isfinite(arm):
                continue
            cycles = round((arm - set_point) / self._cycle)
            self._cycles[i] += cycles
            if slip:
                self._lost[i] += cycles
        self._update_set_points()

    def _update_set_points(self) -> None:
        counted = self._gear.to_rad([now - home for now, home in zip(self._pulses, self._home, strict=True)])
        x, y, z = (angle + cycles * self._cycle for angle, cycles in zip(counted, self._cycles, strict=True))
        self._set_points = x, y, z
