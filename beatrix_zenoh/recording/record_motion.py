"""Record the motion of a robot as a motion file."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from pathlib import Path
from typing import Final

from beatrix_zenoh.client.degrees import HeadAngles, RobotInfo, robot_of
from beatrix_zenoh.client.motion_file import Place, lines_of
from beatrix_zenoh.client.robot import Robot
from beatrix_zenoh.contract._generated.messages import Positions
from beatrix_zenoh.contract.errors import naming, wrong_usage
from beatrix_zenoh.motion.kinematics import Neck
from beatrix_zenoh.paths.path import STILL_S

POINTS_HZ: Final = 25.0
"""Points per second while the robot moves."""
SLACK_S: Final = 0.005
"""Tolerance of periods, because positions, sent every 20 ms, arrive slightly early or late."""
SAME_DEG: Final = 0.01
"""Set points closer than this are equal: they are whole microsteps of 0.086 deg."""
Timed = tuple[float, Place]
"""Time in s, and a place in deg."""


def thinned(points: Sequence[Timed], period_s: float, rest_s: float = math.inf) -> list[Timed]:
    """Return at most one point in `period_s` (s), and of each rest the first and the last one; their times begin at 0.

    Rests before the first motion and after the last are shortened to `rest_s` (s).
    """
    kept = list(points[:1])
    for before, point in itertools.pairwise(points):
        if same(kept[-1], point):
            continue
        if same(kept[-1], before) and before[0] > kept[-1][0] + period_s:
            kept.append(before)
        if point[0] - kept[-1][0] >= period_s - SLACK_S:
            kept.append(point)
    if points and points[-1][0] > kept[-1][0]:
        kept.append(points[-1])
    if len(kept) > 1 and same(kept[0], kept[1]):
        kept[0] = max(kept[0][0], kept[1][0] - rest_s), kept[0][1]
    if len(kept) > 1 and same(kept[-2], kept[-1]):
        kept[-1] = min(kept[-1][0], kept[-2][0] + rest_s), kept[-1][1]
    return [(t - kept[0][0], place) for t, place in kept]


def record_motion(
    robot: Robot,
    path: Path,
    *,
    keep_rest: bool = False,
    going: Callable[[], bool] = lambda: True,
) -> int:
    """Write the set points of a robot to a motion file when the recording ends; return the number of points.

    The recording ends with Ctrl-C, or when `going` returns False.

    Args:
        robot: the robot, which any client may drive.
        path: the file, which is replaced if it exists.
        keep_rest: keep the whole rests at start and end, instead of STILL_S each.
        going: called about 50 times a second; False ends the recording.

    Raises:
        WrongUsage: the file cannot be written.
        NoAnswer: the robot is not online, or its positions have ended; the file contains the motion until then.
    """
    with naming(str(robot)):
        info = robot.info()
    points: list[Timed] = []
    kept: list[Timed] = []
    try:
        with path.open("w", encoding="utf-8", newline="\n") as file, robot.positions_stream() as stream:
            try:
                for point in timed(stream, head_of(info)):
                    points.append(point)
                    if not going():
                        break
            except KeyboardInterrupt:
                pass
            finally:
                kept = thinned(points, 1 / POINTS_HZ, math.inf if keep_rest else STILL_S)
                file.writelines(lines_of(kept, comments(robot, info)))
    except OSError as error:
        raise wrong_usage(f"{path} cannot be written: {error.strerror}. Name another file.") from error
    return len(kept)


def comments(robot: Robot, info: RobotInfo) -> Sequence[str]:
    """Return the comment lines of the file."""
    return (
        f"Set points of {robot}, version {info.version}; times in s, angles in degrees.",
        "`beatrix replay` follows them; docs/how-to/motion-files.md explains the format.",
    )


def timed(stream: Iterable[Positions], place_of: Callable[[Positions], Place]) -> Iterator[Timed]:
    """Yield each place with its time (s) since the first; skip time stamps that are not later than the last."""
    begin_ns = last_ns = -1
    for positions in stream:
        if positions.t_mono_ns > last_ns:
            last_ns = positions.t_mono_ns
            begin_ns = last_ns if begin_ns < 0 else begin_ns
            yield (last_ns - begin_ns) / 1e9, place_of(positions)


def same(one: Timed, other: Timed) -> bool:
    """Return whether the places of two points differ by at most SAME_DEG in every angle."""
    return all(abs(a - b) <= SAME_DEG for a, b in zip(one[1], other[1], strict=True))


def head_of(info: RobotInfo) -> Callable[[Positions], HeadAngles]:
    """Return a function that computes the head orientation (deg) from the set points of the arms."""
    neck = Neck(robot_of(info).geometry)

    def head(positions: Positions) -> HeadAngles:
        arms = positions.commanded
        return HeadAngles(*(math.degrees(angle) for angle in neck.forward((arms.x, arms.y, arms.z))))

    return head
