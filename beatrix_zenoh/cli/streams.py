"""Verbs that show what a robot publishes: echo prints it, hz measures its rate."""

from __future__ import annotations

import itertools
import re
import statistics
import time
from collections.abc import Mapping, Sequence
from enum import StrEnum
from typing import Annotated, NamedTuple, Protocol, TypeVar, cast

import msgspec
import typer

from beatrix_zenoh.client.degrees import reading
from beatrix_zenoh.client.robot_base import clock_offsets
from beatrix_zenoh.client.session import Client, Place
from beatrix_zenoh.client.subscription import (
    FIRST_PICTURE_S,
    SILENCE_S,
    Arrival,
    CameraImage,
    Reader,
    Subscription,
    images,
    message,
    same,
)
from beatrix_zenoh.contract import names
from beatrix_zenoh.contract._generated import keys, messages
from beatrix_zenoh.contract._generated.messages import Event, Positions, Reason, Status
from beatrix_zenoh.contract.errors import NoAnswer
from beatrix_zenoh.contract.rows import KeyRow
from beatrix_zenoh.contract.sentences.events import sentence
from beatrix_zenoh.contract.values import as_data, values
from beatrix_zenoh.output import columns, print_json, say
from beatrix_zenoh.settings import resolve
from beatrix_zenoh.terminal.options import Connect, Json, Name, On, Who, finite
from beatrix_zenoh.terminal.states import problems, state, state_row
from beatrix_zenoh.terminal.targets import degrees, open_robots

T = TypeVar("T")
BASE = "beatrix/{robot}/{side}/state/"
CAMERA = "camera/"
QUEUE = 100
"""Length of the queue for pictures."""
PAST = 10
"""Number of past events that are printed first, without --count."""


def streams() -> dict[str, KeyRow]:
    """Return the publications of a robot by name, such as `positions` or `camera/left`, without those in JSON."""
    found = {row.key.removeprefix(BASE): row for row in keys.KEYS.values() if row.key.startswith(BASE)}
    return {
        name.replace("{eye}", view): row
        for name, row in found.items()
        for view in (names.VIEWS if "{eye}" in name else names.VIEWS[:1])
        if not name.endswith("/json")
    }


def periodic() -> list[str]:
    """Return the names of the streams whose rate and losses can be measured: with numbers, at a constant rate or media."""
    return [
        name
        for name, row in streams().items()
        if (row.rate_hz or row.publish == "media") and "seq" in header(row).__struct_fields__
    ]


def header(row: KeyRow) -> type[msgspec.Struct]:
    """Return the message of a stream, or the one in the attachment of its bytes."""
    kinds = (getattr(messages, word, None) for word in re.findall(r"\w+", row.payload))
    return next(kind for kind in kinds if isinstance(kind, type) and issubclass(kind, msgspec.Struct))


def subscribe(client: Client, name: str, robot: str, side: str) -> Subscription[object]:
    """Subscribe to the messages of a stream: to pictures with their data, to sound by its headers alone.

    Raises the errors of `images`.
    """
    if name.startswith(CAMERA):
        eye = name.removeprefix(CAMERA)
        pictures = images(client, robot, side, eye, timeout_s=FIRST_PICTURE_S, length=QUEUE)
        return cast("Subscription[object]", pictures)
    row = streams()[name]
    kind, media = header(row), row.publish == "media"
    plain = row.payload == kind.__name__
    read: Reader[object] = (
        message(kind, same) if plain else lambda _, received: client.read(received.header, kind)
    )
    key = row.key.format(robot=robot, side=side)
    timeout_s, bus = (
        (FIRST_PICTURE_S, client.media) if media else (None if name == EVENTS else SILENCE_S, None)
    )
    return Subscription(client, key, read, timeout_s=timeout_s, bus=bus)


Stream = StrEnum("Stream", {name: name for name in streams()})  # type: ignore[misc] # follows from the contract
"""What `beatrix echo` prints."""
PeriodicStream = StrEnum("PeriodicStream", {name: name for name in periodic()})  # type: ignore[misc]
"""What `beatrix hz` measures."""
POSITIONS, EVENTS = "positions", "events"


