"""Verbs that switch: enable, disable, calibrate."""

from __future__ import annotations

from contextlib import nullcontext

from beatrix_zenoh._generated.messages import Command
from beatrix_zenoh.cli.line import Where, on_the_move
from beatrix_zenoh.cli.options import Connect, Json, Name, On, Which, Who
from beatrix_zenoh.cli.verb import document, say
from beatrix_zenoh.errors import naming
from beatrix_zenoh.twin import check_reachable


def enable(
    name: Name = None, connect: Connect = None, who: Who = None, on: On = None, as_json: Json = False
) -> None:
    """Switch the motors on. Home must be calibrated afterwards."""
    command(Where(name, connect, who), on, Command.ENABLE, as_json=as_json)


def disable(
    name: Name = None, connect: Connect = None, who: Who = None, on: On = None, as_json: Json = False
) -> None:
    """Switch the motors off. The head may sink, and home is forgotten."""
    command(Where(name, connect, who), on, Command.ENABLE, value=False, as_json=as_json)


def calibrate(
    name: Name = None, connect: Connect = None, who: Who = None, on: On = None, as_json: Json = False
) -> None:
    """Declare the present position home. Set the head upright and straight ahead first."""
    command(Where(name, connect, who), on, Command.CALIBRATE, as_json=as_json)


def command(where: Where, which: Which | None, what: Command, *, as_json: bool, value: bool = True) -> None:
    """One command to the robots chosen, the simulation first."""
    with on_the_move(where, which) as line:
        rows, robots = [], line.robots()
        if len(robots) > 1 and value:
            check_reachable(robots, line.client.settings.who)
        for robot in robots:
            with naming(str(robot)) if len(robots) > 1 else nullcontext():
                reply = robot.command(what, value=value)
            rows.append({"robot": robot.name, "on": robot.twin, "message": reply.message})
            if not as_json:
                say(f"{robot}: {reply.message}")
    if as_json:
        document({"result": True, "robots": rows})
