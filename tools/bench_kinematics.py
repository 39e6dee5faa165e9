"""Print the cost of one inverse and one forward call in microseconds, median over poses of up to 35 deg tilt."""

from __future__ import annotations

import math
import random
import statistics
import time
from collections.abc import Callable

from beatrix_zenoh.kinematics import Neck

_POSES = 500
_REPEATS = 20


def median_us(
    call: Callable[[float, float, float], object], inputs: list[tuple[float, float, float]]
) -> float:
    """Median over the inputs of the mean time of a few calls (us)."""
    times = []
    for a, b, c in inputs:
        begin = time.perf_counter_ns()
        for _ in range(_REPEATS):
            call(a, b, c)
        times.append((time.perf_counter_ns() - begin) / _REPEATS / 1000)
    return statistics.median(times)


def main() -> None:
    neck = Neck()
    rng = random.Random(1)
    poses = []
    for _ in range(_POSES):
        tilt, direction = math.radians(35) * math.sqrt(rng.random()), rng.uniform(-math.pi, math.pi)
        poses.append((rng.uniform(-3, 3), tilt * math.cos(direction), tilt * math.sin(direction)))
    arms = [neck.inverse(*pose) for pose in poses]
    print(f"inverse kinematics: {median_us(neck.inverse, poses):.1f} us (to reach: 10)")
    print(f"forward kinematics: {median_us(lambda *a: neck.forward(a), arms):.1f} us (to reach: 20)")


if __name__ == "__main__":
    main()
