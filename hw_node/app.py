"""`beatrix hw`: serve a robot's board."""

from __future__ import annotations

from typing import Annotated

import typer

from beatrix_zenoh.errors import BeatrixError
from beatrix_zenoh.node.serve import serve
from beatrix_zenoh.settings import resolve
from hw_node.body import build

app = typer.Typer(add_completion=False)


@app.command()
def hw(
    port: Annotated[str, typer.Option(help="Serial device, or virtual:; default: the board on USB.")] = "",
    name: Annotated[str | None, typer.Option(help="Robot name.")] = None,
    connect: Annotated[str | None, typer.Option(help="Router, e.g. tcp/127.0.0.1:7447.")] = None,
) -> None:
    """Serve the robot on a serial port until Ctrl-C; finds the board again when it comes back."""
    try:
        settings = resolve(name, connect)
    except BeatrixError as error:
        typer.echo(error.message, err=True)
        raise typer.Exit(2) from error
    raise typer.Exit(serve(lambda: build(port, settings.robot), settings))


def main(argv: list[str] | None = None) -> int:
    """Entry point of group `beatrix.processes`; returns the exit code."""
    try:
        app(args=argv, prog_name="beatrix hw")
    except SystemExit as end:
        return int(end.code or 0)
    return 0
