"""`beatrix play`: play a choreography from a file."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from pathlib import Path
from typing import Annotated

import typer

from beatrix_zenoh.cli.motions import check_lead, show_positions, stop_on_interrupt
from beatrix_zenoh.cli.options import Connect, Json, Name, On, Which, Who
from beatrix_zenoh.cli.targets import Selection, Targets, open_targets
from beatrix_zenoh.client import choreography
from beatrix_zenoh.client.choreography import Choreography, Step
from beatrix_zenoh.client.choreography import play as perform
from beatrix_zenoh.client.robot import Robot
from beatrix_zenoh.client.twin import Twin
from beatrix_zenoh.output import note

MANY = 1000
"""Number of poses above which a note is printed before the check, which then takes seconds."""


def play(
    file: Annotated[
        Path, typer.Argument(metavar="FILE", help="A choreography (CSV), or the shipped one: hello.")
    ],
    lead: Annotated[
        float,
        typer.Option(
            metavar="S",
            help="With --on both: the hardware starts each pose this many seconds after the simulation.",
        ),
    ] = 0.0,
    lockstep: Annotated[
        bool,
        typer.Option("--lockstep", help="With --on both: the robots wait for each other at every pose."),
    ] = False,
    speed: Annotated[
        float | None,
        typer.Option(metavar="DEG_S", help="Speed, degrees/s, instead of the speeds in the file."),
    ] = None,
    name: Name = None,
    connect: Connect = None,
    who: Who = None,
    on: On = None,
    as_json: Json = False,
) -> None:
    """Play a choreography. All poses are checked before a robot moves; Ctrl-C stops the robots.

    docs/how-to/motion-files.md explains the file format.
    """
    found = choreography.load(file)
    if speed is not None:
        found = found.at_speed(speed)
    check_lead(lead, on)
    if lockstep and on is not Which.BOTH:
        raise typer.BadParameter("--lockstep needs --on both: the robots wait for each other.")
    if lockstep and lead:
        raise typer.BadParameter("--lockstep and --lead exclude each other: omit one.")
    with open_targets(Selection(name, connect, who), on, acts=True) as targets:
        robots = targets.robots()
        check(found, robots)
        with stop_on_interrupt(robots, as_json=as_json):
            if len(robots) > 1:
                play_both(targets, found, lead, lockstep=lockstep)
            else:
                perform(robots[0], found, progress(found))
        show_positions(robots, as_json=as_json)


def check(found: Choreography, robots: list[Robot]) -> None:
    """Check all poses for each robot; raises Refused with line and time of the first pose that exceeds a limit."""
    from beatrix_zenoh.recording.choreography_check import check_choreography
    from beatrix_zenoh.recording.follow import robots_of

    if len(found.steps) > MANY:
        note(f"Checking {len(found.steps)} poses.")
    for robot in robots_of([robot.info() for robot in robots]):
        check_choreography(found, robot)


def play_both(targets: Targets, found: Choreography, lead: float, *, lockstep: bool) -> None:
    """Play the choreography on both robots; each pose is previewed first."""
    settings = targets.client.settings
    with Twin(targets.name, connect=settings.connect, who=settings.who) as twin:
        perform(twin, found, progress(found), lead_s=lead, lockstep=lockstep)


def progress(found: Choreography) -> Callable[[str, Step], None]:
    """Return a function that prints number, title and angles of a pose, to be called when the pose begins."""
    number, last = itertools.count(1), len(found.steps)

    def show(title: str, pose: Step) -> None:
        note(f"{next(number)}/{last} {title}: {pose}")

    return show
