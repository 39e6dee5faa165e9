"""`beatrix lesson turn` and `report`: a program that passed runs on the robot; the teacher sees what the class does."""

from __future__ import annotations

import csv
import sys
from pathlib import Path
from typing import Annotated

import typer

from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.errors import Refused
from beatrix_zenoh.output import columns, note, print_json, say
from beatrix_zenoh.terminal.options import Connect, Json, Which, Who


def turn(
    number: Annotated[int, typer.Argument(metavar="N", min=1, help="Number of the lesson.")],
    name: Annotated[str | None, typer.Option("--name", metavar="ROBOT", help="Name of the robot.")] = None,
    on: Annotated[Which, typer.Option("--on", help="hw, or sim to rehearse it on a simulation.")] = Which.HW,
    wait: Annotated[
        float, typer.Option(min=0.0, metavar="SECONDS", help="Wait in the queue for up to this long.")
    ] = 3600.0,
    connect: Connect = None,
    who: Who = None,
) -> None:
    """Run your program on the robot, once it has passed: at most 90 s and 40 deg/s, then home.

    Waits in the queue for the robot. Ctrl-C, and a STOP of any seat, end the turn.
    """
    from beatrix_zenoh.lessons import program as programs
    from beatrix_zenoh.lessons import progress, turns
    from beatrix_zenoh.lessons.lesson import find
    from beatrix_zenoh.settings import resolve
    from beatrix_zenoh.shutdown import signals_interrupt

    if on is Which.BOTH:
        raise typer.BadParameter("A turn is on one robot: --on hw or --on sim.")
    workspace = progress.workspace(Path.cwd())
    found = find(number, workspace.progress.language)
    if found.about.no_turn:
        raise Refused(Reason.BAD_VALUE, f"Lesson {number} has no turn on the robot: {found.about.no_turn}")
    passed = workspace.record(found.name).passed
    paths = workspace.programs(found.name)
    program = programs.read(paths[0]) if paths else None
    if program is None or program.sha256 not in passed:
        what = "has changed since it passed" if passed and program is not None else "has not passed yet"
        raise Refused(
            Reason.BAD_VALUE,
            f"Your program of lesson {number} {what}; only one that passed on the simulation runs on the robot. "
            f"`beatrix lesson check {number}` checks it.",
        )
    with signals_interrupt():
        home = turns.take_turn(
            program, resolve(name, connect, who), on.value, wait, endless=found.about.endless
        )
    rest = ": the head is home, and the robot is free for the next seat" if home else "; the head is not home"
    say(f"Your turn is over{rest}.")


def report(
    as_csv: Annotated[
        bool, typer.Option("--csv", help="Print one line of CSV for each seat and lesson.")
    ] = False,
    connect: Connect = None,
    who: Who = None,
    as_json: Json = False,
) -> None:
    """Show what each seat of the class has reached in each lesson. Requires the seat `teacher`.

    The computer of each seat reports this itself: the router checks the seat, not the numbers. passed, trying, stuck, or
    impossible for numbers that no checks can have made, with the number of checks. Stuck: the last five checks or more have found nothing that the
    seat has not met before. The router of the class keeps this in memory until it ends.
    """
    from beatrix_zenoh.client.session import Client
    from beatrix_zenoh.lessons import reports
    from beatrix_zenoh.settings import resolve

    with Client(resolve(None, connect, who)) as client:
        rows = reports.read(client)
        shown, account = client.settings.shown, client.settings.account
        pupils = account.names if account is not None else {}
    if as_json:
        print_json({"result": True, "rows": [row.fields for row in rows]})
    elif as_csv:
        writer = csv.DictWriter(sys.stdout, reports.FIELDS, lineterminator="\n")
        writer.writeheader()
        writer.writerows(row.fields for row in rows)
    elif rows:
        lessons = sorted({row.lesson for row in rows})
        seats = sorted({row.seat for row in rows} | set(pupils))
        cells = {(row.seat, row.lesson): row.words for row in rows}
        lines = [(shown(seat), *(cells.get((seat, lesson), "-") for lesson in lessons)) for seat in seats]
        say(columns(("seat", *lessons), lines))
        note("Each row is what the computer of the seat has reported itself.")
        stuck = [row for row in rows if row.progress == reports.STUCK_AT]
        for row in stuck:
            say(
                f"{shown(row.seat)} has been stuck in {row.lesson} for {row.state.stuck} checks (hints read: {row.state.hints}). "
                f"The check asks: {reports.asked(row.lesson, row.state.figure)}."
            )
        if stuck:
            note(
                "`beatrix lesson hint N` on the seat explains it; `beatrix lesson solution N --show` is for you."
            )
    else:
        note("No seat has checked a lesson since the router of this class was started.")
