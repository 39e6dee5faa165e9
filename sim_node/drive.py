"""Stepper motors: from pulses to set points of the arms, with slip.

A stepper does not know where it stands. Its coils hold the rotor at the nearest of the positions that repeat
every electrical cycle, four full steps. Pushed further than half a cycle off, the rotor falls to the next such
position and four full steps are lost, in silence: the firmware's counter no longer tells where the arm is.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final

from msgspec import Struct

from beatrix_zenoh._generated.robot import ROBOT, Drive
from beatrix_zenoh.drive import Arms, Gear

CYCLE_FULL_STEPS: Final = 4
"""Full steps of a two-phase motor's electrical cycle."""

Counts = tuple[int, int, int]


class DriveState(Struct, frozen=True):
    """All that a drive remembers."""

    pulses: Counts
    """microsteps since the board's start, as last seen"""
    home: Counts
    """microsteps at which the arms were put to home"""
    cycles: Counts
    """electrical cycles by which the arms stand ahead of the counted steps"""
    lost: Counts
    """of these, cycles that slipped while the motors were on"""
    on: bool
    """motors on"""


class StepperDrive:
    """Three stepper motors with their gears."""

    def __init__(self, drive: Drive = ROBOT.drive) -> None:
        self._gear = Gear(drive)
        # Arms, not motors: a sign that turns a motor's direction is in the gear.
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
        """Whether the motors hold the arms."""
        return self._on

    @property
    def set_points(self) -> Arms:
        """Where the coils pull the arms to (rad from home)."""
        return self._set_points

    @property
    def slipped(self) -> Counts:
        """Full steps by which each motor's counter is ahead of its rotor, lost by slipping since `put_home`."""
        x, y, z = (
            -CYCLE_FULL_STEPS * sign * lost for sign, lost in zip(self._signs, self._lost, strict=True)
        )
        return x, y, z

    def turn(self, pulses: Counts, arms: Sequence[float], *, on: bool) -> bool:
        """Follow the board for one physics step; True if the set points or the switch changed.

        `pulses` are microsteps since the board's start, `arms` the measured angles (rad).
        """
        changed = on != self._on
        if pulses != self._pulses:
            self._pulses = pulses
            self._place()
            changed = True
        if on:
            half = self._cycle / 2
            x, y, z = self._set_points
            if not (-half < arms[0] - x < half and -half < arms[1] - y < half and -half < arms[2] - z < half):
                # Motors just switched on lock to the nearest position; that is no slip.
                self._lock(arms, slip=self._on)
                changed = True
        self._on = on
        return changed

    def put_home(self) -> None:
        """Call the present step counts home and forget what slipped."""
        self._home = self._pulses
        self._cycles = [0, 0, 0]
        self._lost = [0, 0, 0]
        self._place()

    def save(self) -> DriveState:
        """What `load` needs to return to this moment."""
        cycles, lost = self._cycles, self._lost
        return DriveState(
            pulses=self._pulses,
            home=self._home,
            cycles=(cycles[0], cycles[1], cycles[2]),
            lost=(lost[0], lost[1], lost[2]),
            on=self._on,
        )

    def load(self, state: DriveState) -> None:
        """Return to a saved moment."""
        self._pulses = state.pulses
        self._home = state.home
        self._cycles = list(state.cycles)
        self._lost = list(state.lost)
        self._on = state.on
        self._place()

    def _lock(self, arms: Sequence[float], *, slip: bool) -> None:
        for i, (arm, set_point) in enumerate(zip(arms, self._set_points, strict=True)):
            if not math.isfinite(arm):
                continue
            cycles = round((arm - set_point) / self._cycle)
            self._cycles[i] += cycles
            if slip:
                self._lost[i] += cycles
        self._place()

    def _place(self) -> None:
        counted = self._gear.to_rad([now - home for now, home in zip(self._pulses, self._home, strict=True)])
        x, y, z = (angle + cycles * self._cycle for angle, cycles in zip(counted, self._cycles, strict=True))
        self._set_points = x, y, z
