"""Measure the lag of a simulation that follows a virtual robot, and print it as a table for docs/how-to/follow.md."""

from __future__ import annotations

import math
import time
from collections.abc import Callable

from bench_node import Served, free_endpoint
from following_lag import lag_s, series

from beatrix_zenoh import Robot
from beatrix_zenoh.contract._generated.messages import FollowState

SETTLE_S = 0.6
STREAM_S = 6.0
PERIOD_S = 0.02


def there_and_back(robot: Robot, speed: float) -> None:
    """Turn the head to both sides at a speed (deg/s)."""
    for angle in (50, -50, 0):
        robot.move(angle, angle, angle, speed=speed)


def circle(robot: Robot) -> None:
    """Stream targets on a circle of the head, 50 per second."""
    began_s = time.monotonic()
    while (t := time.monotonic() - began_s) < STREAM_S:
        pitch, roll = 15 * math.sin(2 * t), 15 * math.cos(2 * t)
        robot.look(pitch=pitch, roll=roll, speed=80, wait=False)
        time.sleep(PERIOD_S)
    robot.look(speed=60)


MOVEMENTS: dict[str, Callable[[Robot], None]] = {
    "yaw to 50° on both sides, 30°/s": lambda robot: there_and_back(robot, 30),
    "yaw to 50° on both sides, 60°/s": lambda robot: there_and_back(robot, 60),
    "yaw to 50° on both sides, 90°/s": lambda robot: there_and_back(robot, 90),
    "a circle of the head as a stream of 50 targets a second": circle,
}


def measure(simulation: Robot, hardware: Robot) -> None:
    """Print a row for each movement."""
    print(
        "| movement of the robot | lag of the measured arms | of the set points | difference without the lag, mean |"
    )
    print("|---|---|---|---|")
    for name, drive in MOVEMENTS.items():
        with hardware.positions_stream() as there, simulation.positions_stream() as here:
            time.sleep(SETTLE_S)
            drive(hardware)
            time.sleep(SETTLE_S)
            robot, follower = there.take(), here.take()
        lag, rest = lag_s(series(robot), series(follower))
        commanded, _ = lag_s(series(robot, "commanded"), series(follower, "commanded"))
        print(f"| {name} | {lag * 1000:.0f} ms | {commanded * 1000:.0f} ms | {rest:.2f}° |")


def main() -> None:
    """Start a router and both robots, and measure."""
    endpoint = free_endpoint()
    names = ("--name", "bea", "--connect", endpoint)
    served = [Served("beatrix_zenoh.cli", "router", "--listen", endpoint)]
    try:
        served.append(Served("hw_node", *names, "--port", "virtual:"))
        served.append(Served("sim_node", *names, "--follow"))
        with (
            Robot("bea", "hw", connect=endpoint) as hardware,
            Robot("bea", "sim", connect=endpoint) as simulation,
        ):
            hardware.make_ready()
            while simulation.status().following is not FollowState.FOLLOWING:
                time.sleep(PERIOD_S)
            measure(simulation, hardware)
    finally:
        for process in reversed(served):
            process.end()


if __name__ == "__main__":
    main()
