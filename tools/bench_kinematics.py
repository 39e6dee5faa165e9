"""Print the times (us) of the kinematics, and of the check of small and large motions: medians over many poses."""

from __future__ import annotations

import math
import random
import statistics
import time
from collections.abc import Callable

from beatrix_zenoh.motion.gear import Arms
from beatrix_zenoh.motion.kinematics import Neck
from beatrix_zenoh.motion.limits import MotionLimits

_POSES = 500
_REPEATS = 20


def median_us(call: Callable[[Arms], object], inputs: list[Arms], repeats: int = _REPEATS) -> float:
    """Return the median over the inputs of the mean time (us) of `repeats` calls."""
    times = []
    for given in inputs:
        begin = time.perf_counter_ns()
        for _ in range(repeats):
            call(given)
        times.append((time.perf_counter_ns() - begin) / repeats / 1000)
    return statistics.median(times)


def main() -> None:
    neck = Neck()
    rng = random.Random(1)
    poses: list[Arms] = []
    for _ in range(_POSES):
        tilt, direction = math.radians(35) * math.sqrt(rng.random()), rng.uniform(-math.pi, math.pi)
        poses.append((rng.uniform(-3, 3), tilt * math.cos(direction), tilt * math.sin(direction)))
    arms = [neck.inverse(*pose) for pose in poses]
    print(f"inverse kinematics: {median_us(lambda pose: neck.inverse(*pose), poses):.1f} us (required: 10)")
    print(f"forward kinematics: {median_us(neck.forward, arms):.1f} us (required: 20)")
    limits, rest, speed = MotionLimits(), (0.0, 0.0, 0.0), (1.0, 1.0, 1.0)

    def check(start: Arms, target: Arms) -> None:
        limits.check_motion(start, rest, target, speed, straight=True)

    tilted = [
        neck.inverse(0.0, math.radians(20) * math.cos(i), math.radians(20) * math.sin(i)) for i in range(100)
    ]
    turns = [neck.inverse(math.pi, pitch, roll) for _, pitch, roll in poses[:100]]
    small = median_us(lambda target: check(rest, target), tilted, 3)
    large = median_us(
        lambda end: check((end[0] - math.tau, end[1] - math.tau, end[2] - math.tau), end), turns, 3
    )
    print(
        f"check of a motion: 20° of tilt {small:.0f} us (required: 500), 360° of yaw {large:.0f} us (required: 2000)"
    )


if __name__ == "__main__":
    main()
