"""`beatrix sim`: serve a simulated robot."""

from __future__ import annotations

from typing import Annotated

import typer

from beatrix_zenoh.motion import robot_file as values
from beatrix_zenoh.node.serve import serve
from beatrix_zenoh.settings import resolve
from beatrix_zenoh.terminal.options import Connect, Legacy, LogFile, OwnName, RobotFile, finite
from beatrix_zenoh.terminal.run import run_command
from sim_node.body import EYES_HZ, EYES_HZ_MAX, Simulation
from sim_node.picture import KEYS
from sim_node.target import TargetPath
from sim_node.viewer import SceneViewer


def sim(
    *,
    ready: Annotated[bool, typer.Option("--ready", help="Start with motors on and calibrated.")] = False,
    follow: Annotated[
        bool,
        typer.Option(
            "--follow", help="Follow the hardware of this name in real time; starts ready (--ready)."
        ),
    ] = False,
    eyes_hz: Annotated[
        float,
        typer.Option(
            metavar="HZ",
            min=0.0,
            max=EYES_HZ_MAX,
            callback=finite,
            help="Pictures a second of each eye, drawn only while a program subscribes; 0: no eyes.",
        ),
    ] = EYES_HZ,
    target: Annotated[
        TargetPath, typer.Option(help="Movement of the person in front of the eyes.")
    ] = TargetPath.STILL,
    view: Annotated[
        bool, typer.Option("--view", help="Also show robot and room in a window; needs a display.")
    ] = False,
    legacy: Legacy = None,
    robot_file: RobotFile = None,
    log_file: LogFile = None,
    name: OwnName = None,
    connect: Connect = None,
) -> None:
    """Simulate a robot. Ends with Ctrl-C."""
    settings = resolve(name, connect)
    robot = values.load(robot_file)
    viewer = SceneViewer(robot) if view else None
    if view:
        typer.echo(KEYS, err=True)
    raise typer.Exit(
        serve(
            lambda: Simulation(
                settings.robot, robot, eyes_hz=eyes_hz, target=target, viewer=viewer, follow=follow
            ),
            settings,
            robot=robot,
            ready=ready or follow,
            legacy=legacy,
            log_file=log_file,
        )
    )


def main(words: list[str] | None = None) -> int:
    """Run `beatrix sim`, and return the exit code; an entry point of group `beatrix.processes`."""
    return run_command(sim, "beatrix sim", words)
