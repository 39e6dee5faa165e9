"""`beatrix hw`: serve a robot's board."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from beatrix_zenoh import robot_file as lab
from beatrix_zenoh._generated.messages import Reason
from beatrix_zenoh.cli.options import Connect, Legacy, OwnName, RobotFile
from beatrix_zenoh.cli.verb import alone
from beatrix_zenoh.errors import WrongUsage
from beatrix_zenoh.node.serve import serve
from beatrix_zenoh.settings import resolve
from hw_node.body import build
from hw_node.port import VIRTUAL


def hw(
    port: Annotated[
        str, typer.Option(metavar="PORT", help="Serial device, or `virtual:`; else the board on USB.")
    ] = "",
    legacy: Legacy = None,
    robot_file: RobotFile = None,
    name: OwnName = None,
    connect: Connect = None,
) -> None:
    """Serve a robot, or a virtual board. Ends with Ctrl-C; finds the board again when it comes back."""
    if port == VIRTUAL.rstrip(":"):
        raise WrongUsage(
            Reason.BAD_VALUE, f"--port {port}: a board in software is written `{VIRTUAL}`, with a colon."
        )
    if not printable(port):
        raise WrongUsage(
            Reason.BAD_VALUE, f"--port {port!r}: a port whose name is no text cannot be told to anybody."
        )
    settings = resolve(name, connect)
    robot = lab.load(robot_file)
    if port and legacy is not None and Path(port).resolve() == legacy.resolve():
        raise WrongUsage(
            Reason.BAD_VALUE,
            f"--legacy {legacy} is the board's own port: choose a path that is not there yet, for example /tmp/beatrix.",
        )
    raise typer.Exit(serve(lambda: build(port, settings.robot, robot), settings, robot=robot, legacy=legacy))


def printable(text: str) -> bool:
    """It can be sent as UTF-8: a file name on Linux may be any bytes."""
    return not any(0xD800 <= ord(letter) <= 0xDFFF for letter in text)


def main(words: list[str] | None = None) -> int:
    """Entry point of group `beatrix.processes`; returns the exit code."""
    return alone(hw, "beatrix hw", words)
