"""`beatrix classroom`, which makes the accounts of a class, and `beatrix join`, which stores one on a computer."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from beatrix_zenoh import account as accounts
from beatrix_zenoh import bus as zbus
from beatrix_zenoh.account import Account
from beatrix_zenoh.class_file import Classroom
from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.errors import BeatrixError, bad_value
from beatrix_zenoh.output import exit_code, note, say, typed
from beatrix_zenoh.terminal.run import missing

STDIN = Path("-")


class ClassroomAction(StrEnum):
    """Actions of `beatrix classroom`."""

    INIT = "init"
    NEW_WORD = "new-word"


def classroom(
    action: Annotated[
        ClassroomAction,
        typer.Argument(
            help="init: make the accounts that are missing; new-word: replace the word of a seat."
        ),
    ],
    file: Annotated[Path, typer.Argument(metavar="class.toml", help="The class file.")],
    seat: Annotated[str | None, typer.Argument(metavar="SEAT", help="For new-word: the seat.")] = None,
    out: Annotated[
        Path | None,
        typer.Option(
            metavar="FOLDER",
            help="Folder for the files; default: a folder with the name of the class, beside the class file.",
        ),
    ] = None,
) -> None:
    """Make the accounts of a class. Writes a file for the router, each seat and each robot, and cards to print.

    All files are for the teacher only, who gives each seat and robot its own file. A repeated run keeps existing
    accounts and adds those of new seats and robots. `new-word` replaces a word that others know: pages that have
    logged in with the old one end at once.
    """
    from beatrix_zenoh import class_file, class_words

    try:
        from beatrix_zenoh.classroom import provision
    except ModuleNotFoundError as error:
        raise missing("classroom", error) from error

    described = class_file.read(file)
    folder = out or class_file.folder(file, described)
    if action is ClassroomAction.NEW_WORD:
        if seat is None:
            raise typer.BadParameter("Name the seat: beatrix classroom new-word class.toml ana")
        word = class_words.renew(folder, seat).words[seat]
        provision.write_sheet(described, folder)
        say(f"The word of {seat} is now {word}. The sheet is {folder / provision.SHEET}")
        return
    _init(file, described, folder, named=out is not None)


def _init(file: Path, described: Classroom, folder: Path, *, named: bool) -> None:
    """Make the accounts that are missing, and print what to do next; `named`: the user has chosen the folder."""
    from beatrix_zenoh.classroom import provision

    made = provision.init(described, folder)
    seats, robots = _counted(described.seats, "seat"), _counted(described.robots, "robot")
    say(f"Class {described.name}: {seats}, {robots}, in {folder}")
    say(f"  new or changed     {', '.join(made.changed) or 'none'}")
    router = typed("beatrix", "router", "--class", folder / "router.toml" if named else file)
    say(f"  start router       {router}   (one that runs restarts by itself)")
    say(
        f"  to each of these   copy its file from {folder / 'seats'} or {folder / 'robots'}; run there: beatrix join FILE"
    )
    say(f"  cards to print     {folder / 'cards.html'}; words for tablets: {folder / provision.SHEET}")
    for path in made.left:
        note(
            f"{path}: the class has no such seat or robot, so the router refuses this account. You can delete the file."
        )


def _counted(names: Sequence[str], what: str) -> str:
    """Return the number of names in words: `1 robot`, `2 robots`."""
    return f"{len(names)} {what}{'' if len(names) == 1 else 's'}"


def join(
    file: Annotated[
        Path | None,
        typer.Argument(
            metavar="FILE", help="The account file of this seat or robot; - reads standard input."
        ),
    ] = None,
    leave: Annotated[
        bool, typer.Option("--leave", help="Delete the account stored on this computer.")
    ] = False,
) -> None:
    """Join a class. From then on all verbs and programs use its router, and this seat's account.

    The account is for your user on this computer. BEATRIX_ACCOUNT=FILE uses another account,
    and BEATRIX_ACCOUNT= (empty) uses none.
    """
    place = accounts.joined()
    if leave == (file is not None):
        raise typer.BadParameter("Give either the account file of your seat or --leave.")
    if file is None:
        place.unlink(missing_ok=True)
        say("This computer has no account of a class now.")
        return
    account = accounts.parse(sys.stdin.read(), "The text") if file == STDIN else accounts.load(file)
    before = f" It replaces the account that was stored in {place}." if place.exists() else ""
    try:
        accounts.store(account)
    except OSError as error:
        raise bad_value(
            f"Cannot store the account: {error}. Check the permissions and the free space of {place.parent}.",
        ) from error
    say(f"Joined class {account.class_name} as {account.name}. Router: {account.connect}.{before}")
    _check(account)


def _check(account: Account) -> None:
    """Print whether the router accepts the account now; a refusal is an error, a router that is not running yet is none."""
    try:
        with zbus.connect(account.connect, account=account) as bus:
            refused: BeatrixError | None = bus.connection_error()
    except BeatrixError as error:
        refused = error
    if refused is not None:
        note(f"The account is stored, but not usable now. {refused.message}")
        if refused.reason is Reason.ACCOUNT_REFUSED:
            raise typer.Exit(exit_code(refused.reason))
    else:
        say("The router accepts this account.")
