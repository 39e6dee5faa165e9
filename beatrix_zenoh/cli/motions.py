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
from beatrix_zenoh.settings import Settings, resolve
from beatrix_zenoh.terminal.options import Connect, Json, Lead, Name, On, Which, Who
from beatrix_zenoh.terminal.targets import (
    check_lead,
    one_or_twin,
    open_robots,
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
    carry_out(resolve(name, connect, who), on, query, lead, no_wait=no_wait, as_json=as_json)


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
    carry_out(resolve(name, connect, who), on, query, lead, no_wait=no_wait, as_json=as_json)


def home(
    name: Name = None, connect: Connect = None, who: Who = None, on: On = None, as_json: Json = False
) -> None:
    """Turn the head home. All arms turn to 0 degrees; Ctrl-C stops them."""
    query = motion_query(0, 0, 0, relative=False, speed=None)
    carry_out(resolve(name, connect, who), on, query, as_json=as_json)


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
    settings: Settings,
    on: Which | None,
    query: MotionQuery | PoseQuery,
    lead_s: float = 0.0,
    *,
    no_wait: bool = False,
    as_json: bool,
) -> None:
    """Carry out a motion on the robots selected and print their positions; a motion of both is previewed first.

    With `no_wait`, begin the motion only; the text output is then the robot's message instead of the positions.
    """
    check_lead(lead_s, on)
    if no_wait and on is Which.BOTH:
        raise typer.BadParameter("--no-wait needs one robot: use --on sim or --on hw.")
    with open_robots(settings, on, acts=True) as robots:
        if no_wait:
            sentence = begin_detached(robots[0], query)
            if not as_json:
                say(f"{robots[0]}: {sentence}")
                return
        else:
            with stop_on_interrupt(robots, as_json=as_json), one_or_twin(robots) as robot:
                if isinstance(robot, Robot):
                    begin(robot, query)
                else:
                    commit(robot, query, lead_s)
        show_positions(robots, as_json=as_json)


def begin(robot: Robot, query: MotionQuery | PoseQuery) -> None:
    """Carry out a motion of one robot; print a note if the arms do not turn yet."""
    motion = robot.begin(query)
    end = motion.wait()
    if not (query.absolute or motion.duration):
        note(end.message)


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


def commit(twin: Twin, query: MotionQuery | PoseQuery, lead_s: float) -> None:
    """Preview the motion on a copy of the simulation, print the result, then carry it out on both; Ctrl-C cancels it."""
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
    lead: Lead = 0.0,
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
    with open_robots(resolve(name, connect, who), on, acts=True) as robots:
        check(found, robots)
        with stop_on_interrupt(robots, as_json=as_json), one_or_twin(robots) as both:
            perform(both, found, progress(found), lead_s=lead, lockstep=lockstep)
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
