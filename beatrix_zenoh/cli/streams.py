"""Verbs that listen: echo and hz."""

from __future__ import annotations

import itertools
import queue
import statistics
import time
from collections.abc import Callable, Mapping, Sequence
from enum import StrEnum
from typing import Annotated, NamedTuple

import typer

from beatrix_zenoh import codec
from beatrix_zenoh._generated import keys
from beatrix_zenoh._generated.messages import Positions, Reason, Status
from beatrix_zenoh.cli.clocks import clock_offset
from beatrix_zenoh.cli.line import Line, Where, on_line
from beatrix_zenoh.cli.listing import state, state_row, troubles
from beatrix_zenoh.cli.motions import where
from beatrix_zenoh.cli.options import Connect, Json, Name, On, Who
from beatrix_zenoh.cli.table import columns
from beatrix_zenoh.cli.verb import document, say
from beatrix_zenoh.errors import NoAnswer
from beatrix_zenoh.readings import reading
from beatrix_zenoh.robot import Robot

SILENCE_S = 3.0
"""Status comes once a second, positions 50 times: after this long nothing will."""


class Stream(StrEnum):
    """What a robot publishes."""

    POSITIONS = "positions"
    STATUS = "status"


class Arrival(NamedTuple):
    """A publication and when it came: monotonic and wall clock, ns."""

    robot: Robot
    mono_ns: int
    wall_ns: int
    payload: bytes


class Listener:
    """Publications of the robots chosen, as they come."""

    def __init__(self, line: Line, stream: Stream) -> None:
        """Begin to listen; raises NoAnswer, with a sentence, for a robot that is not there."""
        self._arrivals: queue.SimpleQueue[Arrival] = queue.SimpleQueue()
        self.robots = line.robots()
        key_of = keys.positions if stream is Stream.POSITIONS else keys.status
        for robot in self.robots:
            robot.status()
            line.client.bus.subscribe(key_of(robot.name, robot.twin), self._receiver(robot))

    def _receiver(self, robot: Robot) -> Callable[[str, bytes], None]:
        def receive(_key: str, payload: bytes) -> None:
            self._arrivals.put(Arrival(robot, time.monotonic_ns(), time.time_ns(), payload))

        return receive

    def next(self, timeout_s: float = SILENCE_S) -> Arrival:
        """The next publication.

        Raises:
            NoAnswer: TIMED_OUT.
        """
        try:
            return self._arrivals.get(timeout=timeout_s)
        except queue.Empty:
            names = " and ".join(map(str, self.robots))
            raise NoAnswer(
                Reason.TIMED_OUT, f"{names}: nothing for {timeout_s:.0f} s. It is frozen, or has gone."
            ) from None


def echo(
    stream: Annotated[Stream, typer.Argument(help="What to show.")] = Stream.POSITIONS,
    count: Annotated[int, typer.Option(min=0, help="End after so many; 0: with Ctrl-C.")] = 0,
    name: Name = None,
    connect: Connect = None,
    who: Who = None,
    on: On = None,
    as_json: Annotated[bool, typer.Option("--json", help="One JSON document a line.")] = False,
) -> None:
    """Show positions or status as they come. Degrees; ends with Ctrl-C or --count."""
    with on_line(Where(name, connect, who), on) as line:
        listener = Listener(line, stream)
        for _ in range(count) if count else itertools.count():
            arrival = listener.next()
            show = show_positions if stream is Stream.POSITIONS else show_status
            show(arrival, as_json=as_json)


def show_positions(arrival: Arrival, *, as_json: bool) -> None:
    """One line of positions; `t_s` is the robot's monotonic clock."""
    positions = codec.decode(arrival.payload, Positions)
    now = reading(positions)
    if as_json:
        document({**where(arrival.robot, now), "seq": positions.seq, "t_s": round(now.t, 6)})
    else:
        say(f"{arrival.robot}  {now}")


def show_status(arrival: Arrival, *, as_json: bool) -> None:
    """One line of status."""
    status = codec.decode(arrival.payload, Status)
    if as_json:
        document({"robot": status.robot, "on": status.twin, **state_row(status)})
    else:
        words = [state(status), f"driver {status.holder or 'nobody'}", *troubles(status)]
        say(f"{arrival.robot}  {'; '.join(words)}")


class Rate(NamedTuple):
    """How regularly positions come: periods as they arrived, age since the robot looked."""

    messages: int
    hz: float
    period_sd_ms: float
    longest_ms: float
    age_ms: float
    lost: int


def hz(
    seconds: Annotated[float, typer.Option(min=0.2, help="How long to count.")] = 3.0,
    name: Name = None,
    connect: Connect = None,
    who: Who = None,
    on: On = None,
    as_json: Json = False,
) -> None:
    """Measure how regularly positions come. Rate, jitter, age and losses."""
    with on_line(Where(name, connect, who), on) as line:
        offsets = {robot.twin: clock_offset(robot).offset for robot in line.robots()}
        listener = Listener(line, Stream.POSITIONS)
        arrivals: dict[str, list[Arrival]] = {robot.twin: [] for robot in listener.robots}
        deadline = time.monotonic() + seconds
        while time.monotonic() < deadline:
            arrival = listener.next()
            arrivals[arrival.robot.twin].append(arrival)
    rates = {robot: rate(arrivals[robot.twin], offsets[robot.twin]) for robot in listener.robots}
    if as_json:
        rows = [{"robot": robot.name, "on": robot.twin, **found._asdict()} for robot, found in rates.items()]
        document({"result": True, "robots": rows})
    else:
        show_rates(rates)


def rate(arrivals: Sequence[Arrival], offset_s: float) -> Rate:
    """Figures of one robot; `offset_s` is its wall clock minus ours.

    Raises:
        NoAnswer: TIMED_OUT, fewer than three publications came.
    """
    if len(arrivals) < 3:
        raise NoAnswer(Reason.TIMED_OUT, f"Only {len(arrivals)} positions came: count longer (--seconds).")
    positions = [codec.decode(arrival.payload, Positions) for arrival in arrivals]
    periods = [(b.mono_ns - a.mono_ns) / 1e6 for a, b in itertools.pairwise(arrivals)]
    ages = [
        (arrival.wall_ns - sent.t_wall_ns) / 1e6 + offset_s * 1e3
        for arrival, sent in zip(arrivals, positions, strict=True)
    ]
    steps = positions[-1].seq - positions[0].seq
    return Rate(
        messages=len(arrivals),
        hz=round(1e3 / statistics.fmean(periods), 2),
        period_sd_ms=round(statistics.pstdev(periods), 3),
        longest_ms=round(max(periods), 2),
        age_ms=round(statistics.median(ages), 3),
        lost=steps - (len(arrivals) - 1),
    )


def show_rates(rates: Mapping[Robot, Rate]) -> None:
    """A table, and what its columns mean."""
    heads = ("robot", "positions/s", "sd of period ms", "longest period ms", "age ms", "lost")
    rows = [
        (
            str(robot),
            f"{r.hz:.2f}",
            f"{r.period_sd_ms:.2f}",
            f"{r.longest_ms:.1f}",
            f"{r.age_ms:.2f}",
            str(r.lost),
        )
        for robot, r in rates.items()
    ]
    say(columns(heads, rows))
    say("age: median time from the robot's reading to here; lost: gaps in its numbering")
