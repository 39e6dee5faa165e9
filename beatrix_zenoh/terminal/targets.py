"""The robots that a verb applies to, and a session to reach them."""

from __future__ import annotations

import contextlib
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

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
from beatrix_zenoh.settings import resolve
from beatrix_zenoh.terminal.options import Which

Present = Sequence[tuple[str, str]]
"""Name and side of every robot online."""


@dataclass(frozen=True)
class Selection:
    """Robot name, router endpoint and seat from the command line; None: not given."""

    name: str | None
    connect: str | None
    who: str | None


@dataclass(frozen=True)
class Targets:
    """A session, and the robots selected."""

    client: Client
    name: str
    sides: tuple[str, ...]

    def robots(self) -> list[Robot]:
        """Return the robots selected, the simulation first."""
        return [Robot(self.name, side, client=self.client) for side in self.sides]


@contextlib.contextmanager
def open_targets(
    selection: Selection, which: Which | None, *, acts: bool = False, both: bool = False
) -> Iterator[Targets]:
    """Open a session and select the robots; print a note with the robot's name if it was not given.

    Args:
        selection: from the command line.
        which: the value of --on.
        acts: the verb moves or changes the robots; print a note if, without --on, only the hardware is online. Not in
            a class, whose robots usually have no simulation.
        both: without --on select both robots of the name if both are online.

    Raises:
        NoAnswer: no router answers, no robot is online and no name was given, or a robot of --on both is not online.
        Refused: several robots are online, and no name was given.
    """
    settings = resolve(selection.name, selection.connect, selection.who)
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
        yield Targets(client, name, sides)


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
