"""Which robots a verb is about, and a session to talk to them."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from beatrix_zenoh import names
from beatrix_zenoh._generated.messages import Reason
from beatrix_zenoh.cli.options import Which
from beatrix_zenoh.cli.verb import note
from beatrix_zenoh.client import Client
from beatrix_zenoh.errors import NoAnswer, Refused
from beatrix_zenoh.robot import Robot
from beatrix_zenoh.settings import Settings, resolve

Present = Sequence[tuple[str, str]]
"""Name and twin of every robot on line."""


@dataclass(frozen=True)
class Where:
    """What was typed: None where nothing was."""

    name: str | None
    connect: str | None
    who: str | None


@dataclass(frozen=True)
class Line:
    """A session, and the robots chosen."""

    client: Client
    name: str
    twins: tuple[str, ...]

    def robots(self) -> list[Robot]:
        """The robots chosen, the simulation first."""
        return [Robot(self.name, twin, client=self.client) for twin in self.twins]


@contextlib.contextmanager
def on_line(where: Where, which: Which | None) -> Iterator[Line]:
    """Open a session and choose; says on stderr which robot was taken if none was named.

    Raises:
        NoAnswer: no router, or nobody on line.
        Refused: several robots are on line and none was named.
    """
    settings = resolve(where.name, where.connect, where.who)
    with Client(settings) as client:
        present = client.bus.robots()
        name = settings.robot
        if not named(where, settings) and not any(robot == name for robot, _ in present):
            name = only_one(present, client.bus.endpoint)
            note(f"Robot {name}, the only name on line.")
        yield Line(client, name, choose(name, which, present, client.bus.endpoint))


@contextlib.contextmanager
def on_the_move(where: Where, which: Which | None) -> Iterator[Line]:
    """As `on_line`, for verbs that act; says so where the hardware is taken for want of a simulation."""
    with on_line(where, which) as line:
        if which is None and line.twins == ("hw",):
            note(f"No simulation of {line.name} is on line: this goes to the hardware.")
        yield line


def named(where: Where, settings: Settings) -> bool:
    """Somebody named the robot: flag, environment or file."""
    by_setting = settings.robot == os.environ.get("BEATRIX_ROBOT") or settings.robot != names.default_robot()
    return bool(where.name) or by_setting


def only_one(present: Present, endpoint: str) -> str:
    """The name of the only robot on line; raises as `on_line`."""
    found = sorted({robot for robot, _ in present})
    if not found:
        raise NoAnswer(
            Reason.NO_ANSWER,
            f"No robot is on line at {endpoint}. Start a simulation with `beatrix sim` or `beatrix up`.",
        )
    if len(found) > 1:
        raise Refused(
            Reason.BAD_VALUE,
            f"Several robots are on line: {', '.join(found)}. Choose one with --name or BEATRIX_ROBOT.",
        )
    return found[0]


def choose(name: str, which: Which | None, present: Present, endpoint: str) -> tuple[str, ...]:
    """Twins a verb is about: those asked for, else the simulation if it is on line, otherwise the hardware.

    Raises:
        NoAnswer: both were asked for and one is not on line: then neither may move.
    """
    if which is Which.BOTH:
        missing = [f"{name} ({twin})" for twin in names.TWINS if (name, twin) not in present]
        if missing:
            raise NoAnswer(
                Reason.NO_ANSWER,
                f"--on both needs both robots: {' and '.join(missing)} not on line at {endpoint}. "
                "`beatrix ls` shows who is.",
            )
        return names.TWINS
    if which is not None:
        return (which.value,)
    return ("hw",) if (name, "hw") in present and (name, "sim") not in present else ("sim",)
