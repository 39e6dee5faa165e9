"""A bench: the pupil's function drives firmware and plant in virtual time, which a child process runs."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass
from importlib import metadata
from typing import Literal

import msgspec
import numpy as np

from beatrix_zenoh import processes
from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.errors import Refused
from beatrix_zenoh.lessons.guarded import LineChild, NoReply
from beatrix_zenoh.lessons.measures import Curve, HeadCurves
from beatrix_zenoh.lessons.phrases import ErrorData, Still, Tell, Unmet, busy, phrase

TICK_S = 0.02
"""Time between two calls of the function (s): CHUNK_MS of sim_node/virtual_time.py."""
ANSWER_S = 60.0
"""Longest time of an answer of the bench (s), its start included."""

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


def start(speed: float | None) -> LineChild:
    """Start the process of the bench; raises Refused if it ends at once, NotMeasurable if it does not answer."""
    found = metadata.entry_points(group="beatrix.processes", name="bench")
    module = next((entry.module for entry in found), "sim_node.bench")
    process = subprocess.Popen(
        [sys.executable, "-P", "-m", module],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        process_group=None if sys.platform == "win32" else 0,
        creationflags=processes.NEW_GROUP,
    )

    def end() -> None:
        process.kill()
        process.wait()

    child = LineChild(process, process.stdin, end)
    try:
        child.ask({"speed": speed}, ANSWER_S)
    except NoReply as error:
        child.close()
        if error.code is None:
            raise busy(phrase("no_bench")) from None
        raise Refused(
            Reason.BAD_VALUE,
            f"The bench ended at its start ({processes.in_words(error.code)}). If the simulation is not installed, run "
            '`pip install ".[sim]"` in the folder of BEATRIX; then check again.',
        ) from None
    except BaseException:
        child.close()
        raise
    return child


def run(
    plant: LineChild,
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
        states.append(_tick(plant, [target, 0.0, 0.0], t))
    t_end = np.array([(tick + 1) * TICK_S for tick in range(ticks)])
    return Bench(
        t_end,
        course=np.array([0.0 if course is None else course(t) for t in t_end.tolist()]),
        **{name: np.array([state[name] for state in states]) for name in states[0]},
    )


def _tick(plant: LineChild, target: list[float], t: float) -> dict[str, list[float]]:
    try:
        answer = plant.ask({"head": target}, ANSWER_S)
    except NoReply:
        raise busy(phrase("no_bench")) from None
    if "refused" in answer:
        raise Unmet("refused", message=msgspec.convert(answer["refused"], ErrorData).unnamed, t=t)
    return {name: list(map(float, value)) for name, value in answer.items() if isinstance(value, list)}
