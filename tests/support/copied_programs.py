"""Random histories of a window, whose programs repeat the motions of both robots.

`python tests/support/copied_programs.py 20` tries 20 histories; the exit code is 1 if a program does something else.
"""

from __future__ import annotations

import math
import random
import subprocess
import sys

from gui_links import BareWindow, Linked, at_home
from robots import Stage, until

from beatrix_zenoh import Robot
from beatrix_zenoh.contract._generated.messages import Command, EventKind, Phase, Reason
from beatrix_zenoh.contract.names import SIDES
from gui.console.state import intents
from gui.console.state.intents import Intent

SetPoints = tuple[tuple[float, ...], ...]
"""Angles of the arms (deg) at the end of each motion of a robot."""
REQUESTS = 4
"""Requests of a history."""


def run_copied(program: str) -> None:
    """Run a copied program unchanged, in a process of its own."""
    ended = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, timeout=60.0, check=False
    )
    assert ended.returncode == 0, ended.stderr


def presses(chance: random.Random) -> list[Intent]:
    """Return one request, and the choices before it."""
    on = chance.choice(((True, False), (False, True), (True, True)))
    choices: list[Intent] = [
        *(intents.Choose(side, value=checked) for side, checked in zip(SIDES, on, strict=True)),
        intents.Choose("relative", value=chance.random() < 0.7),
        intents.Choose("increment", float(chance.choice((1.8, 5, 9)))),
        intents.Choose("speed", float(chance.choice((20, 40, 60)))),
        intents.Choose("lead_s", chance.choice((0.0, 0.5))),
    ]
    head = (float(chance.randint(-20, 20)), float(chance.randint(-8, 8)), float(chance.randint(-8, 8)))
    jog = intents.Jog(chance.choice(("short", "middle", "long", "all")), chance.choice((1, -1)))
    aim: list[Intent] = [intents.AimHead(*head), intents.SendHead()]
    home = intents.RunCommand(Command.HOME)
    return [*choices, *chance.choices(([jog], aim, [home], [intents.Undo()]), (5, 3, 1, 1))[0]]


def repeat(linked: Linked, seed: int) -> tuple[list[SetPoints], list[SetPoints]]:
    """Press the buttons of a random history, then run its program; return the set points of both robots, both times."""
    chance, window = random.Random(seed), BareWindow(linked)
    with_events = [Robot("bea", side, connect=linked.world.endpoint) for side in SIDES]
    try:
        at_home(linked)
        before = [counted(robot) for robot in with_events]
        for _ in range(REQUESTS):
            for intent in presses(chance):
                window.want(intent)
            window.ends()
        until(lambda: window.view().code.text.count("\n") > 3, "the program has lines")
        program = window.view().code.text
        pressed = [set_points(robot, first) for robot, first in zip(with_events, before, strict=True)]
        at_home(linked)
        before = [counted(robot) for robot in with_events]
        run_copied(program)
        return pressed, [set_points(robot, first) for robot, first in zip(with_events, before, strict=True)]
    finally:
        for robot in with_events:
            robot.close()


def counted(robot: Robot) -> int:
    """Return the number of the newest event of a robot."""
    return robot.past_events()[-1].seq


def set_points(robot: Robot, first: int) -> SetPoints:
    """Return where the motions that succeeded after an event have ended."""
    return tuple(
        tuple(
            round(math.degrees(angle), 1) + 0.0
            for angle in (event.position.x, event.position.y, event.position.z)
        )
        for event in robot.past_events()
        if event.seq > first
        and (event.kind, event.phase, event.reason) == (EventKind.MOTION, Phase.DONE, Reason.OK)
        and event.position is not None
    )


def main() -> int:
    """Try the number of histories given on the command line; return how many programs did something else."""
    wrong = 0
    with Stage() as stage:
        stage.simulation("bea")
        stage.hardware("bea")
        with Linked(stage.endpoint) as linked:
            linked.online("sim", "hw")
            for seed in range(int(sys.argv[1])):
                pressed, repeated = repeat(linked, seed)
                wrong += pressed != repeated
                print(
                    seed, "repeats" if pressed == repeated else f"is wrong: {repeated}", pressed, flush=True
                )
    return wrong


if __name__ == "__main__":
    sys.exit(bool(main()))
