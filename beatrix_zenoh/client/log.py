"""A log of one robot: what it did while the log was open, as numpy arrays."""

from __future__ import annotations

import csv
import math
import time
from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np
import numpy.typing as npt

from beatrix_zenoh.bus import ProcessBound
from beatrix_zenoh.client.degrees import Kinematics, RobotInfo, arm_angles, head_angles
from beatrix_zenoh.client.figures import time_figure
from beatrix_zenoh.client.request import title
from beatrix_zenoh.client.session import Client, Closable, Place
from beatrix_zenoh.client.slips import Suggesting
from beatrix_zenoh.client.subscription import SILENCE_S, Arrival, Subscription, events, message, same
from beatrix_zenoh.colours import ARMS, AXES
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import Event, Positions
from beatrix_zenoh.contract.errors import BeatrixError, wrong_usage

if TYPE_CHECKING:
    from beatrix_zenoh.client.figures import Figure

LENGTH: Final = 90_000
"""Longest log: 30 minutes of positions."""
PAUSE_S: Final = 0.1
"""A longer time (s) between two positions is a gap; a robot sends them every 0.02 s."""

Series = npt.NDArray[np.float64]


class Gap(NamedTuple):
    """A time without positions."""

    t: float
    """time of the last position before the gap (s), as in the log"""
    seconds: float
    """duration"""
    lost: int
    """positions that the robot has sent and this program has not received"""
    cause: str
    """what has happened"""

    def __str__(self) -> str:
        return f"{self.t:.2f} s: {self.seconds:.2f} s without positions, {self.cause}"


