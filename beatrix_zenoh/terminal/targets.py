"""The robots that a verb applies to, and a session to reach them."""

from __future__ import annotations

import contextlib
import math
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING

import typer

from beatrix_zenoh.client.degrees import Reading
from beatrix_zenoh.client.request import absent_reason
from beatrix_zenoh.client.robot import Robot
from beatrix_zenoh.client.session import Client, chosen_name
from beatrix_zenoh.client.stopping import sentence, stop_robots
from beatrix_zenoh.contract import names
from beatrix_zenoh.contract._generated.messages import Reason, Source
from beatrix_zenoh.contract.errors import NoAnswer
from beatrix_zenoh.output import note, print_failure, print_json, say
from beatrix_zenoh.settings import Settings
from beatrix_zenoh.terminal.options import Which

if TYPE_CHECKING:  # importing it would delay verbs that need one robot
    from beatrix_zenoh.client.twin import Twin

Present = Sequence[tuple[str, str]]
"""Name and side of every robot online."""


@contextlib.contextmanager
def open_robots(
    settings: Settings, which: Which | None, *, acts: bool = False, both: bool = False
) -> Iterator[list[Robot]]:
    """Open a session, and yield the robots selected: one or both of a name, the simulation first.

    A note gives the name if the user has not.

    Args:
        settings: name of the robot, endpoint of the router, and seat.
        which: the value of --on.
        acts: the verb moves or changes the robots; print a note if, without --on, only the hardware is online. Not in
            a class, whose robots usually have no simulation.
        both: without --on select both robots of the name if both are online.

    Raises:
        NoAnswer: no router answers, no robot is online and no name was given, or a robot of --on both is not online.
        Refused: several robots are online, and no name was given.
    """
    with Client(settings, source=Source.CLI) as client:
        present = client.robots()
        name = chosen_name(client, acts=acts, present=present)
        if name != settings.robot:
            note(f"Using robot {name}, the only one online.")
        if both and which is None and {(name, side) for side in names.SIDES} <= {*present}:
            which = Which.BOTH
        sides = select_sides(name, which, present, client.bus.endpoint)
        if acts and which is None and sides == ("hw",) and settings.account is None:
            note(f"No simulation of {name} is online: using the hardware.")
        yield [Robot(name, side, client=client) for side in sides]


@contextlib.contextmanager
def one_or_twin(robots: list[Robot]) -> Iterator[Robot | Twin]:
    """Yield the robot selected, or both as a twin with sessions of its own."""
    if len(robots) == 1:
        yield robots[0]
        return
    from beatrix_zenoh.client.twin import Twin

    settings = robots[0].client.settings
    with Twin(robots[0].name, connect=settings.connect, who=settings.who) as twin:
        yield twin


def select_sides(name: str, which: Which | None, present: Present, endpoint: str) -> tuple[str, ...]:
    """Return the sides of --on; without it the hardware if only that is online, otherwise the simulation.

    Raises:
        NoAnswer: --on both was given, and one robot is not online, so that neither may move.
    """
    if which is Which.BOTH:
        missing = [f"{name} ({side})" for side in names.SIDES if (name, side) not in present]
        if missing:
            raise NoAnswer(
                absent_reason(name, present),
                f"--on both needs both robots. Not online at {endpoint}: {', '.join(missing)}. "
                "`beatrix ls` shows the robots online.",
            )
        return names.SIDES
    if which is not None:
        return (which.value,)
    return ("hw",) if (name, "hw") in present and (name, "sim") not in present else ("sim",)


def check_lead(lead: float, on: Which | None) -> None:
    """Raise BadParameter for an invalid --lead, or one without --on both."""
    if lead and on is not Which.BOTH:
        raise typer.BadParameter("--lead needs --on both: the hardware follows the simulation.")
    if not (math.isfinite(lead) and lead >= 0):
        raise typer.BadParameter(f"--lead {lead:g}: give a number of seconds, 0 or more.")


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
    """Return a robot and its angles, for JSON output."""
    return {"robot": robot.name, "side": robot.side, **degrees(reading)}


def degrees(reading: Reading) -> Mapping[str, object]:
    """Return the angles of a robot in degrees, for JSON output."""
    return {
        "head_deg": {axis: round(angle, 3) + 0.0 for axis, angle in reading.head._asdict().items()},
        "arms_deg": {arm: round(angle, 3) + 0.0 for arm, angle in reading.arms._asdict().items()},
    }
