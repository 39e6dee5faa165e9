"""The lag of the hardware's motion behind the simulation's, from their published positions."""

from __future__ import annotations

from beatrix_zenoh.client.readings import ArmAngles, reading
from beatrix_zenoh.client.robot import Robot
from beatrix_zenoh.client.subscription import Arrival
from beatrix_zenoh.contract._generated.messages import Positions

MOVED_DEG = 0.5
"""Distance of an arm from its start at which a motion counts as begun; until then both robots accelerate alike."""
SAME_CLOCK_NS = 50_000_000
"""Delays that differ by more than this (ns) come from two clocks; each counts from the boot of its computer."""


class MotionBegin:
    """Finds the time at which one robot begins to move."""

    def __init__(self, robot: Robot, start: ArmAngles) -> None:
        """Subscribe to the robot's positions; `start` are its arm angles (deg) at rest."""
        self._start = start
        self._positions = robot.positions_stream()
        self._before: tuple[int, float] | None = None
        self.begin_ns: int | None = None
        """time at which the robot began to move, by the clock of the source; None: not yet"""
        self.delay_ns: int | None = None
        """the smallest difference between arrival and time stamp: transmission time plus clock offset"""

    def read(self) -> None:
        """Process the positions that have arrived."""
        for arrival in self._positions.take_arrivals():
            self.see(arrival)

    def see(self, arrival: Arrival[Positions]) -> None:
        """Process one publication."""
        now_ns = arrival.value.t_mono_ns
        delay_ns = arrival.t_mono_ns - now_ns
        self.delay_ns = delay_ns if self.delay_ns is None else min(self.delay_ns, delay_ns)
        if self.begin_ns is not None:
            return
        moved_deg = furthest(self._start, reading(arrival.value).commanded)
        if moved_deg >= MOVED_DEG:
            before_ns, before_deg = self._before or (now_ns, 0.0)
            part = (MOVED_DEG - before_deg) / (moved_deg - before_deg)
            self.begin_ns = before_ns + round(part * (now_ns - before_ns))
        self._before = now_ns, moved_deg

    def close(self) -> None:
        """End the subscription."""
        self._positions.close()


def lag_s(sim: MotionBegin, hw: MotionBegin) -> float | None:
    """Return the time (s) from the start of the simulation's motion to that of the hardware; None if one has not begun.

    Its error is a few milliseconds on one computer; between two, the difference of their shortest transmission times.
    """
    if sim.begin_ns is None or hw.begin_ns is None or sim.delay_ns is None or hw.delay_ns is None:
        return None
    clocks_ns = hw.delay_ns - sim.delay_ns
    return (hw.begin_ns - sim.begin_ns + (clocks_ns if abs(clocks_ns) > SAME_CLOCK_NS else 0)) / 1e9


def furthest(one: ArmAngles, other: ArmAngles) -> float:
    """Return the largest difference (deg) between two angles of the same arm."""
    return max(abs(a - b) for a, b in zip(one, other, strict=True))
