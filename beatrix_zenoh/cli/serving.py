"""Verbs that serve until Ctrl-C: router, sim, hw; and flash, which belongs to hw."""

from __future__ import annotations

from importlib import metadata
from typing import Annotated

import typer

from beatrix_zenoh import bus as zbus
from beatrix_zenoh._generated.messages import Reason
from beatrix_zenoh.cli.hurry import nothing_to_undo
from beatrix_zenoh.cli.verb import say
from beatrix_zenoh.ending import Ending
from beatrix_zenoh.errors import Refused
from beatrix_zenoh.settings import DEFAULT_ENDPOINT

PROCESSES = "beatrix.processes"
"""Entry points of the programs that stand above this package; it never imports them."""
EXTRAS = {"flash": "hw"}
"""Where a program is not in the extra of its own name."""


def router(
    listen: Annotated[
        str, typer.Option(metavar="ENDPOINT", help="Where robots and programs connect.")
    ] = DEFAULT_ENDPOINT,
) -> None:
    """Be the router where all of them meet.

    Robots, simulations and programs connect to it; it ends with Ctrl-C. Other computers reach it with --listen tcp/0.0.0.0:7447. It asks nobody who they are: do that only
    in a network you trust.
    """
    ending = Ending()
    ending.heed_signals()
    session = zbus.open_router(listen)
    try:
        say(f"ready {listen}")
        ending.wait()
    finally:
        session.close()


def sim(context: typer.Context) -> None:
    """Simulate a robot. `beatrix sim --help` lists its options."""
    raise typer.Exit(run("sim", context.args))


def hw(context: typer.Context) -> None:
    """Serve a robot, or a virtual board. `beatrix hw --help` lists its options."""
    raise typer.Exit(run("hw", context.args))


def flash(context: typer.Context) -> None:
    """Put the firmware onto an Arduino Mega. `beatrix flash --help` lists its options."""
    raise typer.Exit(run("flash", context.args))


def run(process: str, arguments: list[str]) -> int:
    """Run a process of the group in this one; its exit code.

    Raises:
        Refused: it is not installed.
    """
    install = f'pip install ".[{EXTRAS.get(process, process)}]" in the folder of BEATRIX'
    entries = metadata.entry_points(group=PROCESSES, name=process)
    if not entries:
        raise Refused(Reason.BAD_VALUE, f"`beatrix {process}` is not installed: {install}")
    try:
        with nothing_to_undo():
            main = next(iter(entries)).load()
    except ModuleNotFoundError as error:
        raise Refused(
            Reason.BAD_VALUE, f"`beatrix {process}` needs {error.name}, which is not installed: {install}"
        ) from error
    code: int = main(arguments)
    return code
