"""`beatrix sim`: serve a simulated robot."""

from __future__ import annotations

from typing import Annotated

import typer

from beatrix_zenoh.errors import BeatrixError
from beatrix_zenoh.node.serve import serve
from beatrix_zenoh.settings import resolve
from sim_node.body import Simulation

app = typer.Typer(add_completion=False)


@app.command()
def sim(
    name: Annotated[str | None, typer.Option(help="Robot name; default user-host.")] = None,
    connect: Annotated[str | None, typer.Option(help="Router, e.g. tcp/127.0.0.1:7447.")] = None,
    *,
    ready: Annotated[bool, typer.Option("--ready", help="Start with motors on and calibrated.")] = False,
) -> None:
    """Serve a robot in simulation until Ctrl-C."""
    try:
        settings = resolve(name, connect)
    except BeatrixError as error:
        typer.echo(error.message, err=True)
        raise typer.Exit(2) from error
    raise typer.Exit(serve(lambda: Simulation(settings.robot), settings, ready=ready))


def main(argv: list[str] | None = None) -> int:
    """Entry point of group `beatrix.processes`; returns the exit code."""
    try:
        app(args=argv, prog_name="beatrix sim")
    except SystemExit as end:
        return int(end.code or 0)
    return 0