def echo(
    stream: Annotated[Stream, typer.Argument(help="The stream to print.")] = Stream(POSITIONS),
    count: Annotated[int, typer.Option(min=0, help="End after this many lines; 0: run until Ctrl-C.")] = 0,
    name: Name = None,
    connect: Connect = None,
    who: Who = None,
    on: On = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON document a line.")] = False,
) -> None:
    """Print positions, status, events and more as they arrive. Angles are in degrees. Ends with Ctrl-C or --count.

    Events are requests, refusals, STOPs, changes of driver and board, and warnings. Without --on, events of both
    simulation and robot are printed. The last ten events, or --count of them, come first. For a picture the number,
    size and source are printed, for sound the header of each block.
    """
    with open_robots(resolve(name, connect, who), on, both=stream == EVENTS) as robots:
        for robot in robots:
            robot.status()  # raises NoAnswer for a robot that is not online
        first = robots[0]
        side = first.side if len(robots) == 1 else "*"
        arrivals = subscribe(first.client, stream.value, first.name, side).arrivals()
        past: list[tuple[Place, object]] = []
        if stream == EVENTS:
            events = [(robot.place, event) for robot in robots for event in robot.past_events()]
            past += sorted(events, key=lambda row: row[1].t_wall_ns)[-(count or PAST) :]
        known = [event for _, event in past]  # one that is published during the query arrives twice
        coming = (((one.robot, one.side), one.value) for one in arrivals if one.value not in known)
        for place, value in itertools.islice(itertools.chain(past, coming), count or None):
            show(place, value, as_json=as_json)


def show(place: Place, value: object, *, as_json: bool) -> None:
    """Print a message on one line: events, positions, status, pictures in words of their own, others as their values."""
    data: Mapping[str, object]
    robot = "{} ({})".format(*place)
    match value:
        case Event() as event:  # as data its angles are in rad
            words, data = event_line(place, event), msgspec.to_builtins(event)
        case Positions() as positions:
            now = reading(positions)
            words, data = f"{robot}  {now}", {**degrees(now), "seq": positions.seq, "t_s": round(now.t, 6)}
        case Status() as status:
            words = f"{robot}  " + "; ".join(
                [state(status), f"driver {status.holder or '-'}", *problems(status)]
            )
            data = state_row(status)
        case CameraImage() as image:
            fields = msgspec.structs.asdict(image)
            header = {name: value for name, value in fields.items() if name != "jpeg"}
            words, data = f"{robot}  {image}", {**header, "bytes": len(image.jpeg)}
        case msgspec.Struct() as message:
            words = f"{robot}  " + ", ".join(f"{one.title} {one.text()}" for one in values(message))
            data = as_data(message)
        case _:
            return
    if as_json:
        print_json({"robot": place[0], "side": place[1], **data})
    else:
        say(words)


def event_line(place: Place, event: Event) -> str:
    """Return an event as a line: time by the robot's clock, robot, and the event as a sentence."""
    clock = time.strftime("%H:%M:%S", time.localtime(event.t_wall_ns / 1e9))
    milliseconds = event.t_wall_ns // 1_000_000 % 1000
    return f"{clock}.{milliseconds:03d}  {place[0]} ({place[1]})  {sentence(event)}"


TAKE_S = 0.5
FEWEST = 3
"""Fewest publications for a standard deviation of their periods."""


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
    stream: Annotated[PeriodicStream, typer.Argument(help="The stream to measure.")] = PeriodicStream(
        POSITIONS
    ),
    seconds: Annotated[
        float, typer.Option(min=0.2, callback=finite, help="Length of the measurement, seconds.")
    ] = 3.0,
    name: Name = None,
    connect: Connect = None,
    who: Who = None,
    on: On = None,
    as_json: Json = False,
) -> None:
    """Measure rate, jitter, age and losses of a stream."""
    with open_robots(resolve(name, connect, who), on) as robots:
        offsets = [clock_offsets(robot.client, *robot.place).wall.offset for robot in robots]
        subscriptions = [
            cast("Subscription[Numbered]", subscribe(robot.client, stream.value, *robot.place))
            for robot in robots
        ]
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
        show_rates({str(robot): found for robot, found in rates.items()})


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


def show_rates(rates: Mapping[str, Rate]) -> None:
    """Print a table and the meaning of its columns."""
    rows = [
        (robot, *("?" if value is None else str(value) for value in found)) for robot, found in rates.items()
    ]
    say(columns(("robot", *Rate._fields), rows))
    say("age: median time from the robot's time stamp to the arrival; lost: gaps in the sequence numbers")
    if any(found.lost is None for found in rates.values()):
        say(
            "lost ?: the sequence numbers decrease, so losses are unknown. The robot was restarted, or a second program "
            "publishes on its key: end that program."
        )
