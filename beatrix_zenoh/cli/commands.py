"""Verbs that change the state of a robot, or which seat may move it: lease; freeze, limit and mute for the teacher."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Sequence
from contextlib import nullcontext
from enum import StrEnum
from typing import Annotated

import typer

from beatrix_zenoh.client import lease as leases
from beatrix_zenoh.client.lease import govern, of_seat, pending, refused
from beatrix_zenoh.client.request import RETURN_S, title
from beatrix_zenoh.client.robot import Robot
from beatrix_zenoh.client.session import Client, Place
from beatrix_zenoh.client.twin_state import check_seat
from beatrix_zenoh.contract import names
from beatrix_zenoh.contract._generated.messages import (
    Command,
    CommandReply,
    LeaseAction,
    LeaseQuery,
    LeaseReply,
    Reason,
)
from beatrix_zenoh.contract.errors import BeatrixError, NoAnswer, Refused, naming, wrong_usage
from beatrix_zenoh.output import exit_code, note, print_json, say
from beatrix_zenoh.settings import Settings, resolve
from beatrix_zenoh.terminal.options import Connect, Json, Name, Names, On, Wait, Which, Who
from beatrix_zenoh.terminal.states import some
from beatrix_zenoh.terminal.targets import open_robots


def enable(
    name: Name = None, connect: Connect = None, who: Who = None, on: On = None, as_json: Json = False
) -> None:
    """Switch the motors on. Calibrate afterwards; after an emergency stop reset first."""
    command(resolve(name, connect, who), on, Command.ENABLE, as_json=as_json)


def disable(
    name: Name = None, connect: Connect = None, who: Who = None, on: On = None, as_json: Json = False
) -> None:
    """Switch the motors off. The head may sink, and the robot must be calibrated again."""
    command(resolve(name, connect, who), on, Command.ENABLE, value=False, as_json=as_json)


def calibrate(
    name: Name = None, connect: Connect = None, who: Who = None, on: On = None, as_json: Json = False
) -> None:
    """Declare the present position home. Set the head upright and straight ahead first."""
    command(resolve(name, connect, who), on, Command.CALIBRATE, as_json=as_json)


def reset(
    name: Name = None, connect: Connect = None, who: Who = None, on: On = None, as_json: Json = False
) -> None:
    """Clear the latch of an emergency stop. Check the robot first; the motors stay off.

    Without --on it resets both simulation and robot, as `beatrix stop --emergency` stops both. Afterwards set the head
    upright, enable and calibrate.
    """
    command(resolve(name, connect, who), on, Command.RESET, as_json=as_json)


class Switch(StrEnum):
    """The argument of `follow`."""

    ON = "on"
    OFF = "off"


def follow(
    switch: Annotated[Switch, typer.Argument(help="`on` begins, `off` ends.")],
    name: Name = None,
    connect: Connect = None,
    who: Who = None,
    as_json: Json = False,
) -> None:
    """Let the simulation follow the hardware, or end this.

    While it follows, its own motions and previews are refused; STOP of the simulation also ends it.
    """
    with open_robots(resolve(name, connect, who), Which.SIM, acts=True) as robots:
        ask_each(robots, lambda robot: robot.follow(switch is Switch.ON), as_json=as_json)


def command(
    settings: Settings, which: Which | None, what: Command, *, as_json: bool, value: bool = True
) -> None:
    """Send one command to the robots selected, the simulation first."""
    with open_robots(settings, which, acts=True, both=what is Command.RESET) as robots:
        if len(robots) > 1 and value and what is not Command.RESET:
            for robot in robots:
                check_seat(robot, moves=False)
        ask_each(robots, lambda robot: robot.command(what, value=value), as_json=as_json)


def ask_each(robots: Sequence[Robot], ask: Callable[[Robot], CommandReply], *, as_json: bool) -> None:
    """Ask one robot after the other, and print the replies."""
    rows = []
    for robot in robots:
        with naming(str(robot)) if len(robots) > 1 else nullcontext():
            message = ask(robot).message
        rows.append({"robot": robot.name, "side": robot.side, "message": message})
        if not as_json:
            say(f"{robot}: {message}")
    if as_json:
        print_json({"result": True, "robots": rows})


CHECK_S = 0.5
"""Period of the check whether a lease still exists (s)."""
WARN_S = 30
"""Time (s) before the end of a turn at which its holder is warned."""


class What(StrEnum):
    """Actions of `beatrix lease`."""

    TAKE = "take"
    GIVE_BACK = "give-back"


def lease(
    what: Annotated[
        What, typer.Argument(help="take: hold the robot until Ctrl-C. give-back: end your lease.")
    ],
    wait: Wait = 0.0,
    name: Name = None,
    connect: Connect = None,
    who: Who = None,
    on: On = None,
) -> None:
    """Take a robot, or give it back.

    Only the seat that has taken a robot and the teacher can move it.
    While `beatrix lease take` runs, every program of your seat may move the robot. `beatrix ls` shows the holder.
    """
    with open_robots(resolve(name, connect, who), on, acts=True) as robots:
        if what is What.GIVE_BACK:
            for robot in robots:
                say(f"{robot}: {leases.ask(robot, LeaseAction.GIVE_BACK).message}")
            return
        if wait:
            note(f"Taking the robot, or waiting for it for up to {wait:g} s. Ctrl-C leaves the queue.")
        held = [robot.lease(wait) for robot in robots]
        for robot in robots:
            say(f"{robot}: held by {robot.client.settings.who}. Ctrl-C gives it back.")
        try:
            _hold(robots)
        finally:
            for taken in held:
                taken.close()


def _hold(robots: Sequence[Robot]) -> None:
    """Wait until an error is raised: Refused if a lease has ended, NoAnswer if a robot, not the router, is lost."""
    pause = threading.Event()
    heard_s = dict.fromkeys(robots, time.monotonic())
    warned: set[str] = set()
    while not pause.wait(CHECK_S):
        for robot in robots:
            try:
                status = robot.status()
            except NoAnswer as error:
                if error.reason is Reason.NO_ROUTER:  # robots keep the lease until the sessions are back
                    heard_s[robot] = time.monotonic()
                elif error.reason not in leases.ABSENT or time.monotonic() - heard_s[robot] > RETURN_S:
                    raise
                continue
            heard_s[robot] = time.monotonic()
            if status.lease == robot.lease_number:
                if 0 < status.turn_s <= WARN_S and str(robot) not in warned:
                    warned.add(str(robot))
                    note(f"{robot}: {status.turn_s} s left, because another seat waits.")
                continue
            robot.lease_number = 0  # so that `close` gives nothing back
            raise Refused(
                Reason.NOT_HOLDER,
                f"{robot}: your lease has ended; driver now: {status.holder or 'none'}. `beatrix ls` shows the state.",
            )


def freeze(name: Names = None, connect: Connect = None, who: Who = None, as_json: Json = False) -> None:
    """Stop every robot and let only the teacher move it. Requires the seat `teacher`."""
    _govern(LeaseQuery(action=LeaseAction.FREEZE), name, connect, who, as_json=as_json)


def unfreeze(name: Names = None, connect: Connect = None, who: Who = None, as_json: Json = False) -> None:
    """Let every seat move the robots again. Requires the seat `teacher`."""
    _govern(LeaseQuery(action=LeaseAction.UNFREEZE), name, connect, who, as_json=as_json)


def limit(
    speed: Annotated[
        str | None, typer.Argument(metavar="[SPEED]", help="Top speed of every arm, deg/s, or `off`.")
    ] = None,
    turn: Annotated[
        str | None,
        typer.Option(
            metavar="SECONDS",
            help="Instead of the speed, limit each turn while other seats wait; `off`: the default of 120 s.",
        ),
    ] = None,
    name: Names = None,
    connect: Connect = None,
    who: Who = None,
    as_json: Json = False,
) -> None:
    """Limit the speed of every robot, or the time of each turn. Requires the seat `teacher`.

    `beatrix limit 20` and `beatrix limit off`; `beatrix limit --turn 60` and `beatrix limit --turn off`.
    """
    if (speed is None) == (turn is None):
        raise typer.BadParameter(
            "Give a speed (`beatrix limit 20`, `limit off`), or a time (`beatrix limit --turn 60`, `--turn off`)."
        )
    value = _number(turn or speed or "")
    if turn is not None:
        query = LeaseQuery(action=LeaseAction.TURN, longest_s=value or 0.0)
    else:
        query = LeaseQuery(action=LeaseAction.LIMIT, speed=0.0 if value is None else leases.limit_of(value))
    _govern(query, name, connect, who, as_json=as_json)


Seat = Annotated[str, typer.Argument(metavar="SEAT", help="The seat, as `beatrix top` shows it.")]


def mute(
    seat: Seat, name: Names = None, connect: Connect = None, who: Who = None, as_json: Json = False
) -> None:
    """Let a seat only watch. Requires the seat `teacher`.

    Its motion, lease and place in the queue end, and its STOP stops no other seat.
    """
    _govern(LeaseQuery(action=LeaseAction.MUTE, seat=seat), name, connect, who, as_json=as_json)


def unmute(
    seat: Seat, name: Names = None, connect: Connect = None, who: Who = None, as_json: Json = False
) -> None:
    """Let a muted seat act again. Requires the seat `teacher`."""
    _govern(LeaseQuery(action=LeaseAction.UNMUTE, seat=seat), name, connect, who, as_json=as_json)


def _number(text: str) -> float | None:
    """Return a number, None for `off`."""
    try:
        return None if text == "off" else float(text)
    except ValueError:
        raise wrong_usage(f"{text!r} is not a number: give for example 20, or off.") from None


def _govern(
    query: LeaseQuery,
    wanted: list[str] | None,
    connect: str | None,
    who: str | None,
    *,
    as_json: bool,
) -> None:
    """Send a lease query to the robots `wanted`, or to all; exit with the first failure's code."""
    for robot in wanted or ():
        names.check_name(robot)
    settings = resolve(None, connect, who)
    if settings.account and query.action is LeaseAction.MUTE:
        settings.account.check_muted(query.seat)
    with Client(settings) as client:
        present = client.robots()
        places = [place for place in present if not wanted or place[0] in wanted]
        results = {}
        for place, result in govern(client, places, query):
            results[place] = result
            if not as_json:
                (say if result.reason is Reason.OK else note)(f"{title(place)}: {result.message}")
        later = {} if refused(client, results) else pending(client, query, wanted or ())
        if not (places or later):
            raise NoAnswer(
                Reason.NO_SUCH_ROBOT if present else Reason.NO_ANSWER,
                f"No robot {' or '.join(wanted or ())} is online at {client.bus.endpoint}. Online: "
                f"{', '.join(map(title, present)) or 'none'}.",
            )
    # The robot of a seat may be a token that a program has declared without a robot.
    failed = [
        place
        for place, result in results.items()
        if result.reason is not Reason.OK
        and (wanted or result.reason is not Reason.TIMED_OUT or not of_seat(client, place))
    ]
    of_class = wanted or (settings.account.robots if settings.account else ())
    absent = sorted({*of_class} - {robot for robot, _ in present} - {*later})
    if as_json:
        rows = [_row(place, results[place]) for place in places]
        print_json({"result": not failed, "robots": rows, "pending": [*later]})
    elif later:
        say(f"{some([*later])}: not online. The router of the class applies it when the robot comes.")
    if not as_json and (lacking := [*map(title, failed), *absent]):
        note(
            f"Not done, or not online: {some(lacking)}. Type the command again when they answer; "
            "`beatrix top` shows what they lack."
        )
    if failed or (wanted and absent):
        raise typer.Exit(exit_code(results[failed[0]].reason if failed else Reason.NO_SUCH_ROBOT))


def _row(place: Place, result: LeaseReply | BeatrixError) -> dict[str, object]:
    """Return the result of one robot for JSON output."""
    good, reason, message = result.reason is Reason.OK, result.reason, result.message
    return {"robot": place[0], "side": place[1], "result": good, "reason": reason, "message": message}
