"""`beatrix sim`: serve a simulated robot."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from beatrix_zenoh.contract import names
from beatrix_zenoh.motion import robot_file as values
from beatrix_zenoh.node.serve import serve
from beatrix_zenoh.settings import Settings, resolve
from beatrix_zenoh.terminal.options import Connect, Legacy, LogFile, RobotFile, finite
from beatrix_zenoh.terminal.run import run_command
from sim_node.body import EYES_HZ, EYES_HZ_MAX, Simulation
from sim_node.eyes import Drawing
from sim_node.target import TargetPath
from sim_node.viewer import KEYS, SceneViewer

OwnNames = Annotated[
    list[str] | None,
    typer.Option(
        "--name",
        metavar="ROBOT",
        help="Name of the robot; default: BEATRIX_ROBOT, beatrix.toml, your user name and host. May be given several times: "
        "one process simulates all of them.",
    ),
]
Seats = Annotated[
    Path | None,
    typer.Option(
        metavar="CLASS.TOML",
        help="Simulate the robot of every seat in this class file; in a class with the teacher's account.",
    ),
]


Follow = Annotated[
    bool,
    typer.Option("--follow", help="Follow the hardware of this name in real time; starts ready (--ready)."),
]
EyesHz = Annotated[
    float,
    typer.Option(
        metavar="HZ",
        min=0.0,
        max=EYES_HZ_MAX,
        callback=finite,
        help="Pictures a second of each eye, drawn only while a program subscribes; 0: no eyes.",
    ),
]
Target = Annotated[TargetPath, typer.Option(help="Movement of the person in front of the eyes.")]


def sim(
    *,
    ready: Annotated[bool, typer.Option("--ready", help="Start with motors on and calibrated.")] = False,
    follow: Follow = False,
    eyes_hz: EyesHz = EYES_HZ,
    target: Target = TargetPath.STILL,
    view: Annotated[
        bool, typer.Option("--view", help="Also show robot and room in a window; needs a display.")
    ] = False,
    legacy: Legacy = None,
    robot_file: RobotFile = None,
    log_file: LogFile = None,
    name: OwnNames = None,
    seats: Seats = None,
    connect: Connect = None,
) -> None:
    """Simulate one robot or several. Ends with Ctrl-C."""
    settings, robots = chosen(name or [], seats, connect)
    if len(robots) > 1 and (view or legacy is not None):
        raise typer.BadParameter(
            f"--view and --legacy are for one simulation, not for {len(robots)}: give one --name, or leave them out."
        )
    robot = values.load(robot_file)
    drawing = Drawing(robot)
    viewer = SceneViewer(robot) if view else None
    if view:
        typer.echo(KEYS, err=True)
    raise typer.Exit(
        serve(
            lambda name: Simulation(
                name,
                robot,
                eyes_hz=eyes_hz,
                target=target,
                viewer=viewer,
                follow=follow,
                drawing=drawing,
            ),
            robots,
            settings,
            robot=robot,
            ready=ready or follow,
            legacy=legacy,
            log_file=log_file,
        )
    )


def chosen(given: list[str], seats: Path | None, connect: str | None) -> tuple[Settings, list[str]]:
    """Return the settings, and the names of the robots to simulate: those given and the seats of a class file.

    Raises:
        WrongUsage: BAD_VALUE, as `resolve`; the class file or a name is wrong.
    """
    wanted = list(given)
    if seats is not None:
        from beatrix_zenoh import class_file  # noqa: PLC0415 - only --seats needs it

        wanted += class_file.read(seats).seats
    settings = resolve(wanted[0] if wanted else None, connect)
    return settings, [*dict.fromkeys(names.check_name(name) for name in wanted)] or [settings.robot]


def main(words: list[str] | None = None) -> int:
    """Run `beatrix sim`, and return the exit code; an entry point of group `beatrix.processes`."""
    return run_command(sim, "beatrix sim", words)
