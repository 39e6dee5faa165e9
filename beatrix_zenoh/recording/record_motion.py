"""Record the motion of a robot as a motion file."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from pathlib import Path
from typing import Final, TextIO

from beatrix_zenoh.client.degrees import HeadAngles, RobotInfo, robot_of
from beatrix_zenoh.client.motion_file import Place, line_of, lines_of
from beatrix_zenoh.client.robot import Robot
from beatrix_zenoh.contract._generated.messages import Positions, Reason
from beatrix_zenoh.contract.errors import WrongUsage, naming
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


class Thinning:
    """Reduces points: at most one point in `period_s`, and only the first and the last point of a rest.

    Rests before the first motion and after the last are shortened to `rest_s` (s); the times of the result begin at 0.
    """

    def __init__(self, period_s: float, rest_s: float = math.inf) -> None:
        self._period_s, self._rest_s = period_s, rest_s
        self._kept: Timed | None = None
        """the last point that was returned; before the first motion, the first point"""
        self._before: Timed | None = None
        self._begin_s: float | None = None
        """time of the first point of the result; None before the first motion"""

    def add(self, point: Timed) -> list[Timed]:
        """Add the next point; return the points that are kept and were not returned before.

        The first point is returned when the robot begins to move.
        """
        before, self._before = self._before, point
        if self._kept is None or before is None:
            self._kept = point
            return []
        if same(self._kept[1], point[1]):
            return []
        points = self._begin(before)
        if same(self._kept[1], before[1]) and before[0] > self._kept[0] + self._period_s:
            points.append(before)
            self._kept = before
        if point[0] - self._kept[0] >= self._period_s - SLACK_S:
            points.append(point)
            self._kept = point
        return self._shifted(points)

    def last(self) -> list[Timed]:
        """Return the last point, after a rest of `rest_s` at most, and the first one if the robot never moved."""
        if self._kept is None or self._before is None:
            return []
        t, place = self._before
        points = self._begin(self._before)
        if same(self._kept[1], place):
            t = min(t, self._kept[0] + self._rest_s)
        if t > self._kept[0]:
            points.append((t, place))
        return self._shifted(points)

    def _begin(self, before: Timed) -> list[Timed]:
        """Return the first point, with the time at which the rest before the first motion begins; later no point.

        `before`: the last point of that rest.
        """
        if self._kept is None or self._begin_s is not None:
            return []
        self._begin_s = max(self._kept[0], before[0] - self._rest_s)
        self._kept = self._begin_s, self._kept[1]
        return [self._kept]

    def _shifted(self, points: list[Timed]) -> list[Timed]:
        """Return points with times from the first point of the result on."""
        return [(t - (self._begin_s or 0.0), place) for t, place in points]


def record_motion(
    robot: Robot,
    path: Path,
    *,
    keep_rest: bool = False,
    going: Callable[[int], bool] = lambda _points: True,
) -> int:
    """Write the set points of a robot to a motion file; return the number of points.

    The recording ends with Ctrl-C, or when `going` returns False. The file is valid after each point; the first is
    written when the robot begins to move.

    Args:
        robot: the robot, which any client may drive.
        path: the file, which is replaced if it exists.
        keep_rest: keep the whole rests at start and end, instead of STILL_S each.
        going: called with the number of points about 50 times a second; False ends the recording.

    Raises:
        WrongUsage: the file cannot be written.
        NoAnswer: the robot is not online, or its positions have ended; the file contains the motion until then.
    """
    with naming(str(robot)):
        info = robot.info()
    thinning, count = Thinning(1 / POINTS_HZ, math.inf if keep_rest else STILL_S), 0
    try:
        with path.open("w", encoding="utf-8", newline="\n") as file, robot.positions_stream() as stream:
            try:
                for point in timed(stream, head_of(info)):
                    count += write(file, thinning.add(point), [] if count else comments(robot, info))
                    if not going(count):
                        break
            except KeyboardInterrupt:
                pass
            finally:
                count += write(file, thinning.last(), [] if count else comments(robot, info))
    except OSError as error:
        raise WrongUsage(
            Reason.BAD_VALUE, f"{path} cannot be written: {error.strerror}. Name another file."
        ) from error
    return count


def comments(robot: Robot, info: RobotInfo) -> Sequence[str]:
    """Return the comment lines of the file."""
    return (
        f"Set points of {robot}, version {info.version}; times in s, angles in degrees.",
        "`beatrix replay` follows them; docs/how-to/motion-files.md explains the format.",
    )


def write(file: TextIO, points: Sequence[Timed], about: Sequence[str]) -> int:
    """Write the comments and the points; return the number of points."""
    if points:
        file.writelines(lines_of(points, about) if about else [line_of(*point) for point in points])
        file.flush()
    return len(points)


def timed(stream: Iterable[Positions], place_of: Callable[[Positions], Place]) -> Iterator[Timed]:
    """Yield each place with its time (s) since the first; skip time stamps that are not later than the last."""
    begin_ns = last_ns = -1
    for positions in stream:
        if positions.t_mono_ns > last_ns:
            last_ns = positions.t_mono_ns
            begin_ns = last_ns if begin_ns < 0 else begin_ns
            yield (last_ns - begin_ns) / 1e9, place_of(positions)


def same(one: Place, other: Place) -> bool:
    """Return whether two places differ by at most SAME_DEG in every angle."""
    return all(abs(a - b) <= SAME_DEG for a, b in zip(one, other, strict=True))


def head_of(info: RobotInfo) -> Callable[[Positions], HeadAngles]:
    """Return a function that computes the head orientation (deg) from the set points of the arms."""
    neck = Neck(robot_of(info).geometry)

    def head(positions: Positions) -> HeadAngles:
        arms = positions.commanded
        return HeadAngles(*(math.degrees(angle) for angle in neck.forward((arms.x, arms.y, arms.z))))

    return head
