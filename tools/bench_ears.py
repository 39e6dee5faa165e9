"""Benchmark of the simulated ears: their load, the age of their blocks, lost blocks, and the real-time factor."""

from __future__ import annotations

import time
from contextlib import ExitStack
from dataclasses import dataclass

from bench_eyes import swing, tree_cpu_s
from bench_node import Served, free_endpoint, spread_ms

from beatrix_zenoh import Robot
from beatrix_zenoh.client.sound import Sound
from beatrix_zenoh.client.subscription import Arrival

NAME = "bench"
SECONDS = 12.0
READ_S = 1.0
"""Time (s) between two reads; ten seconds of blocks wait at most."""
SETTLE_S = 6.0
"""Time (s) before each measurement: the real-time factor is a mean over five seconds."""


@dataclass(frozen=True)
class Run:
    """Measurements of a simulation over SECONDS."""

    cpu: float
    """cores used by the simulation"""
    real_time_factor: float
    ages_s: list[float]
    """ages of the blocks when they arrive at a subscriber: from their first frame, so at least 0.02"""
    faults: str


def measure(robot: Robot, process: int, *, heard: bool, moving: bool) -> Run:
    """Measure a simulation that plays noise, at rest or moving, with or without a subscriber to its ears."""
    robot.play_sound("noise", 60)
    with ExitStack() as held:
        ears = held.enter_context(robot.microphones()) if heard else None
        turn = swing if moving else wait
        turn(robot, time.monotonic() + SETTLE_S)
        if ears is not None:
            ears.take()
        begin_s, spent_s = time.monotonic(), tree_cpu_s(process)
        blocks: list[Arrival[Sound]] = []
        while time.monotonic() < begin_s + SECONDS:
            turn(robot, time.monotonic() + READ_S)
            blocks += [] if ears is None else ears.take_arrivals()
        spent_s, took_s = tree_cpu_s(process) - spent_s, time.monotonic() - begin_s
        faults = "" if ears is None else str(ears.faults)
        plant = robot.status().plant
        assert plant is not None
    ages_s = [(one.t_mono_ns - one.value.t_mono_ns) / 1e9 for one in blocks]
    return Run(spent_s / took_s, plant.real_time_factor, ages_s, faults)


def wait(_: Robot, until_s: float) -> None:
    """Wait until a time (monotonic clock, s)."""
    time.sleep(until_s - time.monotonic())


def main() -> None:
    """Measure the ears at rest and moving."""
    endpoint = free_endpoint()
    router = Served("beatrix_zenoh.cli", "router", "--listen", endpoint)
    simulation = Served("sim_node", "--name", NAME, "--connect", endpoint, "--ready")
    try:
        with Robot(NAME, "sim", connect=endpoint) as robot:
            for title, moving in (("at rest", False), ("moving", True)):
                idle = measure(robot, simulation.pid, heard=False, moving=moving)
                show(title, measure(robot, simulation.pid, heard=True, moving=moving), idle)
    finally:
        simulation.end()
        router.end()


def show(title: str, run: Run, idle: Run) -> None:
    """Print the measurements."""
    print(f"ears {title}, 50 blocks/s of 20 ms, one subscriber; without: {idle.cpu:.1%} of a core")
    print(f"  CPU for them: {run.cpu - idle.cpu:.1%} of a core (required: < 6 %)")
    print(f"  real-time factor: {run.real_time_factor:.4f} (required: 1.000 +- 0.005)")
    print(f"  age of a block's first frame, median / p99 / largest: {spread_ms(run.ages_s)} ms")
    print(f"  {run.faults} (required: none)")


if __name__ == "__main__":
    main()
