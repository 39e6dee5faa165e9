"""A lesson is read from the log alone: who asked what, from where, and every goal is recomputed from the requests."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import msgspec
import pytest
from robots import Stage, ask_raw, ready, until
from shell import Shell

from beatrix_zenoh import Refused, Robot
from beatrix_zenoh.client.choreography import Choreography, Pose, play
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import Event, EventKind, Events, Phase
from beatrix_zenoh.motion.gear import Arms, Gear
from beatrix_zenoh.motion.kinematics import Neck

HALF_DEG = 180 / Gear().steps_per_turn + 0.002
"""Half a microstep, and the rounding of a log to a thousandth of a degree."""
NUMBER = r"(-?[\d.]+)"
ASKED = re.compile(
    rf"(\S+) asked (look|move) (relative )?\w+ {NUMBER}°, \w+ {NUMBER}°, \w+ {NUMBER}° "
    rf"at (.+?)(?:, lead {NUMBER} s)?, (from .+?|over Zenoh)(, refused \w+)?: "
)
GOAL = re.compile(rf"Motion (\d+) to arms {NUMBER}°, {NUMBER}°, {NUMBER}°\.")


class Asked(NamedTuple):
    """A request as the log shows it; angles in degrees."""

    seat: str
    verb: str
    relative: bool
    angles: Arms
    speed: str
    lead: str | None
    source: str
    goal: Arms | None
    """arms; None: refused"""


def read_log(path: Path) -> list[Asked]:
    """Return the requests of motions in a log file."""
    found = []
    for line in path.read_text(encoding="utf-8").splitlines():
        if match := ASKED.search(line):
            seat, verb, relative, x, y, z, speed, lead, source, refused = match.groups()
            goal = GOAL.search(line)
            assert (goal is None) == (refused is not None), line
            arms = None if goal is None else (float(goal[2]), float(goal[3]), float(goal[4]))
            angles = float(x), float(y), float(z)
            found.append(Asked(seat, verb, bool(relative), angles, speed, lead, source, arms))
    return found


def goals(lesson: list[Asked]) -> Iterator[Arms]:
    """Recompute the goal (deg) of each accepted motion from the requests alone; every motion was awaited."""
    neck = Neck()
    arms: Arms = (0.0, 0.0, 0.0)
    pose: Arms | None = (0.0, 0.0, 0.0)
    for asked in lesson:
        if asked.goal is None:
            continue
        x, y, z = map(math.radians, asked.angles)
        if asked.verb == "look":
            a, b, c = (neck.forward(arms) if pose is None else pose) if asked.relative else (0.0, 0.0, 0.0)
            pose = a + x, b + y, c + z
            arms = neck.inverse(*pose)
        else:
            a, b, c = arms if asked.relative else (0.0, 0.0, 0.0)
            pose, arms = None, (a + x, b + y, c + z)
        short, middle, long = map(math.degrees, arms)
        yield short, middle, long


def events_of(robot: Robot) -> list[Event]:
    (answer,) = ask_raw(robot.client, keys.events_json(robot.name, robot.side))
    return msgspec.json.decode(answer.payload, type=Events).events


def teach(stage: Stage, robot: Robot) -> None:
    """Move a robot on every way in, as the seat ana."""
    robot.look(yaw=20, speed=60)
    for _ in range(5):
        robot.look(yaw=0.04, relative=True, speed=60)
    robot.move(2, -2, 0.5, relative=True, speed=(60, 50, 40))
    robot.look(pitch=3, relative=True, speed=60)
    with pytest.raises(Refused):
        robot.look(pitch=60)
    ask_raw(robot.client, keys.pose(robot.name, robot.side, "ana") + "?yaw=0.1;pitch=0.05;speed=1.5")
    Shell(stage.endpoint).good("look", "--yaw", "5", "--speed", "60", "--name", "bea", "--on", "hw")
    play(robot, Choreography([("nod", Pose(0.0, 0.0, 5.0, 0.0, 60.0))]))
    until(lambda: robot.status().holder == "", "free", 5.0)
    robot.client.bus.put(keys.arm_target(robot.name, robot.side, "short"), b"0.1", "text/plain")
    until(lambda: abs(robot.positions().commanded.short - math.degrees(0.1)) < 0.1, "the arm is there", 5.0)


@pytest.fixture
def stage() -> Iterator[Stage]:
    with Stage() as made:
        yield made


def test_the_goals_of_a_lesson_follow_from_its_log_alone(stage: Stage, tmp_path: Path) -> None:
    log = tmp_path / "lesson.log"
    where = ("--name", "bea", "--connect", stage.endpoint, "--log-file", str(log))
    stage.process("hw_node", *where, "--port", "virtual:").expect("ready")
    robot = ready(stage.robot("bea", "hw", "ana"))
    teach(stage, robot)
    lesson = read_log(log)
    assert [asked.source for asked in lesson] == [
        *["from Python"] * 9,
        "over Zenoh",
        "from the command line",
        "from a choreography",
        "from a per-arm topic",
    ]
    assert [asked.seat for asked in lesson] == ["ana"] * 12 + ["arm-topics"]
    assert [asked.speed for asked in lesson[6:8]] == ["60, 50, 40°/s", "60°/s"]
    logged = [asked.goal for asked in lesson if asked.goal is not None]
    assert len(logged) == 12
    for goal, wanted in zip(logged, goals(lesson), strict=True):
        assert goal == pytest.approx(wanted, abs=HALF_DEG)


def asked(robot: Robot) -> list[Event]:
    return [
        event
        for event in events_of(robot)
        if event.kind is EventKind.MOTION and event.phase is Phase.ACCEPTED
    ]
