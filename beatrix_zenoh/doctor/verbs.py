"""`beatrix doctor`: check this computer, the router and the robots; with --jog find swapped or reversed motor plugs.

The questions of --jog go to stderr, so that stdout contains only the result.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping
from typing import Annotated, NamedTuple, TypeVar

import typer

from beatrix_zenoh.client.degrees import ArmAngles
from beatrix_zenoh.client.robot import Robot
from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.errors import Refused, bad_value, wrong_usage
from beatrix_zenoh.doctor.checks import CheckResult, network
from beatrix_zenoh.doctor.computer import this_computer
from beatrix_zenoh.output import FAILED, note, print_json, say
from beatrix_zenoh.settings import Settings, resolve
from beatrix_zenoh.terminal.options import Connect, Json, Name, Which, Who
from beatrix_zenoh.terminal.targets import open_robots, stop_on_interrupt

MARKS = {"ok": "ok", "advice": "-", "todo": "!"}


def doctor(
    by_jog: Annotated[
        bool,
        typer.Option("--jog", help="Turn the arms of the real robot one by one and ask what you see."),
    ] = False,
    name: Name = None,
    connect: Connect = None,
    who: Who = None,
    as_json: Json = False,
) -> None:
    """Check router, account and robots, then this computer. The exit code is 1 if something must be done."""
    if by_jog:
        jog(resolve(name, connect, who), as_json=as_json)
        return
    settings = resolve(None, connect, who)
    sections = [(settings.connect, [*network(settings, name)]), ("this computer", [*this_computer()])]
    findings = [finding for _, section in sections for finding in section]
    wrong = [finding for finding in findings if finding.todo]
    if as_json:
        print_json({"result": not wrong, "findings": [finding.as_row() for finding in findings]})
    else:
        show(sections)
        say("\nNo problems found." if not wrong else f"\n{len(wrong)} to do: see the lines that begin with !")
    if wrong:
        raise typer.Exit(FAILED)


def show(sections: list[tuple[str, list[CheckResult]]]) -> None:
    """Print the title of each section, a line for each of its findings, and below that line what to do."""
    width = max(len(finding.what) for _, section in sections for finding in section)
    for title, section in sections:
        say(f"{title}:")
        for finding in section:
            say(f"  {MARKS[finding.state]:<2}  {finding.what:<{width}}  {finding.found}")
            if what_to_do := finding.todo or finding.advice:
                say(f"      {'':<{width}}  -> {what_to_do}")


ARMS = ArmAngles._fields
PLUGS = ("X", "Y", "Z")
JOG_DEG, SPEED_DEG_S = 15.0, 20.0
ARM_ANSWERS: dict[str, str | None] = {**{arm: arm for arm in ARMS}, "none": None}
DIRECTION_ANSWERS = {
    **dict.fromkeys(("counter-clockwise", "counterclockwise", "anticlockwise", "ccw"), True),
    **dict.fromkeys(("clockwise", "cw"), False),
}
"""Each answer, and whether it means counter-clockwise."""
PREPARE = "`beatrix enable --on hw`, `beatrix calibrate --on hw`"
AGAIN = f"Then type {PREPARE}, and repeat `beatrix doctor --jog`."
T = TypeVar("T")


class Observation(NamedTuple):
    """The user's answers about a motion in which one arm should have turned counter-clockwise."""

    arm: str | None
    """None: no arm turned"""
    counter_clockwise: bool


def jog(settings: Settings, *, as_json: bool) -> None:
    """Turn one arm after the other, ask the user about each, and print what to do.

    The exit code is 1 if there is something to do.

    Raises:
        Refused: the robot cannot move, with its reason, or the user named an arm twice.
        WrongUsage: standard input has ended.
    """
    with open_robots(settings, Which.HW) as (robot,):
        try:
            robot.move(0, 0, 0, relative=True)  # turns no arm, but a robot that cannot move refuses it
        except Refused as error:
            if error.reason in (Reason.NOT_ENABLED, Reason.NOT_CALIBRATED):
                raise Refused(error.reason, f"{error.message} Type: {PREPARE}.") from error
            raise
        note(
            "Watch the robot from above. It turns home, then one arm after the other turns 15° and back. "
            "Ctrl-C stops."
        )
        with stop_on_interrupt([robot], as_json=as_json):
            robot.look(speed=SPEED_DEG_S)
            todo = replug([observe(robot, index) for index in range(len(ARMS))])
    if as_json:
        print_json({"result": not todo, "todo": todo})
    else:
        say("\n".join(todo) or "All three motors are plugged in correctly.")
    if todo:
        raise typer.Exit(FAILED)


def observe(robot: Robot, index: int) -> Observation:
    """Turn one arm and turn it back, then ask the user about it and return the answers."""
    angles = [JOG_DEG if arm == index else 0.0 for arm in range(len(ARMS))]
    robot.move(*angles, relative=True, speed=SPEED_DEG_S)
    robot.move(*(-angle for angle in angles), relative=True, speed=SPEED_DEG_S)
    arm = ask("Which arm turned? short, middle, long or none:", ARM_ANSWERS)
    if arm is None:
        return Observation(None, counter_clockwise=True)
    return Observation(
        arm, ask("Did it first turn counter-clockwise (ccw) or clockwise (cw)?", DIRECTION_ANSWERS)
    )


def ask(question: str, answers: Mapping[str, T]) -> T:
    """Ask until the user types an answer or its beginning; return its meaning.

    Raises WrongUsage if standard input has ended.
    """
    while True:
        print(question, end=" ", file=sys.stderr, flush=True)
        line = sys.stdin.readline()
        if not line:
            note("")
            raise wrong_usage(
                "The input ended before all questions were answered. Repeat the command within sight of the robot.",
            )
        words = line.strip().lower()
        found = {meaning for answer, meaning in answers.items() if words and answer.startswith(words)}
        if len(found) == 1:
            return found.pop()
        note(f"Type one of: {', '.join(answers)}.")


def replug(seen: list[Observation]) -> list[str]:
    """Return the steps that correct the plugs on the shield, with the power off; empty if all plugs are correct.

    Raises:
        Refused: the user named an arm twice.
    """
    turned = [arm for arm, _ in seen if arm is not None]
    if len(set(turned)) < len(turned):
        raise bad_value(
            f"You saw {', '.join(turned)}: each arm turns once. Repeat the command, and type none if no arm turns.",
        )
    advice = []
    for plug, due, (arm, counter_clockwise) in zip(PLUGS, ARMS, seen, strict=True):
        if arm is None:
            advice.append(
                f"No arm turned for {plug}, on which the {due} arm belongs: check the motor power (USB powers only the "
                f"board), the plug of this motor, and the driver on {plug} and its reference voltage (docs/how-to/board.md)."
            )
        elif arm != due:
            advice.append(f"Move the motor of the {arm} arm from {plug} to {PLUGS[ARMS.index(arm)]}.")
        if not counter_clockwise:
            advice.append(f"Reverse the plug of the {arm} arm's motor: it turns in the wrong direction.")
    return ["Switch the power off first.", *advice, AGAIN] if advice else []
