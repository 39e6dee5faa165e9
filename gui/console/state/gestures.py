"""Gestures that one press plays, and the programs that follow a face and turn to a sound."""

from __future__ import annotations

from pathlib import Path
from typing import Final, Literal

from msgspec import structs

from beatrix_zenoh.client import RobotState
from beatrix_zenoh.client.choreography import GESTURES
from gui.console.state import own_gestures, refusals
from gui.console.state.actions import (
    FOLLOW,
    NEW,
    POSES,
    TURN,
    Action,
    EndProgram,
    Play,
    RunProgram,
)
from gui.console.state.intents import Intent
from gui.console.state.memory import Handles, Memory, begin, lead_of, unreachable
from gui.console.state.views import ButtonView, GesturesView, button
from gui.console.state.world import World
from gui.console.texts import Texts

CONTROL = "gestures"
EYE = "left"
"""The eye with which the shipped program sees."""
Example = Literal["follow", "turn"]
PROGRAMS: Final[dict[Example, Path]] = {"follow": FOLLOW, "turn": TURN}
TESTS = ("pattern", "tone")
"""Sources of eyes and ears that never see or hear a person."""


class RunExample(Intent, frozen=True):
    """Run a shipped program that sees or hears, with the checked robots."""

    program: Example


def view(memory: Memory, world: World) -> GesturesView:
    """Return the buttons, and the refusal of one of them."""
    texts = memory.choices.texts
    off = "" if memory.choices.sides else "off.unchecked"
    follow, turn = (
        button(texts, "gesture.end", EndProgram())  # it can always be ended
        if world.program.runs(file)
        else button(texts, f"gesture.{program}", RunExample(program), off)
        for program, file in PROGRAMS.items()
    )
    return GesturesView(
        gestures=tuple((name, _gesture(name, off, texts)) for name in GESTURES),
        own=own_gestures.view(world, off, texts),
        fetch=own_gestures.fetch(world, texts),
        follow=follow,
        turn=turn,
        running=world.program.file if world.program.running else None,
        refusal=refusals.at(memory, (CONTROL,)),
    )


def _gesture(name: str, off: str, texts: Texts) -> ButtonView:
    return button(texts, f"gesture.{name}", Play(NEW, (), gesture=name), off)


def title(playing: str, texts: Texts) -> str:
    """Return the title of a play in the language of the texts."""
    if playing == POSES:
        return texts("label.poses")
    return texts(f"gesture.{playing}") if playing in GESTURES else playing


def play(memory: Memory, world: World, intent: Play) -> list[Action]:
    """Return the action that plays a gesture with the checked robots."""
    sides = memory.choices.sides
    request = structs.replace(intent, sides=sides, lead_s=lead_of(memory, sides))
    return begin(memory, world, request, CONTROL)


def run_example(memory: Memory, world: World, intent: RunExample) -> list[Action]:
    """Return the action that runs the program; of two robots the hardware sees or hears, if it can."""
    sides = memory.choices.sides
    if unreachable(memory, world, sides, CONTROL):
        return []
    can, lacks = (hears, "ear") if intent.program == "turn" else (sees, "eye")
    able = [side for side in ("hw", "sim") if side in sides and can(world.side(side))]
    if not able:
        return memory.refuse(CONTROL, f"cannot.no_{lacks}" if len(sides) == 1 else f"cannot.no_{lacks}s")
    others = tuple(side for side in sides if side != able[0])
    return begin(memory, world, RunProgram(NEW, PROGRAMS[intent.program], (able[0], *others)), CONTROL)


def sees(robot: RobotState) -> bool:
    """Return whether the left eye of a robot has a camera that works, and shows more than the test picture."""
    cameras = () if robot.status is None else robot.status.cameras
    return any(camera.eye == EYE and camera.connected and camera.source not in TESTS for camera in cameras)


def hears(robot: RobotState) -> bool:
    """Return whether a robot has microphones that work, and hear more than the test tone."""
    ears = None if robot.status is None else robot.status.microphones
    return ears is not None and ears.connected and ears.source not in TESTS


HANDLES: Handles = {Play: play, RunExample: run_example}
