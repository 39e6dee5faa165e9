"""Print the load and the accuracy of the simulated neck, at full speed within the limits of the robot."""

from __future__ import annotations

import math
import statistics
import time

import numpy as np

from beatrix_zenoh.board.link import encode
from beatrix_zenoh.board.virtual import Firmware
from beatrix_zenoh.contract._generated.robot import ROBOT
from beatrix_zenoh.contract._generated.serial import Enable, FrameType, MoveStraight
from beatrix_zenoh.contract.names import ARMS
from beatrix_zenoh.motion.gear import Arms, Gear
from beatrix_zenoh.motion.kinematics import Neck
from sim_node.model import TIMESTEP_MS
from sim_node.plant import Plant
from sim_node.preview import simulate_motion

_BLOCK = 250
_TO_REACH_US = 30
_AMPLITUDE = math.radians(25)
_CIRCLES_HZ = 0.35
"""Highest frequency of the circle at which the arms stay below their top speed."""


def closure_error(plant: Plant) -> float:
    """Return the largest distance (m) between the end of a rod and its mount on the head, at the last step."""
    ends, mounts = (
        np.array([plant.data.site(f"{part}_{name}").xpos for name in ARMS]) for part in ("rod", "mount")
    )
    return float(np.linalg.norm(ends - mounts, axis=1).max())


def circling(t: float) -> Arms:
    """Return the arm angles (rad) of a circling head at time `t` (s); the circle grows from home within 4 s."""
    size = _AMPLITUDE * min(1.0, t / 4)
    phase = math.tau * _CIRCLES_HZ * t
    return Neck().inverse(0.5 * math.sin(0.3 * t), size * math.cos(phase), size * math.sin(phase))


def step_us(plant: Plant, path: list[tuple[int, int, int]]) -> float:
    """Return the median over blocks of steps of the mean time of a step (us)."""
    times = []
    for first in range(0, len(path) - _BLOCK + 1, _BLOCK):
        begin = time.perf_counter_ns()
        for pulses in path[first : first + _BLOCK]:
            plant.step(pulses, drivers_on=True)
        times.append((time.perf_counter_ns() - begin) / _BLOCK / 1000)
    return statistics.median(times)


def angle_between(plant: Plant, neck: Neck) -> float:
    """Return the largest element of the difference between measured and calculated rotation, as an angle (deg)."""
    calculated = neck.rotation(plant.arms())
    return math.degrees(
        max(
            abs(a - b)
            for row, other in zip(plant.rotation(), calculated, strict=True)
            for a, b in zip(row, other, strict=True)
        )
    )


def preview_factor(gear: Gear) -> float:
    """Return the simulated seconds per second in a preview of a nod."""
    plant, firmware = Plant(), Firmware()
    firmware.receive(encode(FrameType.ENABLE, 1, Enable(1).pack()))
    firmware.receive(encode(FrameType.CALIBRATE, 2, b""))
    nod = MoveStraight(1, gear.to_steps(Neck().inverse(0.0, 0.4, 0.0)), 1000)
    begin = time.perf_counter()
    preview = simulate_motion(plant, firmware, nod)
    return preview.duration / (time.perf_counter() - begin)


def main() -> None:
    gear, neck = Gear(), Neck()
    begin = time.perf_counter()
    plant = Plant()
    made = time.perf_counter() - begin
    begin = time.perf_counter()
    plant.copy()
    copied = time.perf_counter() - begin
    path = [gear.to_steps(circling(k * TIMESTEP_MS / 1000)) for k in range(10_000)]
    asleep = step_us(plant, [(0, 0, 0)] * 5_000)
    moving = step_us(plant, path)
    plant = Plant()
    closure = error = fastest = 0.0
    for pulses in path:
        plant.step(pulses, drivers_on=True)
        closure = max(closure, closure_error(plant))
        error = max(error, angle_between(plant, neck))
        fastest = max(fastest, *map(abs, plant.velocities()))
    print(f"plant made in {made * 1e3:.0f} ms, copied in {copied * 1e3:.1f} ms")
    print(f"physics step asleep: {asleep:.1f} us, moving: {moving:.1f} us (required: {_TO_REACH_US})")
    print(f"real-time factor, moving: {TIMESTEP_MS * 1000 / moving:.0f}")
    print(f"preview: {preview_factor(gear):.0f} times as fast as the motion")
    print(
        f"circling at up to {math.degrees(fastest):.0f}°/s (limit {ROBOT.limits.speed_max:.0f}°/s): "
        f"head within {error:.4f}° of forward kinematics (required: 0.02), "
        f"error of loop closure {closure * 1e3:.4f} mm (required: 0.05)"
    )


if __name__ == "__main__":
    main()
