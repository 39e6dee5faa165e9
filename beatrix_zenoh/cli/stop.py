"""STOP from the command line: nothing that is set, or written in a file, may stand in its way."""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from typing import Annotated

import typer

from beatrix_zenoh import codec, names
from beatrix_zenoh._generated import keys
from beatrix_zenoh._generated.messages import Command, CommandQuery, CommandReply, Reason
from beatrix_zenoh.bus import Question
from beatrix_zenoh.cli.line import Where, named
from beatrix_zenoh.cli.options import Connect, Json, Which, Who
from beatrix_zenoh.cli.verb import document, exit_code, note, say
from beatrix_zenoh.client import Client
from beatrix_zenoh.errors import NoAnswer
from beatrix_zenoh.settings import usable

STOP_S = 3.0
"""The slowest stop, from 90 deg/s, takes half a second."""
URGENT = "real_time"


def stop(
    every: Annotated[
        bool, typer.Option("--all", help="Every robot at the router, even if a name is set.")
    ] = False,
    emergency: Annotated[
        bool, typer.Option("--emergency", help="Motors off at once; the head falls. Then enable, calibrate.")
    ] = False,
    name: Annotated[
        list[str] | None,
        typer.Option(
            "--name",
            metavar="ROBOT",
            help="The robots of this name, or of these; else BEATRIX_ROBOT, beatrix.toml, every robot.",
        ),
    ] = None,
    connect: Connect = None,
    who: Who = None,
    on: Annotated[list[Which] | None, typer.Option("--on", help="sim or hw alone; else both.")] = None,
    as_json: Json = False,
) -> None:
    """Stop at once, whoever drives. Robot and simulation of a name; without a name every robot at the router."""
    asked = [names.check_name(one) for one in name or ()]
    settings, wrong = usable(connect=connect, who=who)
    if every:
        asked = ["*"]
    elif not asked:
        asked = [settings.robot if named(Where(None, connect, who), settings) else "*"]
    sides = {*(on or ())}
    twin = "sim" if sides == {Which.SIM} else "hw" if sides == {Which.HW} else "*"
    with Client(settings) as client:
        questions = [ask_to_stop(client, robot, twin, emergency=emergency) for robot in asked]
        present = client.bus.robots()  # asked after STOP, and before a frozen robot counts as gone
        replies = dict(answers(questions))
    for error in wrong:
        note(error.message)
    wanted = [place for place in present if {place[0], "*"} & {*asked} and twin in ("*", place[1])]
    if not wanted and not replies:
        found = ", ".join(f"{found} ({side})" for found, side in present)
        hint = "" if asked == ["*"] or not found else " `beatrix stop --all` stops every robot."
        raise NoAnswer(
            Reason.NO_ANSWER,
            f"Nothing to stop: no such robot at {settings.connect}. On line: {found or 'nobody'}.{hint}",
        )
    tell_stopped(replies, [place for place in wanted if place not in replies], as_json=as_json)


def ask_to_stop(client: Client, robot: str, twin: str, *, emergency: bool) -> Question:
    """Ask all robots that match at once, each on its own road."""
    if emergency:
        query = CommandQuery(command=Command.EMERGENCY_STOP.value)
        key = keys.command(robot, twin, client.settings.who)
        return client.bus.question(key, codec.encode(query), codec.MSGPACK, URGENT)
    return client.bus.question(keys.stop(robot, twin), None, codec.MSGPACK, URGENT)


def answers(questions: Sequence[Question]) -> Iterator[tuple[tuple[str, str], CommandReply]]:
    """Name, twin and reply of each robot, as its arms come to rest."""
    deadline = time.monotonic() + STOP_S
    for question in questions:
        try:
            while (answer := question.next(deadline - time.monotonic())) is not None:
                if not answer.error:
                    _, robot, twin, *_ = answer.key.split("/")
                    yield (robot, twin), codec.decode(answer.payload, CommandReply)
        except TimeoutError:
            continue
        finally:
            question.close()


def tell_stopped(
    replies: dict[tuple[str, str], CommandReply], silent: list[tuple[str, str]], *, as_json: bool
) -> None:
    """Say what became of each robot; not to have stopped one is a failure."""
    missing = "did not answer: it is frozen, or its connection is. Cut its power if it moves."
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
