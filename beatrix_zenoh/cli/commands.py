"""Verbs that send a command: enable, disable, calibrate, reset, follow."""

from __future__ import annotations

from contextlib import nullcontext
from enum import StrEnum
from typing import Annotated

import typer

from beatrix_zenoh.cli.options import Connect, Json, Name, On, Which, Who
from beatrix_zenoh.cli.targets import Selection, open_targets
from beatrix_zenoh.client.twin import check_reachable
from beatrix_zenoh.contract._generated.messages import Command
from beatrix_zenoh.contract.errors import naming
from beatrix_zenoh.output import print_json, say


def enable(
    name: Name = None, connect: Connect = None, who: Who = None, on: On = None, as_json: Json = False
) -> None:
    """Switch the motors on. Calibrate afterwards; after an emergency stop reset first."""
    command(Selection(name, connect, who), on, Command.ENABLE, as_json=as_json)


def disable(
    name: Name = None, connect: Connect = None, who: Who = None, on: On = None, as_json: Json = False
) -> None:
    """Switch the motors off. The head may sink, and the robot must be calibrated again."""
    command(Selection(name, connect, who), on, Command.ENABLE, value=False, as_json=as_json)


def calibrate(
    name: Name = None, connect: Connect = None, who: Who = None, on: On = None, as_json: Json = False
) -> None:
    """Declare the present position home. Set the head upright and straight ahead first."""
    command(Selection(name, connect, who), on, Command.CALIBRATE, as_json=as_json)


def reset(
    name: Name = None, connect: Connect = None, who: Who = None, on: On = None, as_json: Json = False
) -> None:
    """Clear the latch of an emergency stop. Check the robot first; the motors stay off.

    Without --on it resets both simulation and robot, as `beatrix stop --emergency` stops both. Afterwards set the head
    upright, enable and calibrate.
    """
    command(Selection(name, connect, who), on, Command.RESET, as_json=as_json)


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
    with open_targets(Selection(name, connect, who), Which.SIM, acts=True) as targets:
        robot = targets.robots()[0]
        reply = robot.follow(switch is Switch.ON)
    if as_json:
        print_json(
            {"result": True, "robots": [{"robot": robot.name, "side": robot.side, "message": reply.message}]}
        )
    else:
        say(f"{robot}: {reply.message}")


def command(
    selection: Selection, which: Which | None, what: Command, *, as_json: bool, value: bool = True
) -> None:
    """Send one command to the robots selected, the simulation first, and print the replies."""
    with open_targets(selection, which, acts=True, both=what is Command.RESET) as targets:
        rows, robots = [], targets.robots()
        if len(robots) > 1 and value and what is not Command.RESET:
            check_reachable(robots, targets.client.settings.who)
        for robot in robots:
            with naming(str(robot)) if len(robots) > 1 else nullcontext():
                reply = robot.command(what, value=value)
            rows.append({"robot": robot.name, "side": robot.side, "message": reply.message})
            if not as_json:
                say(f"{robot}: {reply.message}")
    if as_json:
        print_json({"result": True, "robots": rows})
