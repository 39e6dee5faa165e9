"""Options that have the same meaning in every verb."""

from __future__ import annotations

import math
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer


class Which(StrEnum):
    """The robots of one name that a verb applies to: the value of --on."""

    SIM = "sim"
    HW = "hw"
    BOTH = "both"


def finite(value: float) -> float:
    """Return the value of an option; raises BadParameter for NaN and infinity, because typer's bounds accept both."""
    if math.isfinite(value):
        return value
    raise typer.BadParameter(f"{value:g} is not a finite number: give a number such as 5.")


Name = Annotated[
    str | None,
    typer.Option(
        "--name",
        metavar="ROBOT",
        help="Name of the robot; default: BEATRIX_ROBOT, beatrix.toml, the only robot online.",
    ),
]
Names = Annotated[
    list[str] | None,
    typer.Option(
        "--name", metavar="ROBOT", help="Only robots of this name; may be given several times. Default: all."
    ),
]
"""The option --name of verbs that apply to many robots."""
OwnName = Annotated[
    str | None,
    typer.Option(
        "--name",
        metavar="ROBOT",
        help="Name of the robot; default: BEATRIX_ROBOT, beatrix.toml, your user name and host.",
    ),
]
"""The option --name of verbs that serve a robot."""
Connect = Annotated[
    str | None,
    typer.Option(
        "--connect",
        metavar="ENDPOINT",
        help="Address of the router; default: BEATRIX_CONNECT, beatrix.toml, tcp/127.0.0.1:7447.",
    ),
]
Who = Annotated[
    str | None,
    typer.Option(
        "--who", metavar="SEAT", help="Name of your seat; default: BEATRIX_WHO, beatrix.toml, your user name."
    ),
]
On = Annotated[
    Which | None,
    typer.Option(
        "--on", help="sim, hw or both; default: the simulation if it is online, otherwise the hardware."
    ),
]
Lead = Annotated[
    float,
    typer.Option(
        metavar="S",
        help="With --on both: the hardware starts this many seconds after the simulation. Until then, Ctrl-C "
        "prevents its start.",
    ),
]
Wait = Annotated[
    float, typer.Option(min=0.0, metavar="SECONDS", help="Wait in the queue for up to this long.")
]
Legacy = Annotated[
    Path | None,
    typer.Option(
        metavar="PATH",
        help="Serial port for programs of 2023; most of them open /dev/ttyACM0, /dev/ttyACM9 or COM3 to COM6.",
    ),
]
RobotFile = Annotated[
    Path | None,
    typer.Option(
        "--robot-file",
        metavar="FILE",
        help="Values of your own robot (TOML; docs/reference/robot.md lists them).",
    ),
]
LogFile = Annotated[
    Path | None,
    typer.Option(
        "--log-file",
        metavar="FILE",
        help="Append requests, refusals, STOPs, board events and warnings to this file.",
    ),
]
Json = Annotated[bool, typer.Option("--json", help="Print one JSON document instead of text.")]
Cameras = Annotated[
    float,
    typer.Option(
        min=0.0, max=60.0, metavar="HZ", callback=finite, help="Pictures per second of each eye; 0: none."
    ),
]
ViewerPort = Annotated[
    int, typer.Option("--port", min=1, max=65535, help="Port of the Rerun viewer on this computer.")
]
