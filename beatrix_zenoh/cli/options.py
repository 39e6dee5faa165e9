"""Options that mean the same in every verb."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer


class Which(StrEnum):
    """Which robots of a name."""

    SIM = "sim"
    HW = "hw"
    BOTH = "both"


Name = Annotated[
    str | None,
    typer.Option(
        "--name", metavar="ROBOT", help="The robot; else BEATRIX_ROBOT, beatrix.toml, the only one on line."
    ),
]
OwnName = Annotated[
    str | None,
    typer.Option(
        "--name", metavar="ROBOT", help="Its name; else BEATRIX_ROBOT, beatrix.toml, your user name and host."
    ),
]
"""Of verbs that bring a robot on line."""
Connect = Annotated[
    str | None,
    typer.Option(
        "--connect",
        metavar="ENDPOINT",
        help="The router; else BEATRIX_CONNECT, beatrix.toml, tcp/127.0.0.1:7447.",
    ),
]
Who = Annotated[
    str | None,
    typer.Option("--who", metavar="SEAT", help="Who asks; else BEATRIX_WHO, beatrix.toml, your user name."),
]
On = Annotated[
    Which | None,
    typer.Option(
        "--on", help="sim, hw or both; else the simulation if it is on line, otherwise the hardware."
    ),
]
Legacy = Annotated[
    Path | None,
    typer.Option(
        metavar="PATH",
        help="Let programs of 2023 open a serial port here, for example /dev/ttyACM9 or /tmp/beatrix.",
    ),
]
RobotFile = Annotated[
    Path | None,
    typer.Option(
        "--robot-file",
        metavar="FILE",
        help="Values of your own robot (TOML, as docs/reference/robot.md names them).",
    ),
]
Json = Annotated[bool, typer.Option("--json", help="Print one JSON document and nothing else.")]
