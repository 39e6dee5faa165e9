"""Verbs that show robots: ls, status, info, top."""

from __future__ import annotations

import itertools
import os
import time
from collections import Counter
from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated, NamedTuple

import typer
from msgspec import Struct

from beatrix_zenoh.account import Account, today
from beatrix_zenoh.client.degrees import HeadAngles
from beatrix_zenoh.client.lease import pending
from beatrix_zenoh.client.monitor import Monitor, Presence, RobotState, Seats, SeatStops, stops_by_seat
from beatrix_zenoh.client.request import ask
from beatrix_zenoh.client.session import Client, Place
from beatrix_zenoh.contract import printable
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import Info, Status
from beatrix_zenoh.contract.values import as_data, grouped
from beatrix_zenoh.output import STDOUT, columns, print_json, say
from beatrix_zenoh.settings import Settings, resolve
from beatrix_zenoh.terminal.options import Connect, Json, Name, On, Who
from beatrix_zenoh.terminal.states import (
    CELL,
    PROBLEM,
    ListedRobot,
    look_up,
    problems,
    short,
    some,
    state,
    state_row,
    unlike_notes,
)
from beatrix_zenoh.terminal.targets import Selection, open_targets

if TYPE_CHECKING:  # importing rich would delay every verb
    from rich.console import RenderableType

VALUE_HEADS = ("group", "value", "now")
LIST_HEADS = ("robot", "side", "state", "driver", "version", "firmware")


def ls(connect: Connect = None, who: Who = None, as_json: Json = False) -> None:
    """List the robots online. Shows state, driver, warnings and versions."""
    with Client(resolve(None, connect, who)) as client:
        endpoint = client.bus.endpoint
        found = look_up(client)
        nodes = Counter(client.bus.claims())
    if as_json:
        rows = [as_row(robot) | {"nodes": nodes[robot.place]} for robot in found]
        print_json({"result": True, "endpoint": endpoint, "robots": rows})
    elif found:
        show(found, client.settings.account)
        for robot in found:
            if (serving := nodes[robot.place]) > 1:
                say(
                    f"{robot}: {serving} nodes serve this robot and all of them execute its commands: end all but one."
                )
    else:
        say(f"The router at {endpoint} answers, but no robot is online. Start a simulation: beatrix sim")


def show(found: list[ListedRobot], account: Account | None) -> None:
    """Print a table of robots, and their warnings below it."""
    rows = [
        short(
            *robot.place,
            "does not answer" if robot.status is None else state(robot.status),
            "-" if robot.status is None else robot.status.holder or "-",
            "-" if robot.info is None else robot.info.version,
            "-" if robot.info is None else robot.info.firmware or "no board",
        )
        for robot in found
    ]
    say(columns(LIST_HEADS, rows))
    for robot in found:
        for problem in problems(robot.status):
            say(f"{robot}: {problem}")
    for line in unlike_notes({robot.place: robot.status for robot in found if robot.status}, account):
        say(line)


def as_row(robot: ListedRobot) -> dict[str, object]:
    """Return a robot for JSON output."""
    name, side = robot.place
    row: dict[str, object] = {"robot": name, "side": side, "answers": robot.status is not None}
    if robot.status is not None:
        row |= state_row(robot.status)
    if robot.info is not None:
        row |= {name: getattr(robot.info, name) for name in ("version", "contract", "firmware")}
    return row


def status(
    name: Name = None, connect: Connect = None, who: Who = None, on: On = None, as_json: Json = False
) -> None:
    """Show all values of a robot, in groups. Angles are in degrees."""
    with open_targets(Selection(name, connect, who), on) as targets:
        found = [robot.status() for robot in targets.robots()]
    if as_json:
        print_json({"result": True, "robots": [state_row(status) for status in found]})
        return
    for one in found:
        say(f"{one.robot} ({one.side}): {state(one)}")
        show_values(one)


def show_values(message: Struct, groups: Sequence[str] = ()) -> None:
    """Print a table of the values of a message, or of some groups; the first value of a group begins with its name."""
    rows = [
        (
            printable.line(group, CELL) if one is members[0] else "",
            one.title,
            printable.line(one.text(), PROBLEM),
        )
        for group, members in grouped(message).items()
        if not groups or group in groups
        for one in members
    ]
    say(columns(VALUE_HEADS, rows))


