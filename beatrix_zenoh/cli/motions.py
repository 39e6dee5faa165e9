"""Verbs that turn the head: look, move, home."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator, Mapping
from typing import Annotated

import typer

from beatrix_zenoh._generated import keys
from beatrix_zenoh._generated.messages import MotionQuery, PoseQuery, Reason
from beatrix_zenoh.cli.line import Line, Where, on_the_move
from beatrix_zenoh.cli.options import Connect, Json, Name, On, Who
from beatrix_zenoh.cli.unattended import hand_over
from beatrix_zenoh.cli.verb import document, note, refusal, say
from beatrix_zenoh.readings import Reading
from beatrix_zenoh.robot import Robot, motion_query, pose_query, stop_together
from beatrix_zenoh.twin import Plan, Twin

Relative = Annotated[bool, typer.Option("--relative", help="By these angles, instead of to them.")]
Speed = Annotated[
    float | None, typer.Option(help="Top speed of the fastest arm in degrees/s; else the robot's default.")
]
NoWait = Annotated[
    bool,
    typer.Option("--no-wait", help="Return once it is accepted; the motion goes on without you and Ctrl-C."),
]
ROADS = {"pose": keys.pose, "motion": keys.motion}


def look(
    yaw: Annotated[float, typer.Option(help="Degrees, left is positive.")] = 0.0,
    pitch: Annotated[float, typer.Option(help="Degrees, nose down is positive.")] = 0.0,
    roll: Annotated[float, typer.Option(help="Degrees, right ear down is positive.")] = 0.0,
    relative: Relative = False,
    speed: Speed = None,
    no_wait: NoWait = False,
    name: Name = None,
    connect: Connect = None,
    who: Who = None,
    on: On = None,
    as_json: Json = False,
) -> None:
    """Turn the head: yaw, pitch, roll. Degrees; angles not given are 0. Ctrl-C stops it."""
    query = pose_query(yaw, pitch, roll, relative=relative, speed=speed)

    def preview(twin: Twin) -> Plan:
        return twin.preview(yaw, pitch, roll, relative=relative, speed=speed)

    with on_the_move(Where(name, connect, who), on) as line:
        carry_out(line, "pose", query, preview, no_wait=no_wait, as_json=as_json)


def move(
    short: Annotated[float, typer.Argument(help="Short arm, degrees.")],
    middle: Annotated[float, typer.Argument(help="Middle arm, degrees.")],
    long: Annotated[float, typer.Argument(help="Long arm, degrees.")],
    relative: Relative = False,
    speed: Speed = None,
    no_wait: NoWait = False,
    name: Name = None,
    connect: Connect = None,
    who: Who = None,
    on: On = None,
    as_json: Json = False,
) -> None:
    """Turn the three arms. Degrees from home, counter-clockwise from above positive. Ctrl-C stops them."""
    query = motion_query(short, middle, long, relative=relative, speed=speed)

    def preview(twin: Twin) -> Plan:
        return twin.preview_arms(short, middle, long, relative=relative, speed=speed)

    with on_the_move(Where(name, connect, who), on) as line:
        carry_out(line, "motion", query, preview, no_wait=no_wait, as_json=as_json)


def home(
    name: Name = None, connect: Connect = None, who: Who = None, on: On = None, as_json: Json = False
) -> None:
    """Turn the head home. All arms go to 0 degrees; Ctrl-C stops them."""
    query = motion_query(0, 0, 0, relative=False, speed=None)
    with on_the_move(Where(name, connect, who), on) as line:
        carry_out(
            line, "motion", query, lambda twin: twin.preview_arms(0, 0, 0), no_wait=False, as_json=as_json
        )


def carry_out(
    line: Line,
    road: str,
    query: MotionQuery | PoseQuery,
    preview: Callable[[Twin], Plan],
    *,
    no_wait: bool,
    as_json: bool,
) -> None:
    """A motion on the robots chosen, and where they are afterwards; both: previewed, then committed."""
    robots = line.robots()
    if len(robots) > 1 and no_wait:
        raise typer.BadParameter("--no-wait goes with one robot; both are waited for together.")
    if no_wait:
        sentence = hand_over(robots[0], ROADS[road], query)
        if not as_json:
            say(f"{robots[0]}: {sentence}")
            return
    elif len(robots) > 1:
        with stopping(robots, as_json=as_json):
            commit(line, preview)
    else:
        with stopping(robots, as_json=as_json):
            robots[0].begin(road, query).wait()
    announce(robots, as_json=as_json)


def commit(line: Line, preview: Callable[[Twin], Plan]) -> None:
    """Preview on the simulation's copy, say what it will be, then both."""
    settings = line.client.settings
    with Twin(line.name, connect=settings.connect, who=settings.who) as twin:
        plan = preview(twin)
        twin.check_ready()  # before it is said that both move
        note(f"Preview: {plan.verdict} Now both, the simulation first.")
        plan.commit()


@contextlib.contextmanager
def stopping(robots: list[Robot], *, as_json: bool) -> Iterator[None]:
    """Ctrl-C in here stops the robots, whatever they are doing, and says where they rest."""
    try:
        yield
    except KeyboardInterrupt as interrupt:
        # Empty: it came when nobody was waiting for a motion.
        told = str(interrupt) or "\n".join(
            f"{robot}: {reply.message}" for robot, reply in stop_together(reversed(robots))
        )
        if as_json:
            refusal(Reason.STOPPED, told)
        else:
            note(told)
        raise


def announce(robots: list[Robot], *, as_json: bool) -> None:
    """Say where the robots are now."""
    readings = [(robot, robot.positions()) for robot in robots]
    if as_json:
        document({"result": True, "robots": [where(robot, reading) for robot, reading in readings]})
        return
    for robot, reading in readings:
        say(f"{robot}: {reading}")


def where(robot: Robot, reading: Reading) -> Mapping[str, object]:
    """A robot and its angles in degrees, for JSON."""
    return {
        "robot": robot.name,
        "on": robot.twin,
        "head_deg": {axis: round(angle, 3) + 0.0 for axis, angle in reading.head._asdict().items()},
        "arms_deg": {arm: round(angle, 3) + 0.0 for arm, angle in reading.arms._asdict().items()},
    }
