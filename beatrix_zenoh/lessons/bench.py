"""A bench: the pupil's function drives firmware and plant in virtual time."""

from __future__ import annotations

import importlib
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal, Protocol

import numpy as np

from beatrix_zenoh.contract.errors import BeatrixError, bad_value
from beatrix_zenoh.lessons.measures import Curve, HeadCurves
from beatrix_zenoh.lessons.phrases import Still, Tell, Unmet, error_data

TICK_S = 0.02
"""Time between two calls of the function (s): CHUNK_MS of sim_node/virtual_time.py."""
MODULE = "sim_node.bench"
"""Loaded by name, because this package must not import the simulation."""

Course = Callable[[float], float]
Result = Literal["angle", "rate"]


@dataclass(frozen=True)
class Bench(HeadCurves):
    """What the head did on the bench: times (s), angles (deg), speeds (deg/s), a row for each tick of 20 ms."""

    speed: Curve
    """of the arms, shape (n, 3)"""
    commanded: Curve
    """the firmware's set point of the arms, not rounded to microsteps, shape (n, 3)"""
    course: Curve
    """the yaw to follow at these times; zeros without a course"""


class VirtualRobot(Protocol):
    """A calibrated robot in virtual time, as sim_node/bench.py makes it."""

    def tick(self, target: tuple[float, float, float]) -> dict[str, list[float]]:
        """Turn to yaw, pitch and roll (deg) for a tick, and return the state; raises BeatrixError if it is refused."""


def start(speed: float | None) -> VirtualRobot:
    """Return a robot whose motions have this speed (deg/s; None: the default); raises Refused without a simulation."""
    try:
        robot: VirtualRobot = importlib.import_module(MODULE).VirtualTimeRobot(speed)
    except ImportError as error:
        raise bad_value(
            f"The bench cannot be loaded: {error}. If the simulation is not installed, run "
            "`beatrix install sim`; then check again.",
        ) from None
    return robot


def run(
    plant: VirtualRobot,
    call: Callable[..., float],
    result: Result,
    seconds: float,
    course: Course | None,
    delay_s: float,
    tell: Tell,
) -> Bench:
    """Drive the bench for some time (s) with the pupil's function; see `Attempt.bench`."""
    still = Still(tell, "bench_at", whole=seconds)
    ticks, late = round(seconds / TICK_S), round(delay_s / TICK_S)
    states: list[dict[str, list[float]]] = []
    target = 0.0
    for tick in range(ticks):
        t = tick * TICK_S
        still.look(t)
        if course is None:
            value = call(t)
        else:
            back = max(0, tick - late)  # before the start the head was home
            yaw = states[back - 1]["head"][0] if back else 0.0
            value = call(course(back * TICK_S) - yaw, TICK_S)
        target = value if result == "angle" else target + value * TICK_S
        try:
            states.append(plant.tick((target, 0.0, 0.0)))
        except BeatrixError as error:
            raise Unmet("refused", message=error_data(error).unnamed, t=t) from None
    t_end = np.array([(tick + 1) * TICK_S for tick in range(ticks)])
    return Bench(
        t_end,
        course=np.array([0.0 if course is None else course(t) for t in t_end.tolist()]),
        **{name: np.array([state[name] for state in states]) for name in states[0]},
    )
