"""Gestures that one press plays, and the program that follows a face."""

from __future__ import annotations

from pathlib import Path

from msgspec import structs

from beatrix_zenoh.client import RobotState
from beatrix_zenoh.client.choreography import GESTURES
from gui.console.state import refusals
from gui.console.state.actions import FOLLOW, NEW, POSES, Action, EndProgram, OpenProgram, Play, RunProgram
from gui.console.state.intents import Intent
from gui.console.state.memory import Handles, Memory, begin, lead_of, unreachable
from gui.console.state.views import ButtonView, GesturesView, button
from gui.console.state.world import World
from gui.console.texts import Texts

CONTROL, FILES = "gestures", "commands"
"""controls of gestures, and of files to play"""
EYE = "left"
"""The eye with which the shipped program sees."""
TEST_PICTURE = "pattern"
"""The source of an eye of a virtual board, which never sees a person."""


class RunExample(Intent, frozen=True):
    """Run a shipped program that sees, with the checked robots."""

    file: Path


def view(memory: Memory, world: World) -> GesturesView:
    """Return the buttons, and the refusal of one of them."""
    texts = memory.choices.texts
    off = "" if memory.choices.sides else "off.unchecked"
    follow = button(texts, "gesture.follow", RunExample(FOLLOW), off)
    if runs := world.program.runs(FOLLOW):  # it can always be ended
        follow = button(texts, "gesture.end", EndProgram())
    return GesturesView(
        gestures=tuple((name, _gesture(name, off, texts)) for name in GESTURES),
        follow=follow,
        following=runs,
        open=button(texts, "gesture.open", OpenProgram(FOLLOW)),
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
    """Return the action that plays a gesture or a file with the checked robots."""
    sides, control = memory.choices.sides, CONTROL if intent.gesture else FILES
    request = structs.replace(intent, sides=sides, lead_s=lead_of(memory, sides))
    return begin(memory, world, request, control)


def run_example(memory: Memory, world: World, intent: RunExample) -> list[Action]:
    """Return the action that runs the program; the hardware's eye sees if both robots move and both can see."""
    sides = memory.choices.sides
    if unreachable(memory, world, sides, CONTROL):
        return []
    seeing = [side for side in ("hw", "sim") if side in sides and sees(world.side(side))]
    if not seeing:
        return memory.refuse(CONTROL, "cannot.no_eye" if len(sides) == 1 else "cannot.no_eyes")
    others = tuple(side for side in sides if side != seeing[0])
    return begin(memory, world, RunProgram(NEW, intent.file, (seeing[0], *others)), CONTROL)


def sees(robot: RobotState) -> bool:
    """Return whether the left eye of a robot has a camera that works, and shows more than the test picture."""
    cameras = () if robot.status is None else robot.status.cameras
    return any(camera.eye == EYE and camera.connected and camera.source != TEST_PICTURE for camera in cameras)


HANDLES: Handles = {Play: play, RunExample: run_example}
