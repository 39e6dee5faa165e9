"""`beatrix sim`: serve a simulated robot."""

from __future__ import annotations

from typing import Annotated

import typer

from beatrix_zenoh import robot_file as lab
from beatrix_zenoh.cli.options import Connect, Legacy, OwnName, RobotFile
from beatrix_zenoh.cli.verb import alone
from beatrix_zenoh.node.serve import serve
from beatrix_zenoh.settings import resolve
from sim_node.body import Simulation


def sim(
    *,
    ready: Annotated[bool, typer.Option("--ready", help="Start with motors on and calibrated.")] = False,
    legacy: Legacy = None,
    robot_file: RobotFile = None,
    name: OwnName = None,
    connect: Connect = None,
) -> None:
    """Simulate a robot. Ends with Ctrl-C."""
    settings = resolve(name, connect)
    robot = lab.load(robot_file)
    raise typer.Exit(
        serve(lambda: Simulation(settings.robot, robot), settings, robot=robot, ready=ready, legacy=legacy)
    )


def main(words: list[str] | None = None) -> int:
    """Entry point of group `beatrix.processes`; returns the exit code."""
    return alone(sim, "beatrix sim", words)