class Log(ProcessBound, Closable, Suggesting):
    """Positions (deg, deg/s) and events of a robot since the log began; the arrays exist when it has ended.

    All arrays have the same shape (n,), one number for each position. `t` is the time (s) since the first position by the
    robot's clock. The commanded angles of the head are computed
    from those of the arms; nan: the head cannot be there.
    """

    t: Series
    yaw: Series
    pitch: Series
    roll: Series
    short: Series
    middle: Series
    long: Series
    commanded_yaw: Series
    commanded_pitch: Series
    commanded_roll: Series
    commanded_short: Series
    commanded_middle: Series
    commanded_long: Series
    velocity_short: Series
    velocity_middle: Series
    velocity_long: Series
    began_s: float
    """time of t = 0 by the robot's monotonic clock (s), as in `Reading.t` and, in ns, `Event.t_mono_ns`"""
    events: list[Event]
    gaps: list[Gap]
    repeated: int
    """positions without new values, which are not in the arrays"""
    dropped: int
    """positions that were dropped because the log was open for more than 30 minutes"""

    def __init__(self, client: Client, place: Place, info: RobotInfo) -> None:
        """Begin, and wait for the first position (up to 3 s); raises NoAnswer if none arrives."""
        self._kinematics = Kinematics(info)
        self._robot = title(place)
        self._events = events(client, *place)
        self._positions: Subscription[Positions] = Subscription(
            client, keys.positions(*place), message(Positions, same), timeout_s=SILENCE_S, length=LENGTH
        )
        try:
            self._first = self._positions.next_arrival()
        except BaseException:
            self._positions.close()
            self._events.close()
            raise

    def close(self) -> None:
        """End the log, and fill the arrays. May be called twice."""
        if "t" in vars(self):
            return
        self._positions.close()
        self._events.close()
        arrivals, self.dropped = self._positions.take_arrivals(), self._positions.dropped
        if not self.dropped or not arrivals:  # otherwise the positions after the first one are missing
            arrivals.insert(0, self._first)
        self.events = self._events.take()
        self.began_s = arrivals[0].value.t_mono_ns / 1e9
        new = [one.value for one in arrivals if not one.value.repeated or one is arrivals[0]]
        self.repeated = len(arrivals) - len(new)
        self.gaps = find_gaps([one.value for one in arrivals], arrivals[-1])
        self._fill(new)

    def _fill(self, positions: Sequence[Positions]) -> None:
        rows = [
            (
                (one.t_mono_ns - positions[0].t_mono_ns) / 1e9,
                *head_angles(one.head),
                *arm_angles(one.position),
                *self._commanded(*arm_angles(one.commanded)),
                *arm_angles(one.velocity),
            )
            for one in positions
        ]
        for name, column in zip(COLUMNS, np.array(rows, dtype=np.float64).T, strict=True):
            column.setflags(write=False)
            setattr(self, name, column)

    def _commanded(self, short: float, middle: float, long: float) -> tuple[float, ...]:
        try:
            head: tuple[float, ...] = self._kinematics.forward(short, middle, long)
        except BeatrixError:  # the log must show such arms, too
            head = (math.nan,) * 3
        return (*head, short, middle, long)

    def plot(self) -> Figure:
        """Return a figure of arms and head over time, commanded angles dashed; needs the extra `plot`.

        Raises WrongUsage if the log is still open, or matplotlib is not installed.
        """
        self._check_closed()
        arms, head = ({name: getattr(self, name) for name in names} for names in (ARMS, AXES))
        asked = tuple({name: getattr(self, f"commanded_{name}") for name in names} for names in (ARMS, AXES))
        return time_figure(self.t, arms, head, (asked[0], asked[1]))

    def save(self, path: str | Path) -> None:
        """Write a CSV file with one column per array; the heads name the units, as `t_s`, `yaw_deg`, `velocity_short_deg_s`.

        Raises WrongUsage if the log is still open, or the name does not end with `.csv`; OSError.
        """
        self._check_closed()
        file = Path(path)
        if file.suffix.lower() != ".csv":
            raise wrong_usage(f"{file} does not end with .csv: save writes a CSV file.")
        with file.open("w", newline="", encoding="utf-8") as out:
            writer = csv.writer(out)
            writer.writerow(HEADS)
            columns = [getattr(self, name) for name in COLUMNS]
            writer.writerows([f"{value:.6f}" for value in row] for row in zip(*columns, strict=True))

    def _check_closed(self) -> None:
        if "t" not in vars(self):
            raise wrong_usage(OPEN)

    if not TYPE_CHECKING:

        def __getattr__(self, name):
            if name in Log.__annotations__ and "t" not in vars(self):
                raise AttributeError(OPEN)
            return super().__getattr__(name)

    def __repr__(self) -> str:
        if "t" not in vars(self):
            return f"<log of {self._robot}: still open>"
        text = f"{self.t[-1]:.2f} s, {len(self.t)} positions, {len(self.events)} events"
        return f"<log of {self._robot}: {text}{''.join(f'; gap at {gap}' for gap in self.gaps[:3])}>"


COLUMNS: Final = [name for name, kind in Log.__annotations__.items() if kind == "Series"]
HEADS: Final = [
    f"{name}_{'s' if name == 't' else 'deg_s' if name.startswith('velocity') else 'deg'}" for name in COLUMNS
]
"""Names of the columns in a CSV file, with units as in motion files."""
OPEN: Final = "The log is still open: read it after the end of its `with` block, or call close() first."


def find_gaps(positions: Sequence[Positions], newest: Arrival[Positions]) -> list[Gap]:
    """Return the gaps between positions, and the one after the newest, if the robot was silent up to now."""
    found = []
    for before, after in pairwise(positions):
        t = (before.t_mono_ns - positions[0].t_mono_ns) / 1e9
        seconds = (after.t_mono_ns - before.t_mono_ns) / 1e9
        lost = after.seq - before.seq - 1
        if lost < 0:
            found.append(Gap(t, seconds, 0, "the robot's node was started again"))
        elif seconds > PAUSE_S:
            cause = f"{lost} were lost on the way" if lost else "the robot had no new ones"
            found.append(Gap(t, seconds, lost, cause))
        elif lost:
            found.append(Gap(t, seconds, lost, f"{lost} were lost on the way"))
    silent_s = (time.monotonic_ns() - newest.t_mono_ns) / 1e9
    if silent_s > PAUSE_S:
        t = (positions[-1].t_mono_ns - positions[0].t_mono_ns) / 1e9
        found.append(Gap(t, silent_s, 0, "the robot was silent up to the end"))
    return found
