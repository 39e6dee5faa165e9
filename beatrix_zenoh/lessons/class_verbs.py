"""`beatrix lesson turn` and `report`: a program that passed drives the robot; the teacher sees what the class does."""

from __future__ import annotations

import csv
import sys
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from beatrix_zenoh.contract.errors import bad_value
from beatrix_zenoh.lesson_files import LIBRARY, NOT_MEASURED, asked, find, lessons
from beatrix_zenoh.lessons import program as programs
from beatrix_zenoh.lessons import progress
from beatrix_zenoh.output import columns, note, print_json, say
from beatrix_zenoh.terminal.options import Connect, Json, Wait, Which, Who

if TYPE_CHECKING:
    from beatrix_zenoh.client.lesson_reports import Row


Number = Annotated[int, typer.Argument(metavar="N", min=1, help="Number of the lesson.")]


def turn(
    number: Number,
    name: Annotated[str | None, typer.Option("--name", metavar="ROBOT", help="Name of the robot.")] = None,
    on: Annotated[Which, typer.Option("--on", help="hw, or sim to rehearse it on a simulation.")] = Which.HW,
    wait: Wait = 3600.0,
    connect: Connect = None,
    who: Who = None,
) -> None:
    """Let your program drive the robot, once it has passed: at most 90 s and 40 deg/s, then home.

    The program runs on this computer. Waits in the queue for the robot. Ctrl-C, and a STOP of any seat, end the turn.
    """
    from beatrix_zenoh.lessons import turns
    from beatrix_zenoh.settings import resolve
    from beatrix_zenoh.shutdown import signals_interrupt

    if on is Which.BOTH:
        raise typer.BadParameter("A turn is on one robot: --on hw or --on sim.")
    workspace = progress.workspace(Path.cwd())
    found = find(number, workspace.progress.language)
    if found.about.no_turn:
        raise bad_value(f"Lesson {number} has no turn on the robot: {found.about.no_turn}")
    passed = workspace.record(found.name).passed
    paths = workspace.programs(found.name)
    program = programs.read(paths[0]) if paths else None
    if program is None or progress.sealed(found.name, program.sha256) not in passed:
        what = "has changed since it passed" if passed and program is not None else "has not passed yet"
        raise bad_value(
            f"Your program of lesson {number} {what}; only one that passed on the simulation may take a turn. "
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

    passed, trying, stuck, not-measured or impossible, with the number of checks; - or silent: no check yet. Stuck: the
    last five checks or more have found nothing that the seat has not met before. Not measured: the last check could judge
    nothing, usually because the computer was too busy. Impossible: no checks can have made these numbers. The computer of
    the seat reports this itself: the router checks the seat, not the numbers, and keeps them in memory until it ends.
    """
    from beatrix_zenoh.client import lesson_reports as reports
    from beatrix_zenoh.client.session import Client
    from beatrix_zenoh.settings import resolve

    with Client(resolve(None, connect, who)) as client:
        rows = reports.read(client)
        shown, account = client.settings.shown, client.settings.account
        known = account.names if account is not None else {}
    seats = sorted({row.seat for row in rows} | set(known))
    silent = sorted(set(seats) - {row.seat for row in rows})
    fields = [row.fields for row in rows] + [reports.silent(seat) for seat in silent]
    if as_json:
        print_json({"result": True, "rows": fields})
    elif as_csv:
        writer = csv.DictWriter(sys.stdout, reports.FIELDS, lineterminator="\n")
        writer.writeheader()
        writer.writerows(fields)
    elif rows:
        _show(rows, seats, shown)
    else:
        note("No seat has checked a lesson since the router of this class was started.")


def _show(rows: list[Row], seats: list[str], shown: Callable[[str], str]) -> None:
    """Print a line for each seat, and what the check asks of those that are stuck."""
    from beatrix_zenoh.client import lesson_reports as reports

    begun = sorted({row.lesson for row in rows})
    cells = {(row.seat, row.lesson): row.words for row in rows}
    lines = [(shown(seat), *(cells.get((seat, lesson), "-") for lesson in begun)) for seat in seats]
    say(columns(("seat", *begun), lines))
    note("Each row is what the computer of the seat has reported itself.")
    for row in rows:
        if row.progress == reports.STUCK_AT:
            say(
                f"{shown(row.seat)} has been stuck in {row.lesson} for {row.state.stuck} checks (hints read: "
                f"{row.state.hints}). The check asks: {asked(row.lesson, row.state.figure)}. {_help(row.lesson)}"
            )
        elif row.progress == NOT_MEASURED:
            say(
                f"The last check of {row.lesson} by {shown(row.seat)} could judge nothing: is the computer too busy?"
            )


def _help(lesson: str) -> str:
    """Return what explains a lesson to the seat, and where the teacher finds its solution."""
    if lesson in {one.name for one in lessons()}:
        return (
            "`beatrix lesson hint N` on the seat explains it; `beatrix lesson solution N --show` is for you."
        )
    solution = LIBRARY / lesson / "solution.json"
    return (
        f"The page of the seat has hints; the page of the teacher opens the solution as a file: {solution}."
    )
