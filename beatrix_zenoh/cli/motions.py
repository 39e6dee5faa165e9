"""Verbs that turn the head: look, move, home, play."""

from __future__ import annotations

import contextlib
import itertools
from collections.abc import Callable
from pathlib import Path
from typing import Annotated

import typer
from msgspec import structs

from beatrix_zenoh.client import choreography
from beatrix_zenoh.client.choreography import Choreography, Step
from beatrix_zenoh.client.choreography import play as perform
from beatrix_zenoh.client.degrees import motion_query, pose_query
from beatrix_zenoh.client.robot import Robot
from beatrix_zenoh.client.session import Client
from beatrix_zenoh.client.twin import Twin
from beatrix_zenoh.client.twin_motion import TwinMotion
from beatrix_zenoh.contract._generated.messages import MotionQuery, PoseQuery, Source
from beatrix_zenoh.output import note, say
from beatrix_zenoh.terminal.options import Connect, Json, Name, On, Which, Who
from beatrix_zenoh.terminal.targets import (
    Selection,
    Targets,
    check_lead,
    open_targets,
    show_positions,
    stop_on_interrupt,
)

Relative = Annotated[bool, typer.Option("--relative", help="Turn by these angles from the present position.")]
Speed = Annotated[
    float | None, typer.Option(help="Top speed of the fastest arm, degrees/s; default: the robot's.")
]
ArmSpeed = Annotated[
    str | None,
    typer.Option(
        metavar="DEG_S",
        help="Top speed, degrees/s, one number for all arms or three: 20,30,40; default: the robot's.",
    ),
]
NoWait = Annotated[
    bool,
    typer.Option(
        "--no-wait", help="Exit once the motion is accepted; it continues, and Ctrl-C does not stop it."
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


def look(
    yaw: Annotated[float, typer.Option(help="Degrees, left is positive.")] = 0.0,
    pitch: Annotated[float, typer.Option(help="Degrees, nose down is positive.")] = 0.0,
    roll: Annotated[float, typer.Option(help="Degrees, right ear down is positive.")] = 0.0,
    relative: Relative = False,
    speed: Speed = None,
    lead: Lead = 0.0,
    no_wait: NoWait = False,
    name: Name = None,
    connect: Connect = None,
    who: Who = None,
    on: On = None,
    as_json: Json = False,
) -> None:
    """Turn the head to yaw, pitch and roll. Angles are in degrees; those not given are 0. Ctrl-C stops the head."""
    query = pose_query(yaw, pitch, roll, relative=relative, speed=speed)
    check_lead(lead, on)
    with open_targets(Selection(name, connect, who), on, acts=True) as targets:
        carry_out(targets, query, lead, no_wait=no_wait, as_json=as_json)


def move(
    short: Annotated[float, typer.Argument(help="Short arm, degrees.")],
    middle: Annotated[float, typer.Argument(help="Middle arm, degrees.")],
    long: Annotated[float, typer.Argument(help="Long arm, degrees.")],
    relative: Relative = False,
    speed: ArmSpeed = None,
    lead: Lead = 0.0,
    no_wait: NoWait = False,
    name: Name = None,
    connect: Connect = None,
    who: Who = None,
    on: On = None,
    as_json: Json = False,
) -> None:
    """Turn the three arms. Angles are in degrees from home, positive counter-clockwise. Ctrl-C stops the arms."""
    query = motion_query(short, middle, long, relative=relative, speed=arm_speed(speed))
    check_lead(lead, on)
    with open_targets(Selection(name, connect, who), on, acts=True) as targets:
        carry_out(targets, query, lead, no_wait=no_wait, as_json=as_json)


def home(
    name: Name = None, connect: Connect = None, who: Who = None, on: On = None, as_json: Json = False
) -> None:
    """Turn the head home. All arms turn to 0 degrees; Ctrl-C stops them."""
    query = motion_query(0, 0, 0, relative=False, speed=None)
    with open_targets(Selection(name, connect, who), on, acts=True) as targets:
        carry_out(targets, query, 0.0, no_wait=False, as_json=as_json)


def arm_speed(text: str | None) -> float | list[float] | None:
    """Return one number or three (deg/s) from a text with commas; raises BadParameter for any other text."""
    if text is None:
        return None
    try:
        speeds = [float(number) for number in text.split(",")]
    except ValueError:
        speeds = []
    if len(speeds) not in (1, 3):
        raise typer.BadParameter(
            f"--speed {text}: give one number of degrees/s, or three for short, middle and long arm: 20,30,40."
        )
    return speeds[0] if len(speeds) == 1 else speeds


def carry_out(
    targets: Targets, query: MotionQuery | PoseQuery, lead_s: float, *, no_wait: bool, as_json: bool
) -> None:
    """Carry out a motion on the robots selected and print their positions; a motion of both is previewed first.

    With `no_wait`, begin the motion only; the text output is then the robot's message instead of the positions.
    """
    robots = targets.robots()
    if len(robots) > 1 and no_wait:
        raise typer.BadParameter("--no-wait needs one robot: use --on sim or --on hw.")
    if no_wait:
        sentence = begin_detached(robots[0], query)
        if not as_json:
            say(f"{robots[0]}: {sentence}")
            return
    elif len(robots) > 1:
        with stop_on_interrupt(robots, as_json=as_json):
            commit(targets, query, lead_s)
    else:
        with stop_on_interrupt(robots, as_json=as_json):
            motion = robots[0].begin(query)
            end = motion.wait()
        if not (query.absolute or motion.duration):
            note(end.message)  # the arms do not turn yet
    show_positions(robots, as_json=as_json)


def begin_detached(robot: Robot, query: MotionQuery | PoseQuery) -> str:
    """Send a motion that continues after this process has ended, and return the robot's message.

    A robot stops the motion of a client whose seat token disappears; this session announces no seat, so it has no
    token.

    Raises:
        Refused: with the robot's reason.
        NoAnswer: no reply arrived in time.
    """
    with Client(robot.client.settings, announce=False, source=Source.CLI) as client:
        detached = Robot(robot.name, robot.side, client=client, timeout_s=robot.timeout_s)
        return detached.begin(query).accepted.message


def commit(targets: Targets, query: MotionQuery | PoseQuery, lead_s: float) -> None:
    """Preview the motion on a copy of the simulation, print the result, then carry it out on both; Ctrl-C cancels it."""
    with twin_of(targets) as twin:
        plan = twin.preview_query(structs.replace(query, source=Source.CLI))
        note(f"Preview: {plan.verdict}")
        motion = plan.commit(lead_s, wait=False)
        if lead_s:
            note(f"The hardware moves in {lead_s:g} s, unless you press Ctrl-C before then.")
        try:
            motion.result()
        except KeyboardInterrupt as interrupt:
            raise KeyboardInterrupt(cancelled(motion)) from interrupt
        if lead_s and motion.lag_s is not None:
            note(f"The hardware began {motion.lag_s:.2f} s after the simulation.")


def twin_of(targets: Targets) -> Twin:
    """Return both robots selected, with sessions of their own."""
    settings = targets.client.settings
    return Twin(targets.name, connect=settings.connect, who=settings.who)


def cancelled(motion: TwinMotion) -> str:
    """Cancel a motion and return a sentence with the positions of both robots; empty if the motion had ended."""
    if not motion.cancel():
        return ""
    with contextlib.suppress(TimeoutError):
        return str(motion.exception(0) or "")
    return ""


MANY = 1000
"""Number of poses above which a note is printed before the check, which then takes seconds."""


def play(
    file: Annotated[
        Path,
        typer.Argument(metavar="FILE", help="A choreography (CSV), or the name of a gesture, such as yes."),
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
                with twin_of(targets) as twin:
                    perform(twin, found, progress(found), lead_s=lead, lockstep=lockstep)
            else:
                perform(robots[0], found, progress(found))
        show_positions(robots, as_json=as_json)


def check(found: Choreography, robots: list[Robot]) -> None:
    """Check all poses for each robot; raises Refused with line and time of the first pose that exceeds a limit."""
    from beatrix_zenoh.paths.follow import robots_of
    from beatrix_zenoh.paths.path import check_choreography

    if len(found.steps) > MANY:
        note(f"Checking {len(found.steps)} poses.")
    for robot in robots_of([robot.info() for robot in robots]):
        check_choreography(found, robot)


def progress(found: Choreography) -> Callable[[str, Step], None]:
    """Return a function that prints number, title and angles of a pose, to be called when the pose begins."""
    number, last = itertools.count(1), len(found.steps)

    def show(title: str, pose: Step) -> None:
        note(f"{next(number)}/{last} {title}: {pose}")

    return show
