"""Verbs that show robots: ls, status, info, top."""

from __future__ import annotations

import os
import time
from collections.abc import Sequence
from typing import Annotated

import typer
from msgspec import Struct

from beatrix_zenoh.account import today
from beatrix_zenoh.client.degrees import HeadAngles
from beatrix_zenoh.client.lease import pending
from beatrix_zenoh.client.monitor import Monitor, Presence, RobotState, Seats, SeatStops, stops_by_seat
from beatrix_zenoh.client.request import ask
from beatrix_zenoh.client.session import Client
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import Info
from beatrix_zenoh.contract.values import as_data, grouped
from beatrix_zenoh.output import STDOUT, columns, print_json, say
from beatrix_zenoh.settings import Settings, resolve
from beatrix_zenoh.terminal.options import Connect, Json, Name, On, Who
from beatrix_zenoh.terminal.states import (
    ListedRobot,
    look_up,
    problems,
    some,
    state,
    state_row,
    unlike_notes,
)
from beatrix_zenoh.terminal.targets import open_robots

VALUE_HEADS = ("group", "value", "now")
LIST_HEADS = ("robot", "side", "state", "driver", "version", "firmware")


def ls(connect: Connect = None, who: Who = None, as_json: Json = False) -> None:
    """List the robots online. Shows state, driver, warnings and versions."""
    with Client(resolve(None, connect, who)) as client:
        endpoint = client.bus.endpoint
        found = look_up(client)
    if as_json:
        print_json({"result": True, "endpoint": endpoint, "robots": [as_row(robot) for robot in found]})
    elif found:
        show(found)
    else:
        say(f"The router at {endpoint} answers, but no robot is online. Start a simulation: beatrix sim")