def info(
    name: Name = None, connect: Connect = None, who: Who = None, on: On = None, as_json: Json = False
) -> None:
    """Show versions, limits, commands and keys. Programs in other languages need only this. Angles are in degrees."""
    with open_targets(Selection(name, connect, who), on) as targets:
        infos = [
            ask(robot.client, robot.place, keys.info(*robot.place), None, Info, robot.timeout_s)
            for robot in targets.robots()
        ]
    if as_json:
        print_json({"result": True, "robots": [as_data(info) for info in infos]})
        return
    for one in infos:
        show_values(one, ("robot", "limits", "geometry"))
        say("\ncommands:\n  " + "\n  ".join(one.commands))
        say("\n" + columns(("key", "kind", "purpose"), [(row.key, row.kind, row.doc_) for row in one.keys]))
        say("\nexamples, for any Zenoh program (rad):\n  " + "\n  ".join(one.examples))


NO_ROBOT = "No robot is online. Start a simulation: beatrix sim"
LOST = "The router at {} is lost, or this computer has lost the network. The table returns when the router answers."
HEADS = ("robot", "side", "state", "yaw°", "pitch°", "roll°", "per s", "silent", "driver")
TABLE_S = 1.2
"""Time for which `--once` and `--json` collect data before they print, and the period of the tables in a pipe (s)."""
REFRESH_S = 0.2
DECISIONS_EVERY = 5
"""Refreshes from one question about pending decisions to the next: a query each second is enough."""
SEATS_SHOWN = 40
"""Largest number of seats in the line about seats."""
STOPS_SHOWN = 8
"""Largest number of seats in the line about STOPs."""


class TableRow(NamedTuple):
    """The data of one robot in the table."""

    place: Place
    state: str
    head: HeadAngles | None
    hz: float
    silent_s: float | None
    driver: str
    status: Status | None
    problems: list[str]


def top(
    once: Annotated[bool, typer.Option("--once", help="Print one table and exit.")] = False,
    connect: Connect = None,
    who: Who = None,
    as_json: Json = False,
) -> None:
    """Show robots and seats live: angles, rates and drivers.

    The angles are those of the head (degrees). Ctrl-C ends the table.
    """
    with Client(resolve(None, connect, who)) as client:
        monitor = Monitor(client)
        seats = Seats(client)
        if once or as_json:
            time.sleep(TABLE_S)
            rows = rows_of(monitor)
            if as_json:
                robots = [as_dict(row) for row in rows]
                stops = [stops_as_dict(one) for one in stops_by_seat(monitor.robots())]
                print_json({"result": True, "robots": robots, "seats": seats.names(), "stops": stops})
            else:
                say(text(client, rows, seat_lines(client.settings, monitor, seats)))
        elif os.isatty(STDOUT):
            live(client, monitor, seats)
        else:
            print_tables(client, monitor, seats)


def rows_of(monitor: Monitor) -> list[TableRow]:
    """Return the rows of all robots online now."""
    return [row_of(robot) for robot in monitor.robots() if robot.presence is not Presence.ABSENT]


def row_of(robot: RobotState) -> TableRow:
    """Return the row of one robot."""
    status, reading, silent = robot.status, robot.reading, robot.positions_age_s
    gone = status is not None and not status.board.connected  # then the angles are out of date
    lost = robot.presence is not Presence.ONLINE
    return TableRow(
        place=(robot.robot, robot.side),
        state="lost" if lost or status is None else state(status),
        head=None if reading is None or gone else reading.head,
        hz=robot.hz,
        silent_s=silent,
        driver="" if status is None else status.holder,
        status=status,
        problems=[f"no positions for {silent:.1f} s"] if silent and lost else problems(status),
    )


def cells(settings: Settings, row: TableRow) -> tuple[str, ...]:
    """Return the cells of a row as text."""
    head = ("-", "-", "-") if row.head is None else tuple(f"{angle:z.1f}" for angle in row.head)
    silent = "-" if row.silent_s is None else f"{row.silent_s:.2f} s"
    return short(*row.place, row.state, *head, f"{row.hz:.1f}", silent, settings.shown(row.driver) or "-")


def notes(rows: list[TableRow], account: Account | None) -> list[str]:
    """Return the problems of all robots, and the decisions of the teacher that some lack, a line each."""
    found = [f"{row.place[0]} ({row.place[1]}): {problem}" for row in rows for problem in row.problems]
    return found + unlike_notes({row.place: row.status for row in rows if row.status}, account)


def decisions(client: Client) -> list[str]:
    """Return a line for each robot of the class that is not online and will get decisions of the teacher."""
    later = pending(client) if client.bus.connected else {}
    return [
        f"{robot} is not online. When it comes, the router of the class applies: {text}"
        for robot, text in later.items()
    ]


