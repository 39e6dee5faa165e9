"""The link of the window and the simulated person: dragging, speaking, and the program that turns to the voice."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from gui_links import Linked, rests
from present import present
from robots import Stage, until

from beatrix_zenoh import Robot
from beatrix_zenoh.client.request import ask
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import Reason, SoundReply
from gui.console.link import programs
from gui.console.state.actions import (
    TURN,
    EndProgram,
    LetSpeak,
    MovePerson,
    RunProgram,
    SendStop,
    Watch,
)

START_S = 60.0


def played(robot: Robot) -> str:
    """Return what plays in the room."""
    reply = ask(robot.client, (robot.name, "sim"), keys.sound(robot.name), None, SoundReply, 5.0)
    return reply.play


def at(bearing: float) -> MovePerson:
    """Return the action that places the person in this direction (deg)."""
    return MovePerson(1.2 * math.cos(math.radians(bearing)), 1.2 * math.sin(math.radians(bearing)), 0.16)


def test_the_head_turns_to_the_voice_of_the_dragged_person_until_stop(stage: Stage, linked: Linked) -> None:
    with Robot("bea", side="sim", connect=stage.endpoint, who="ana") as robot:
        linked.do(Watch(person=True))
        linked.until(lambda world: world.person is not None, "the person is seen")
        linked.do(RunProgram(1, TURN, ("sim",)))
        for bearing in (35.0, -30.0):
            linked.do(place := at(bearing))
            assert present(linked.world.person).y == place.y
            linked.until(
                lambda world, bearing=bearing: (  # type: ignore[misc]
                    rests(world, "sim") and abs(present(world.sim.reading).head.yaw - bearing) < 10
                ),
                f"the head turns to {bearing}",
                START_S,
            )
        assert present(linked.world.person).speaks
        assert played(robot) == "voice"
        linked.do(SendStop(2))
        assert linked.end_of(1).reason is Reason.STOPPED
        until(lambda: played(robot) == "silence", "the person is silent")
        assert robot.target().y == pytest.approx(at(-30.0).y, abs=1e-3)
        linked.do(Watch())
        assert linked.world.person is None


@pytest.mark.parametrize("drags", [False, True])
def test_a_person_walks_while_the_head_follows_until_the_user_drags_it(
    stage: Stage, linked: Linked, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, drags: bool
) -> None:
    waits = tmp_path / "waits.py"
    waits.write_text("import time\ntime.sleep(60)", encoding="utf-8")
    monkeypatch.setattr(programs, "FOLLOW", waits)
    with Robot("bea", side="sim", connect=stage.endpoint, who="ana") as robot:
        stands = robot.move_target(1.0, 0.1, 0.2)
        linked.do(RunProgram(1, waits, ("sim",)))
        until(lambda: robot.target().y != stands.y, "the person walks")
        if drags:
            linked.do(at(20.0))
            until(lambda: robot.target().y == pytest.approx(at(20.0).y), "the person is dragged")
            stands = robot.target()
        linked.do(EndProgram())
        assert linked.end_of(1).accepted
        assert robot.target() == stands


def test_the_person_speaks_until_told_to_be_silent(stage: Stage, linked: Linked) -> None:
    with Robot("bea", side="sim", connect=stage.endpoint, who="ana") as robot:
        linked.do(LetSpeak(on=True))
        linked.until(lambda _: played(robot) == "voice", "the voice is heard")
        linked.do(LetSpeak(on=False))
        until(lambda: played(robot) == "silence", "the person is silent")
