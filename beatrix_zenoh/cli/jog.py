"""`beatrix doctor --jog`: three small motions, looked at by a person, tell whether motors and arms are plugged in right.

Questions go to stderr: what is found is the result.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Mapping
from typing import NamedTuple, TypeVar

import typer

from beatrix_zenoh._generated.messages import Reason
from beatrix_zenoh._generated.robot import ALLOWED, ROBOT
from beatrix_zenoh.cli.line import Where, on_line
from beatrix_zenoh.cli.motions import stopping
from beatrix_zenoh.cli.options import Which
from beatrix_zenoh.cli.verb import FAILED, document, note, say
from beatrix_zenoh.errors import Refused, WrongUsage
from beatrix_zenoh.readings import ArmAngles
from beatrix_zenoh.robot import Robot
from beatrix_zenoh.robot_file import fingerprint

ARMS = ArmAngles._fields
PLUGS = ("X", "Y", "Z")
JOG_DEG, SPEED_DEG_S = 15.0, 20.0
TURNED: dict[str, str | None] = {**{arm: arm for arm in ARMS}, "none": None}
WAYS = {
    **dict.fromkeys(("counter-clockwise", "counterclockwise", "anticlockwise", "ccw"), True),
    **dict.fromkeys(("clockwise", "cw"), False),
}
"""Whether it is counter-clockwise."""
READY = "`beatrix enable --on hw`, `beatrix calibrate --on hw`"
AGAIN = f"Then {READY}, and jog again."
NOTHING = (
    "Nothing turned at all. Is the motor power on? USB alone runs the firmware, not the motors. If it is on, switch it off "
    "and see that drivers and motors are plugged in as docs/how-to/board.md says."
)

T = TypeVar("T")


class Seen(NamedTuple):
    """What a person saw when one arm was told to turn counter-clockwise."""

    arm: str | None
    """None: no arm turned"""
    counter_clockwise: bool


def jog(where: Where, *, as_json: bool) -> None:
    """Turn one arm after the other, ask what was seen, say what to do; exit code 1 if there is something.

    Raises:
        Refused: the robot may not move yet, and what it lacks.
        WrongUsage: nobody answers.
    """
    with on_line(where, Which.HW) as line:
        (robot,) = line.robots()
        try:
            robot.move(0, 0, 0, relative=True)  # turns nothing: who may not move says so before anybody looks
        except Refused as error:
            if error.reason in (Reason.NOT_ENABLED, Reason.NOT_CALIBRATED):
                raise Refused(error.reason, f"{error.message} That is: {READY}.") from error
            raise
        note(
            "Look at the robot from above. It turns home; then one arm after the other turns 15 deg and back. "
            "Ctrl-C stops."
        )
        with stopping([robot], as_json=as_json):
            robot.look(speed=SPEED_DEG_S)
            seen = [look(robot, index) for index in range(len(ARMS))]
            todo = replug(seen)
            if not todo:
                info = robot.info()
                shape = info.geometry
                known = ROBOT.geometry.arm0_azimuth if shape is None else math.degrees(shape.arm0_azimuth)
                todo = describe(ask_azimuth(known), known, as_shipped=info.fingerprint == fingerprint(ROBOT))
    if as_json:
        document({"result": not todo, "todo": todo})
    else:
        say("\n".join(todo) or "All three are plugged in right.")
    if todo:
        raise typer.Exit(FAILED)


def look(robot: Robot, index: int) -> Seen:
    """Jog one arm there and back."""
    there = [JOG_DEG if arm == index else 0.0 for arm in range(len(ARMS))]
    robot.move(*there, relative=True, speed=SPEED_DEG_S)
    robot.move(*(-angle for angle in there), relative=True, speed=SPEED_DEG_S)
    arm = ask("Which arm turned? short, middle, long or none:", TURNED)
    if arm is None:
        return Seen(None, counter_clockwise=True)
    return Seen(arm, ask("Which way first? counter-clockwise (ccw) or clockwise (cw):", WAYS))


def ask(question: str, answers: Mapping[str, T]) -> T:
    """One of the answers; their beginnings will do. Raises as `typed`."""
    while True:
        words = typed(question)
        found = {meaning for answer, meaning in answers.items() if words and answer.startswith(words)}
        if len(found) == 1:
            return found.pop()
        note(f"Type one of: {', '.join(answers)}.")


def ask_azimuth(known_deg: float) -> float:
    """Where the short arm is, deg, if not where the robot knows it; raises as `typed`."""
    low, high, _ = ALLOWED["geometry"]["arm0_azimuth"]
    while True:
        words = typed(
            "Where does the short arm point now, at home? Degrees from straight ahead, to the robot's left "
            f"(the robot says {known_deg:.6g}; what is less than {JOG_DEG:g} from it counts as that):"
        )
        try:
            azimuth = float(words.replace(",", "."))  # as half of Europe types it
        except ValueError:
            azimuth = float("nan")
        if low <= azimuth <= high:
            return azimuth
        note(f"Type a number from {low:g} to {high:g}.")


def typed(question: str) -> str:
    """A line of what a person types; raises WrongUsage if there is nobody."""
    print(question, end=" ", file=sys.stderr, flush=True)
    line = sys.stdin.readline()
    if not line:
        note("")
        raise WrongUsage(
            Reason.BAD_VALUE,
            "The input has ended before all was answered: jog again with somebody at the terminal who sees the robot.",
        )
    return line.strip().lower()


def replug(seen: list[Seen]) -> list[str]:
    """What to change on the shield, with the power off.

    Raises:
        Refused: an arm was seen twice, so another was overlooked.
    """
    turned = [arm for arm, _ in seen if arm is not None]
    if not turned:
        return [NOTHING, AGAIN]
    if len(set(turned)) < len(turned):
        raise Refused(
            Reason.BAD_VALUE,
            f"You saw {', '.join(turned)}: each arm should turn once. Jog again, and type none where no arm turns.",
        )
    unseen = [arm for arm in ARMS if arm not in turned]
    strays = [arm for arm in unseen if seen[ARMS.index(arm)].arm is not None]
    advice = [
        missing(plug, due if due in unseen else strays.pop(0))
        if arm is None
        else f"Move the motor of the {arm} arm from {plug} to {PLUGS[ARMS.index(arm)]}."
        for plug, due, (arm, _) in zip(PLUGS, ARMS, seen, strict=True)
        if arm != due
    ]
    advice += [
        f"Turn the plug of the {arm} arm's motor round: it turns the wrong way."
        for arm, counter_clockwise in seen
        if not counter_clockwise
    ]
    return ["Switch the power off first.", *advice, AGAIN] if advice else []


def missing(plug: str, arm: str) -> str:
    """What to look at where nothing turned, and an arm was not seen to turn."""
    return (
        f"Nothing turned on {plug}, and the {arm} arm did not turn: see that its motor is plugged in (it belongs on "
        f"{PLUGS[ARMS.index(arm)]}), that the driver on {plug} sits straight and the right way round, and that its reference "
        "voltage is set (docs/how-to/board.md)."
    )


def describe(azimuth_deg: float, known_deg: float, *, as_shipped: bool) -> list[str]:
    """What to write into a robot file if the arms point elsewhere than the robot knows."""
    if abs((azimuth_deg - known_deg + 180) % 360 - 180) < JOG_DEG:
        return []
    line = f"[geometry]\narm0_azimuth = {azimuth_deg:.1f}"
    if as_shipped:
        elsewhere = "elsewhere than on the shipped robot. Write this into a file, and start"
    else:
        file = f"your robot file says ({known_deg:.6g} deg)"
        elsewhere = f"elsewhere than {file}. Write this into it, and start anew"
    return [f"Your arms sit {elsewhere} hardware and simulation with --robot-file FILE:", line]
