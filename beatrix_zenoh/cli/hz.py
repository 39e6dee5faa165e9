"""`beatrix hz`: measure the rate, jitter, age and losses of positions or pictures."""

from __future__ import annotations

import itertools
import statistics
import time
from collections.abc import Mapping, Sequence
from enum import StrEnum
from typing import Annotated, NamedTuple, Protocol, cast

import typer

from beatrix_zenoh.cli.options import Connect, Json, Name, On, Who, finite
from beatrix_zenoh.cli.targets import Selection, open_targets
from beatrix_zenoh.client import subscription
from beatrix_zenoh.client.clocks import clock_offsets
from beatrix_zenoh.client.robot import Robot
from beatrix_zenoh.client.subscription import Arrival, Subscription
from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.errors import NoAnswer
from beatrix_zenoh.output import columns, print_json, say

TAKE_S = 0.5
PICTURES = 100
"""Length of the queue of a subscription to pictures."""
FEWEST = 3
"""Fewest publications for a standard deviation of their periods."""


class PeriodicStream(StrEnum):
    """A stream that a robot publishes at a constant rate."""

    POSITIONS = "positions"
    CAMERA_LEFT = "camera/left"
    CAMERA_RIGHT = "camera/right"
    CAMERA_OUTSIDE = "camera/outside"


class Numbered(Protocol):
    """A publication with a sequence number and a time stamp by the clock of its source."""

    @property
    def seq(self) -> int: ...
    @property
    def t_wall_ns(self) -> int: ...


class Rate(NamedTuple):
    """Figures of a stream: periods are between arrivals, ages from the robot's time stamp to the arrival."""

    messages: int
    hz: float
    period_sd_ms: float
    longest_ms: float
    age_ms: float
    lost: int | None
    """lost messages; None: unknown, because the sequence numbers decrease"""


def hz(
    stream: Annotated[
        PeriodicStream, typer.Argument(help="The stream to measure.")
    ] = PeriodicStream.POSITIONS,
    seconds: Annotated[
        float, typer.Option(min=0.2, callback=finite, help="Length of the measurement, seconds.")
    ] = 3.0,
    name: Name = None,
    connect: Connect = None,
    who: Who = None,
    on: On = None,
    as_json: Json = False,
) -> None:
    """Measure rate, jitter, age and losses of positions or pictures."""
    with open_targets(Selection(name, connect, who), on) as targets:
        robots = targets.robots()
        offsets = [clock_offsets(targets.client, *robot.place).wall.offset for robot in robots]
        subscriptions = [subscribe(robot, stream) for robot in robots]
        arrivals: list[list[Arrival[Numbered]]] = [[] for _ in robots]
        deadline = time.monotonic() + seconds
        while (left_s := deadline - time.monotonic()) > 0:
            time.sleep(min(left_s, TAKE_S))
            for found, subscription in zip(arrivals, subscriptions, strict=True):
                found.extend(subscription.take_arrivals())
    rates = {robot: rate(arrivals[i], offsets[i]) for i, robot in enumerate(robots)}
    if as_json:
        rows = [
            {"robot": robot.name, "side": robot.side, **found._asdict()} for robot, found in rates.items()
        ]
        print_json({"result": True, "robots": rows})
    else:
        show_rates(
            {str(robot): found for robot, found in rates.items()},
            "positions" if stream is PeriodicStream.POSITIONS else "pictures",
        )


def subscribe(robot: Robot, stream: PeriodicStream) -> Subscription[Numbered]:
    """Return a subscription to the stream of a robot."""
    if stream is PeriodicStream.POSITIONS:
        return cast("Subscription[Numbered]", robot.positions_stream())
    eye = stream.removeprefix("camera/")
    pictures = subscription.images(robot.client, *robot.place, eye, timeout_s=None, length=PICTURES)
    return cast("Subscription[Numbered]", pictures)


def rate(arrivals: Sequence[Arrival[Numbered]], offset_s: float) -> Rate:
    """Return the figures of one robot; `offset_s` is the robot's wall clock minus this computer's.

    Raises:
        NoAnswer: TIMED_OUT, fewer than three publications arrived.
    """
    if len(arrivals) < FEWEST:
        raise NoAnswer(
            Reason.TIMED_OUT,
            f"{len(arrivals)} messages arrived; at least {FEWEST} are needed. Measure for longer with --seconds.",
        )
    periods = [(b.t_mono_ns - a.t_mono_ns) / 1e6 for a, b in itertools.pairwise(arrivals)]
    ages = [(one.t_wall_ns - one.value.t_wall_ns) / 1e6 + offset_s * 1e3 for one in arrivals]
    steps = [b.value.seq - a.value.seq for a, b in itertools.pairwise(arrivals)]
    return Rate(
        messages=len(arrivals),
        hz=round(1e3 / statistics.fmean(periods), 2),
        period_sd_ms=round(statistics.pstdev(periods), 3),
        longest_ms=round(max(periods), 2),
        age_ms=round(statistics.median(ages), 3),
        lost=sum(steps) - len(steps) if min(steps) > 0 else None,
    )


def show_rates(rates: Mapping[str, Rate], what: str) -> None:
    """Print a table and the meaning of its columns."""
    heads = ("robot", f"{what}/s", "sd of period ms", "longest period ms", "age ms", "lost")
    rows = [
        (
            robot,
            f"{r.hz:.2f}",
            f"{r.period_sd_ms:.2f}",
            f"{r.longest_ms:.1f}",
            f"{r.age_ms:.2f}",
            "?" if r.lost is None else str(r.lost),
        )
        for robot, r in rates.items()
    ]
    say(columns(heads, rows))
    say("age: median time from the robot's time stamp to the arrival; lost: gaps in the sequence numbers")
    for robot in (robot for robot, r in rates.items() if r.lost is None):
        say(
            f"{robot}: the sequence numbers of its {what} decrease, so losses are unknown. The robot was restarted, or "
            "a second program publishes on its key: end that program."
        )