def show(found: list[ListedRobot]) -> None:
    """Print a table of robots, and their warnings below it."""
    rows = [
        (
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
    with open_robots(resolve(name, connect, who), on) as robots:
        found = [robot.status() for robot in robots]
    if as_json:
        print_json({"result": True, "robots": [state_row(status) for status in found]})
        return
    for one in found:
        say(f"{one.robot} ({one.side}): {state(one)}")
        show_values(one)


def show_values(message: Struct, groups: Sequence[str] = ()) -> None:
    """Print a table of the values of a message, or of some groups; the first value of a group begins with its name."""
    rows = [
        (group if one is members[0] else "", one.title, one.text())
        for group, members in grouped(message).items()
        if not groups or group in groups
        for one in members
    ]
    say(columns(VALUE_HEADS, rows))


def info(
    name: Name = None, connect: Connect = None, who: Who = None, on: On = None, as_json: Json = False
) -> None:
    """Show versions, limits, commands and keys. Programs in other languages need only this. Angles are in degrees."""
    with open_robots(resolve(name, connect, who), on) as robots:
        infos = [
            ask(robot.client, robot.place, keys.info(*robot.place), None, Info, robot.timeout_s)
            for robot in robots
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
REFRESH_S = 0.5
SEATS_SHOWN = 40
"""Largest number of seats in the line about seats."""


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
        monitor, seats = Monitor(client), Seats(client)
        if os.isatty(STDOUT) and not (once or as_json):
            live(client, monitor, seats)
        while True:
            time.sleep(TABLE_S)
            if as_json:
                robots = [as_dict(robot) for robot in online(monitor)]
                stops = [stops_as_dict(one) for one in stops_by_seat(monitor.robots())]
                print_json({"result": True, "robots": robots, "seats": seats.names(), "stops": stops})
            else:
                say(text(client, monitor, seats))
            if once or as_json:
                return
            say("")


def online(monitor: Monitor) -> list[RobotState]:
    """Return the states of all robots online now."""
    return [robot for robot in monitor.robots() if robot.presence is not Presence.ABSENT]


def state_of(robot: RobotState) -> str:
    """Return the state of a robot in one or two words."""
    return state(robot.status) if robot.status and robot.presence is Presence.ONLINE else "lost"


def head_of(robot: RobotState) -> HeadAngles | None:
    """Return the angles of the head; None: there are none, or they are out of date, because the board is lost."""
    gone = robot.status is not None and not robot.status.board.connected
    return None if robot.reading is None or gone else robot.reading.head


def problems_of(robot: RobotState) -> list[str]:
    """Return sentences about what is wrong with a robot."""
    if robot.positions_age_s and robot.presence is not Presence.ONLINE:
        return [f"no positions for {robot.positions_age_s:.1f} s"]
    return problems(robot.status)


def cells(settings: Settings, robot: RobotState) -> tuple[str, ...]:
    """Return the cells of the row of a robot."""
    head, age_s = head_of(robot), robot.positions_age_s
    angles = ("-", "-", "-") if head is None else tuple(f"{angle:z.1f}" for angle in head)
    silent = "-" if age_s is None else f"{age_s:.2f} s"
    driver = settings.shown(robot.status.holder) if robot.status else ""
    return (robot.robot, robot.side, state_of(robot), *angles, f"{robot.hz:.1f}", silent, driver or "-")


def decisions(client: Client) -> list[str]:
    """Return a line for each robot of the class that is not online and will get decisions of the teacher."""
    later = pending(client) if client.bus.connected else {}
    return [
        f"{robot} is not online. When it comes, the router of the class applies: {text}"
        for robot, text in later.items()
    ]


def messages(client: Client, robots: list[RobotState]) -> list[str]:
    """Return the lines below the table: the loss of the router, no robot, or the problems of the robots."""
    if not client.bus.connected:
        return [LOST.format(client.bus.endpoint)]
    account = client.settings.account
    expiring = account.renewal(today()) if account else ""
    found = [f"{robot.robot} ({robot.side}): {problem}" for robot in robots for problem in problems_of(robot)]
    statuses = {(robot.robot, robot.side): robot.status for robot in robots if robot.status}
    found += unlike_notes(statuses, account) if robots else [NO_ROBOT]
    return [*filter(None, [expiring]), *found, *decisions(client)]


def seat_lines(settings: Settings, monitor: Monitor, seats: Seats) -> list[str]:
    """Return a line with the seats that are connected to the router, and one with the seats that have sent STOP."""
    stops = [stop_words(settings, one) for one in stops_by_seat(monitor.robots())]
    lines = [f"seats: {some([settings.shown(seat) for seat in seats.names()], SEATS_SHOWN)}"]
    return [*lines, f"STOP pressed: {some(stops)}"] if stops else lines


def stop_words(settings: Settings, stops: SeatStops) -> str:
    """Return the STOPs of one seat as words: `ben 3 times (bea1 hw 2, bea2 hw 1)`."""
    robots = some([f"{robot} {side} {count}" for (robot, side), count in stops.robots.items()])
    times = "once" if stops.total == 1 else f"{stops.total} times"
    return f"{settings.shown(stops.seat) or 'an unknown seat'} {times} ({robots})"


def stops_as_dict(stops: SeatStops) -> dict[str, object]:
    """Return the STOPs of one seat for JSON output."""
    robots = [{"robot": robot, "side": side, "count": count} for (robot, side), count in stops.robots.items()]
    return {"seat": stops.seat, "count": stops.total, "robots": robots}


def text(client: Client, monitor: Monitor, seats: Seats) -> str:
    """Return the table and the lines below it."""
    robots = online(monitor)
    table = [columns(HEADS, [cells(client.settings, robot) for robot in robots])] if robots else []
    lines = seat_lines(client.settings, monitor, seats)
    return "\n".join([*table, *messages(client, robots), *lines])


def as_dict(robot: RobotState) -> dict[str, object]:
    """Return a row for JSON output."""
    head, age_s = head_of(robot), robot.positions_age_s
    return {
        **({} if robot.status is None else state_row(robot.status)),
        "robot": robot.robot,
        "side": robot.side,
        "state": state_of(robot),
        "head_deg": head and {axis: round(angle, 3) + 0.0 for axis, angle in head._asdict().items()},
        "hz": round(robot.hz, 2),
        "silent_s": None if age_s is None else round(age_s, 3),
        "driver": robot.status.holder if robot.status else "",
        "warnings": problems_of(robot),
    }


def live(client: Client, monitor: Monitor, seats: Seats) -> None:
    """Redraw the table until Ctrl-C."""
    from rich.live import Live
    from rich.text import Text

    with Live(auto_refresh=False, screen=True) as screen:
        while True:
            screen.update(Text(text(client, monitor, seats)), refresh=True)
            time.sleep(REFRESH_S)
