"""`beatrix top`: all robots at a glance, live."""

from __future__ import annotations

import os
import threading
import time
from collections import deque
from typing import TYPE_CHECKING, Annotated, NamedTuple

import typer

from beatrix_zenoh import codec
from beatrix_zenoh._generated import keys
from beatrix_zenoh._generated.messages import Positions, Status
from beatrix_zenoh.bus import Bus
from beatrix_zenoh.cli.listing import Place, state, states, troubles
from beatrix_zenoh.cli.options import Connect, Json, Who
from beatrix_zenoh.cli.table import columns
from beatrix_zenoh.cli.verb import STDOUT, document, say
from beatrix_zenoh.client import Client
from beatrix_zenoh.readings import HeadAngles, head_angles
from beatrix_zenoh.settings import resolve

if TYPE_CHECKING:
    from rich.console import RenderableType

HEADS = ("robot", "on", "state", "yaw°", "pitch°", "roll°", "per s", "silent", "driver")
WINDOW = 50
"""Positions over which the rate is taken: one second."""
LOOK_S = 1.2
"""How long `--once` listens before it tells; into a pipe a table comes as often."""
REFRESH_S = 0.2
SILENT_S = 0.5
"""No positions for this long: lost, whatever its token says (positions come every 20 ms)."""


class Row(NamedTuple):
    """One robot at one moment."""

    place: Place
    state: str
    head: HeadAngles | None
    hz: float
    silent_s: float | None
    driver: str
    troubles: list[str]


class Watch:
    """What robots publish, remembered; written on Zenoh's thread, read here."""

    def __init__(self, bus: Bus) -> None:
        self._bus = bus
        self._lock = threading.Lock()
        self._positions: dict[Place, bytes] = {}
        self._times: dict[Place, deque[float]] = {}
        self._alive: set[Place] = set()
        self._status: dict[Place, Status] = states(bus)
        bus.subscribe(keys.positions("*", "*"), self._on_positions)
        bus.subscribe(keys.status("*", "*"), self._on_status)
        bus.watch(keys.alive("*", "*"), self._on_token)

    def _on_positions(self, key: str, payload: bytes) -> None:
        with self._lock:
            self._positions[place(key)] = payload
            self._times.setdefault(place(key), deque(maxlen=WINDOW)).append(time.monotonic())

    def _on_status(self, key: str, payload: bytes) -> None:
        status = codec.decode(payload, Status)
        with self._lock:
            self._status[place(key)] = status

    def _on_token(self, key: str, alive: bool) -> None:
        with self._lock:
            if alive:
                self._alive.add(place(key))
                return
            for table in (self._positions, self._times, self._status):
                table.pop(place(key), None)
            self._alive.discard(place(key))

    def rows(self) -> list[Row]:
        """All robots now."""
        now = time.monotonic()
        with self._lock:
            return [self._row(at, now) for at in sorted(self._alive, key=lambda at: (at[0], at[1] != "sim"))]

    def _row(self, at: Place, now: float) -> Row:
        status, times, payload = self._status.get(at), self._times.get(at), self._positions.get(at)
        gone = status is not None and not status.board.connected  # then the angles are those of before
        head = None if payload is None or gone else head_angles(codec.decode(payload, Positions).head)
        recent = [moment for moment in times or () if now - moment < 1.0]
        span = recent[-1] - recent[0] if len(recent) > 1 else 0.0
        silent = now - times[-1] if times else None
        lost = silent is None or silent > SILENT_S
        return Row(
            place=at,
            state="lost" if lost or status is None else state(status),
            head=head,
            hz=(len(recent) - 1) / span if span else 0.0,
            silent_s=silent,
            driver="" if status is None else status.holder,
            troubles=[f"no positions for {silent:.1f} s"] if silent and lost else troubles(status),
        )


def top(
    once: Annotated[bool, typer.Option("--once", help="Print one table and end.")] = False,
    connect: Connect = None,
    who: Who = None,
    as_json: Json = False,
) -> None:
    """Watch all robots live. State, head (degrees), rate, who drives; ends with Ctrl-C."""
    with Client(resolve(None, connect, who)) as client:
        watch = Watch(client.bus)
        if once or as_json:
            time.sleep(LOOK_S)
            rows = watch.rows()
            if as_json:
                document({"result": True, "robots": [as_dict(row) for row in rows]})
            else:
                say(text(rows))
        elif os.isatty(STDOUT):
            live(watch, client.bus.endpoint)
        else:
            roll(watch)


def place(key: str) -> Place:
    """Name and twin in a key."""
    _, name, twin, *_ = key.split("/")
    return name, twin


def cells(row: Row) -> tuple[str, ...]:
    """A row as text."""
    head = ("-", "-", "-") if row.head is None else tuple(f"{angle:z.1f}" for angle in row.head)
    silent = "-" if row.silent_s is None else f"{row.silent_s:.2f} s"
    return (*row.place, row.state, *head, f"{row.hz:.1f}", silent, row.driver or "nobody")


def notes(rows: list[Row]) -> list[str]:
    """What a person should know, a line each."""
    return [f"{row.place[0]} ({row.place[1]}): {trouble}" for row in rows for trouble in row.troubles]


def text(rows: list[Row]) -> str:
    """The table for a pipe."""
    if not rows:
        return "No robot is on line. Start a simulation: beatrix sim"
    return "\n".join([columns(HEADS, [cells(row) for row in rows]), *notes(rows)])


def as_dict(row: Row) -> dict[str, object]:
    """A row for JSON."""
    return {
        "robot": row.place[0],
        "on": row.place[1],
        "state": row.state,
        "head_deg": None
        if row.head is None
        else {axis: round(angle, 3) + 0.0 for axis, angle in row.head._asdict().items()},
        "hz": round(row.hz, 2),
        "silent_s": None if row.silent_s is None else round(row.silent_s, 3),
        "driver": row.driver,
        "warnings": row.troubles,
    }


def roll(watch: Watch) -> None:
    """Print table after table until Ctrl-C, or until nobody reads them."""
    while True:
        time.sleep(LOOK_S)
        say(f"{text(watch.rows())}\n")


def live(watch: Watch, endpoint: str) -> None:
    """Redraw the table until Ctrl-C."""
    from rich.live import Live

    with Live(picture(watch.rows(), endpoint), auto_refresh=False, screen=True) as screen:
        while True:
            time.sleep(REFRESH_S)
            screen.update(picture(watch.rows(), endpoint), refresh=True)


def picture(rows: list[Row], endpoint: str) -> RenderableType:
    """The table for a screen."""
    from rich.console import Group
    from rich.table import Table
    from rich.text import Text

    table = Table(title=f"BEATRIX robots at {endpoint}", box=None, pad_edge=False, title_justify="left")
    for index, head in enumerate(HEADS):
        table.add_column(head, justify="right" if 3 <= index <= 7 else "left")
    for row in rows:
        table.add_row(*cells(row), style=colour(row))
    lines = notes(rows) if rows else ["No robot is on line. Start a simulation: beatrix sim"]
    foot = Text("\nsilent: time since its last positions. Ctrl-C ends.", style="dim")
    return Group(table, *(Text(line, style="yellow") for line in lines), foot)


def colour(row: Row) -> str:
    """Green may move, red does not answer or reports a fault, yellow needs something first."""
    if row.state in ("ready", "moving"):
        return "green"
    return "red" if row.state == "lost" or row.state.startswith("fault") else "yellow"
