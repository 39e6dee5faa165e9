"""Benchmark of the simulated eyes: their load, the age of their pictures, and the real-time factor meanwhile."""

from __future__ import annotations

import time
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path

from bench_node import Served, cpu_s, free_endpoint, regularity, spread_ms

from beatrix_zenoh import Robot
from beatrix_zenoh.client import CameraImage
from beatrix_zenoh.contract._generated.messages import Positions

NAME = "bench"
SECONDS = 12.0
WARM_S = 7.0
"""Time (s) before the measurement: the real-time factor is a mean over five seconds and must not include the start."""
SWING_DEG = 30.0


@dataclass(frozen=True)
class Run:
    """Measurements of a simulation over SECONDS."""

    cpu: float
    """cores used by the simulation and its drawing process"""
    real_time_factor: float
    """simulated seconds per second, over the last five seconds"""
    positions: str
    """rate (Hz), standard deviation of the period at the source (ms), and number of lost positions"""
    ages_s: list[float]
    """ages of the pictures when they arrive at a subscriber"""
    hz: float
    """pictures a second of each eye"""
    source: str


def tree_cpu_s(process: int) -> float:
    """Return the processor time of a process and its running children so far (s)."""
    children = [
        int(number)
        for listing in Path(f"/proc/{process}/task").glob("*/children")
        for number in listing.read_text().split()
    ]
    return sum(cpu_s(number) for number in (process, *children))


def swing(robot: Robot, until_s: float) -> None:
    """Turn the head to and fro until a time (monotonic clock, s)."""
    side = 1.0
    while time.monotonic() < until_s:
        robot.look(yaw=side * SWING_DEG, pitch=-5 * side)
        side = -side


def measure(endpoint: str, process: int, *, watched: bool) -> Run:
    """Measure a moving simulation for SECONDS, with or without subscribers to both eyes."""
    with ExitStack() as held:
        robot = held.enter_context(Robot(NAME, "sim", connect=endpoint))
        eyes = [held.enter_context(robot.camera(eye, 30.0)) for eye in (("left", "right") if watched else ())]
        for eye in eyes:
            eye.next()
        swing(robot, time.monotonic() + (WARM_S if watched else 0.0))
        stream = held.enter_context(robot.positions_stream())
        seen: list[CameraImage] = []
        got: list[Positions] = []
        for eye in eyes:
            eye.take()
        begin_s, spent_s = time.monotonic(), tree_cpu_s(process)
        motion, side = None, 1.0
        while (now_s := time.monotonic()) < begin_s + SECONDS:
            if motion is None or motion.done():
                motion, side = robot.look(yaw=side * SWING_DEG, pitch=-5 * side, wait=False), -side
            got.append(stream.next(5.0))
            for eye in eyes:
                seen += eye.take()
        took_s = now_s - begin_s
        spent_s = tree_cpu_s(process) - spent_s
        plant = robot.status().plant
        assert plant is not None
    return Run(
        cpu=spent_s / took_s,
        real_time_factor=plant.real_time_factor,
        positions=regularity(got),
        ages_s=[(image.arrived_mono_ns - image.t_mono_ns) / 1e9 for image in seen],
        hz=len(seen) / took_s / 2,
        source=seen[-1].source if seen else "",
    )


def show(title: str, run: Run, idle: Run) -> None:
    """Print the measurements."""
    print(f"{title}, drawn with {run.source}: {run.hz:.1f} pictures/s of each eye, 640 x 480")
    print(f"  CPU for them: {run.cpu - idle.cpu:.0%} of a core (required at 15 Hz with OpenGL: < 45 %)")
    print(f"  real-time factor: {run.real_time_factor:.4f} (required: 1.000 +- 0.005)")
    print(
        f"  positions [Hz], sd of period [ms], lost: {run.positions} (required: 50, < 1, 0); "
        f"without subscriber: {idle.positions}"
    )
    print(f"  age of a picture at its subscriber, median / p99 / largest: {spread_ms(run.ages_s)} ms")


def main() -> None:
    """Measure with OpenGL at 15 and 30 Hz."""
    endpoint = free_endpoint()
    router = Served("beatrix_zenoh.cli", "router", "--listen", endpoint)
    for hz in (15, 30):
        arguments = (
            "--name",
            NAME,
            "--connect",
            endpoint,
            "--ready",
            "--eyes-hz",
            str(hz),
            "--target",
            "sway",
        )
        simulation = Served("sim_node", *arguments)
        idle = measure(endpoint, simulation.pid, watched=False)
        show(f"eyes at {hz} Hz", measure(endpoint, simulation.pid, watched=True), idle)
        print(f"  CPU of the simulation without subscriber, moving: {idle.cpu:.0%} of a core")
        simulation.end()
    router.end()


if __name__ == "__main__":
    main()
