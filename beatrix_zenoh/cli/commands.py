"""Verbs that switch: enable, disable, calibrate, and stop."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import nullcontext
from typing import Annotated

import typer

from beatrix_zenoh import codec
from beatrix_zenoh._generated import keys
from beatrix_zenoh._generated.messages import Command, CommandQuery, CommandReply, Reason
from beatrix_zenoh.bus import Question
from beatrix_zenoh.cli.line import Where, named, on_line
from beatrix_zenoh.cli.options import Connect, Json, Name, On, Which, Who
from beatrix_zenoh.cli.verb import document, exit_code, note, say
from beatrix_zenoh.client import Client
from beatrix_zenoh.errors import NoAnswer, naming
from beatrix_zenoh.settings import resolve

STOP_S = 3.0
"""The slowest stop, from 90 deg/s, takes half a second."""
URGENT = "real_time"


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
    """Declare the present position home. Set the head upright first."""
    command(Where(name, connect, who), on, Command.CALIBRATE, as_json=as_json)


def command(where: Where, which: Which | None, what: Command, *, as_json: bool, value: bool = True) -> None:
    """One command to the robots chosen, the simulation first."""
    with on_line(where, which) as line:
        rows, robots = [], line.robots()
        for robot in robots:
            with naming(str(robot)) if len(robots) > 1 else nullcontext():
                reply = robot.command(what, value=value)
            rows.append({"robot": robot.name, "on": robot.twin, "message": reply.message})
            if not as_json:
                say(f"{robot}: {reply.message}")
    if as_json:
        document({"result": True, "robots": rows})


def stop(
    every: Annotated[
        bool, typer.Option("--all", help="Every robot at the router, even if a name is set.")
    ] = False,
    emergency: Annotated[
        bool, typer.Option("--emergency", help="Motors off at once; the head falls. Then enable, calibrate.")
    ] = False,
    name: Annotated[
        str | None,
        typer.Option(
            "--name",
            metavar="ROBOT",
            help="The robots of this name; else BEATRIX_ROBOT, beatrix.toml, every robot.",
        ),
    ] = None,
    connect: Connect = None,
    who: Who = None,
    on: Annotated[Which | None, typer.Option("--on", help="sim or hw alone; else both.")] = None,
    as_json: Json = False,
) -> None:
    """Stop at once, whoever drives. Robot and simulation of a name; without a name every robot at the router."""
    settings = resolve(name, connect, who)
    robot = "*" if every or not named(Where(name, connect, who), settings) else settings.robot
    twin = "*" if on in (None, Which.BOTH) else on.value
    with Client(settings) as client:
        question = ask_to_stop(client, robot, twin, emergency=emergency)
        present = client.bus.robots()  # asked after STOP, and before a frozen robot counts as gone
        replies = dict(answers(question))
    wanted = [place for place in present if robot in ("*", place[0]) and twin in ("*", place[1])]
    if not wanted and not replies:
        found = ", ".join(f"{found} ({side})" for found, side in present) or "nobody"
        raise NoAnswer(
            Reason.NO_ANSWER, f"Nothing to stop: no such robot at {settings.connect}. On line: {found}."
        )
    tell_stopped(replies, [place for place in wanted if place not in replies], as_json=as_json)


def ask_to_stop(client: Client, robot: str, twin: str, *, emergency: bool) -> Question:
    """Ask all robots that match at once, each on its own road."""
    if emergency:
        query = CommandQuery(command=Command.EMERGENCY_STOP.value)
        key = keys.command(robot, twin, client.settings.who)
        return client.bus.question(key, codec.encode(query), codec.MSGPACK, URGENT)
    return client.bus.question(keys.stop(robot, twin), None, codec.MSGPACK, URGENT)


def answers(question: Question) -> Iterator[tuple[tuple[str, str], CommandReply]]:
    """Name, twin and reply of each robot, as its arms come to rest."""
    deadline = time.monotonic() + STOP_S
    try:
        while (answer := question.next(deadline - time.monotonic())) is not None:
            if not answer.error:
                _, robot, twin, *_ = answer.key.split("/")
                yield (robot, twin), codec.decode(answer.payload, CommandReply)
    except TimeoutError:
        return
    finally:
        question.close()


def tell_stopped(
    replies: dict[tuple[str, str], CommandReply], silent: list[tuple[str, str]], *, as_json: bool
) -> None:
    """Say what became of each robot; not to have stopped one is a failure."""
    missing = f"did not answer within {STOP_S:.0f} s: it is frozen, or its connection is. Cut its power."
    ends = [(place, reply.reason, reply.message) for place, reply in replies.items()]
    ends += [(place, Reason.TIMED_OUT, missing) for place in silent]
    failed = [reason for _, reason, _ in ends if reason is not Reason.OK]
    if as_json:
        rows = [
            {"robot": robot, "on": twin, "result": reason is Reason.OK, "reason": reason, "message": message}
            for (robot, twin), reason, message in ends
        ]
        document({"result": not failed, "robots": rows})
    else:
        for (robot, twin), reason, message in ends:
            (say if reason is Reason.OK else note)(f"{robot} ({twin}): {message}")
    if failed:
        raise typer.Exit(exit_code(failed[0]))
