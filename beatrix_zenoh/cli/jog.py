"""`beatrix doctor --jog`: three small motions, looked at by a person, tell whether motors and arms are plugged in right."""

from __future__ import annotations

from typing import NamedTuple

import typer

from beatrix_zenoh._generated.messages import Reason
from beatrix_zenoh._generated.robot import ROBOT
from beatrix_zenoh.cli.line import Where, on_line
from beatrix_zenoh.cli.options import Which
from beatrix_zenoh.cli.verb import say
from beatrix_zenoh.errors import Refused
from beatrix_zenoh.readings import ArmAngles
from beatrix_zenoh.robot import Robot

ARMS = ArmAngles._fields
PLUGS = ("X", "Y", "Z")
JOG_DEG, SPEED_DEG_S = 15.0, 20.0


class Seen(NamedTuple):
    """What a person saw when one arm was told to turn counter-clockwise."""

    arm: str
    counter_clockwise: bool


def jog(where: Where) -> None:
    """Turn one arm after the other, ask what was seen, say what to replug.

    Raises:
        Refused: the robot may not move yet, and what it lacks.
    """
    with on_line(where, Which.HW) as line:
        (robot,) = line.robots()
        say("Look at the robot from above. One arm after the other turns 15 deg and back; Ctrl-C stops.")
        seen = [look(robot, index) for index in range(len(ARMS))]
        azimuth = typer.prompt(
            "Where does the short arm point now, at home? Degrees from straight ahead, to the robot's left",
            type=float,
        )
    advice = [*replug(seen), *describe(azimuth)]
    say("\n".join(advice) if advice else "All three are plugged in right.")


def look(robot: Robot, index: int) -> Seen:
    """Jog one arm there and back."""
    there = [JOG_DEG if arm == index else 0.0 for arm in range(len(ARMS))]
    robot.move(*there, relative=True, speed=SPEED_DEG_S)
    robot.move(*(-angle for angle in there), relative=True, speed=SPEED_DEG_S)
    arm = ask("Which arm turned? short, middle or long", ARMS)
    return Seen(arm, ask("Which way first? counter or clockwise", ("counter", "clockwise")) == "counter")


def ask(question: str, answers: tuple[str, ...]) -> str:
    """One of the answers; their beginnings will do."""
    while True:
        typed: str = typer.prompt(question).strip().lower()
        found = [answer for answer in answers if typed and answer.startswith(typed)]
        if len(found) == 1:
            return found[0]
        say(f"Type one of: {', '.join(answers)}.")


def replug(seen: list[Seen]) -> list[str]:
    """What to change on the shield, with the power off.

    Raises:
        Refused: an arm was seen twice, so another was overlooked.
    """
    if sorted(arm for arm, _ in seen) != sorted(ARMS):
        raise Refused(
            Reason.BAD_VALUE,
            f"You saw {', '.join(arm for arm, _ in seen)}: each arm should turn once. If one did not turn, its driver or "
            "plug has no contact; else try again.",
        )
    advice = []
    for plug, due, (arm, _) in zip(PLUGS, ARMS, seen, strict=True):
        if arm != due:
            advice.append(f"Move the motor of the {arm} arm from {plug} to {PLUGS[ARMS.index(arm)]}.")
    for arm, counter_clockwise in seen:
        if not counter_clockwise:
            advice.append(f"Turn the plug of the {arm} arm's motor round: it turns the wrong way.")
    return ["Switch the power off first.", *advice, "Then calibrate and jog again."] if advice else []


def describe(azimuth_deg: float) -> list[str]:
    """What to write into a robot file if the arms point elsewhere than on the shipped robot."""
    if abs((azimuth_deg - ROBOT.geometry.arm0_azimuth + 180) % 360 - 180) < JOG_DEG:
        return []
    return [
        "Your arms sit elsewhere than on the shipped robot. Write this into a file, and start with --robot-file FILE:",
        f"[geometry]\narm0_azimuth = {azimuth_deg:.1f}",
    ]
