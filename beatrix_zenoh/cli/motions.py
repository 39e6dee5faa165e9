"""Verbs that turn the head: look, move, home."""

from __future__ import annotations

import contextlib
import math
from collections.abc import Iterator, Mapping
from typing import Annotated

import typer
from msgspec import structs

from beatrix_zenoh.cli.options import Connect, Json, Name, On, Which, Who
from beatrix_zenoh.cli.targets import Selection, Targets, open_targets
from beatrix_zenoh.client.degrees import Reading, motion_query, pose_query
from beatrix_zenoh.client.plan import Plan
from beatrix_zenoh.client.robot import Robot
from beatrix_zenoh.client.session import Client
from beatrix_zenoh.client.stopping import sentence, stop_robots
from beatrix_zenoh.client.twin import Twin
from beatrix_zenoh.client.twin_motion import TwinMotion
from beatrix_zenoh.contract._generated.messages import MotionQuery, PoseQuery, Reason, Source
from beatrix_zenoh.output import note, print_failure, print_json, say

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
COUNT_S = 1.0


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


def check_lead(lead: float, on: Which | None) -> None:
    """Raise BadParameter for an invalid --lead, or one without --on both."""
    if lead and on is not Which.BOTH:
        raise typer.BadParameter("--lead needs --on both: the hardware follows the simulation.")
    if not (math.isfinite(lead) and lead >= 0):
        raise typer.BadParameter(f"--lead {lead:g}: give a number of seconds, 0 or more.")


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


MOVES = {
    (False, False): "Both move now, the simulation first.",
    (True, False): "Only the hardware moves now: the simulation is there already.",
    (False, True): "Only the simulation moves now: the hardware is there already.",
    (True, True): "Both are there already.",
}
"""What the user reads, by whether simulation and hardware stand at the end of the path already."""


def commit(targets: Targets, query: MotionQuery | PoseQuery, lead_s: float) -> None:
    """Preview the motion on a copy of the simulation, print the result, then carry the motion out on both robots."""
    settings = targets.client.settings
    with Twin(targets.name, connect=settings.connect, who=settings.who) as twin:
        plan = twin.preview_query(structs.replace(query, source=Source.CLI))
        twin.check_ready()  # raises before the note below says what moves
        if lead_s:
            note(f"Preview: {plan.verdict} The simulation moves now.")
            count_down(plan, lead_s)
        else:
            note(f"Preview: {plan.verdict} {MOVES[plan.stands_at_end('sim'), plan.stands_at_end('hw')]}")
            plan.commit()


def count_down(plan: Plan, lead_s: float) -> None:
    """Carry out a plan with a lead, and print the remaining lead each second; Ctrl-C cancels the motion."""
    motion = plan.commit(lead_s, wait=False)
    try:
        while not (motion.hardware_sent or motion.done()):
            left_s = motion.countdown_s
            if left_s > 0:
                note(f"The hardware moves in {left_s:.1f} s, unless you press Ctrl-C before then.")
            next_s = left_s - COUNT_S * (math.ceil(left_s / COUNT_S) - 1)
            with contextlib.suppress(TimeoutError):
                motion.exception(max(0.05, next_s))
        if motion.hardware_sent:
            note("The hardware moves now.")
        motion.result()
    except KeyboardInterrupt as interrupt:
        raise KeyboardInterrupt(cancelled(motion)) from interrupt
    if motion.lag_s is not None:
        note(f"The hardware began {motion.lag_s:.2f} s after the simulation.")


def cancelled(motion: TwinMotion) -> str:
    """Cancel a motion and return a sentence with the positions of both robots; empty if the motion had ended."""
    if not motion.cancel():
        return ""
    with contextlib.suppress(TimeoutError):
        return str(motion.exception(0) or "")
    return ""


@contextlib.contextmanager
def stop_on_interrupt(robots: list[Robot], *, as_json: bool) -> Iterator[None]:
    """On Ctrl-C in this block, stop the robots, print their positions at rest, and raise KeyboardInterrupt again."""
    try:
        yield
    except KeyboardInterrupt as interrupt:
        # If the interrupt has a text, the function that raised it has stopped the robots and states their positions.
        rests = str(interrupt) or "\n".join(
            sentence(robot.place, answer.message) for robot, answer in stop_robots(reversed(robots))
        )
        if as_json:
            print_failure(Reason.STOPPED, rests)
        else:
            note(rests)
        raise


def show_positions(robots: list[Robot], *, as_json: bool) -> None:
    """Print the present head and arm angles of the robots (deg)."""
    readings = [(robot, robot.positions()) for robot in robots]
    if as_json:
        print_json({"result": True, "robots": [reading_row(robot, reading) for robot, reading in readings]})
        return
    for robot, reading in readings:
        say(f"{robot}: {reading}")


def reading_row(robot: Robot, reading: Reading) -> Mapping[str, object]:
    """Return a robot and its angles in degrees, for JSON output."""
    return {
        "robot": robot.name,
        "side": robot.side,
        "head_deg": {axis: round(angle, 3) + 0.0 for axis, angle in reading.head._asdict().items()},
        "arms_deg": {arm: round(angle, 3) + 0.0 for arm, angle in reading.arms._asdict().items()},
    }