def messages(client: Client, rows: list[TableRow], later: list[str]) -> list[str]:
    """Return the lines below the table: the loss of the router, no robot, or the problems of the robots, then `later`."""
    if not client.bus.connected:
        return [LOST.format(client.bus.endpoint)]
    account = client.settings.account
    expiring = account.renewal(today()) if account else ""
    return [*([expiring] if expiring else []), *(notes(rows, account) if rows else [NO_ROBOT]), *later]


def seat_lines(settings: Settings, monitor: Monitor, seats: Seats) -> list[str]:
    """Return a line with the seats that are connected to the router, and one with the seats that have sent STOP."""
    lines = [f"seats: {some([settings.shown(seat) for seat in seats.names()], SEATS_SHOWN)}"]
    stops = stops_by_seat(monitor.robots())
    if stops:
        words = [stop_words(settings, one) for one in stops[:STOPS_SHOWN]]
        more = [f"{len(stops) - STOPS_SHOWN} more seats"] if len(stops) > STOPS_SHOWN else []
        lines.append(f"STOP pressed: {', '.join([*words, *more])}")
    return lines


def stop_words(settings: Settings, stops: SeatStops) -> str:
    """Return the STOPs of one seat as words: `ben 3 times (bea1 hw 2, bea2 hw 1)`."""
    robots = some([f"{robot} {side} {count}" for (robot, side), count in stops.robots.items()])
    times = "once" if stops.total == 1 else f"{stops.total} times"
    return f"{settings.shown(stops.seat) or 'an unknown seat'} {times} ({robots})"


def stops_as_dict(stops: SeatStops) -> dict[str, object]:
    """Return the STOPs of one seat for JSON output."""
    robots = [{"robot": robot, "side": side, "count": count} for (robot, side), count in stops.robots.items()]
    return {"seat": stops.seat, "count": stops.total, "robots": robots}


def text(client: Client, rows: list[TableRow], seats: list[str]) -> str:
    """Return the table and the lines below it as text, for a pipe."""
    table = [columns(HEADS, [cells(client.settings, row) for row in rows])] if rows else []
    return "\n".join([*table, *messages(client, rows, decisions(client)), *seats])


def as_dict(row: TableRow) -> dict[str, object]:
    """Return a row for JSON output."""
    return {
        **({} if row.status is None else state_row(row.status)),
        "robot": row.place[0],
        "side": row.place[1],
        "state": row.state,
        "head_deg": None
        if row.head is None
        else {axis: round(angle, 3) + 0.0 for axis, angle in row.head._asdict().items()},
        "hz": round(row.hz, 2),
        "silent_s": None if row.silent_s is None else round(row.silent_s, 3),
        "driver": row.driver,
        "warnings": row.problems,
    }


def print_tables(client: Client, monitor: Monitor, seats: Seats) -> None:
    """Print table after table until Ctrl-C, or until the reader closes the pipe."""
    while True:
        time.sleep(TABLE_S)
        say(f"{text(client, rows_of(monitor), seat_lines(client.settings, monitor, seats))}\n")


def live(client: Client, monitor: Monitor, seats: Seats) -> None:
    """Redraw the table until Ctrl-C."""
    from rich.live import Live

    later: list[str] = []
    with Live(auto_refresh=False, screen=True) as screen:
        for refresh in itertools.count():
            later = later if refresh % DECISIONS_EVERY else decisions(client)
            lines = seat_lines(client.settings, monitor, seats)
            screen.update(screen_table(client, rows_of(monitor), lines, later), refresh=True)
            time.sleep(REFRESH_S)


def screen_table(client: Client, rows: list[TableRow], seats: list[str], later: list[str]) -> RenderableType:
    """Return the table with colours and the lines below it, for a terminal."""
    from rich.console import Group
    from rich.table import Table
    from rich.text import Text

    table = Table(
        title=f"BEATRIX robots at {client.bus.endpoint}", box=None, pad_edge=False, title_justify="left"
    )
    for index, head in enumerate(HEADS):
        table.add_column(head, justify="right" if 3 <= index <= 7 else "left")
    for row in rows:
        table.add_row(*cells(client.settings, row), style=colour(row))
    last = "silent: time since the last positions of the robot. Ctrl-C ends."
    foot = Text("\n".join(["", *seats, last]), style="dim")
    return Group(table, *(Text(line, style="yellow") for line in messages(client, rows, later)), foot)


def colour(row: TableRow) -> str:
    """Return the colour of a row: green if the robot may move, red if it is lost or has a fault, otherwise yellow."""
    if row.state in ("ready", "moving"):
        return "green"
    return "red" if row.state == "lost" or row.state.startswith("fault") else "yellow"
