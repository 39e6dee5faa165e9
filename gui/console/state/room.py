"""The room beside the head: the simulated person, and what the left eye sees, while a program sees or hears them."""

from __future__ import annotations

from typing import Final

from beatrix_zenoh.contract.names import SIDES
from gui.console.state import eyes
from gui.console.state.actions import (
    Action,
    LetSpeak,
    WatchCameras,
    WatchClass,
    WatchMicrophones,
    WatchPerson,
)
from gui.console.state.gestures import EYE, sees
from gui.console.state.intents import Tab, WindowPage
from gui.console.state.memory import Memory
from gui.console.state.saved import Choices
from gui.console.state.views import RoomView, button
from gui.console.state.world import World, kept, online

NOTHING: Final[tuple[Action, ...]] = (
    WatchClass(on=False),
    WatchCameras(frozenset()),
    WatchMicrophones(frozenset()),
    WatchPerson(on=False),
)
"""What the window receives at the start."""


def shown(choices: Choices, world: World) -> bool:
    """Return whether the room is visible: beside the head, if its box is checked or a program runs."""
    heads = choices.page is WindowPage.ROBOT and choices.tab is Tab.HEADS
    return heads and (choices.room or world.face.running)


def watched(choices: Choices, world: World) -> tuple[Action, ...]:
    """Return what the window receives: exactly what it shows."""
    visible = shown(choices, world)
    pictures = eyes.wanted(choices) | ({(_side(world), EYE)} if visible else set())
    return (
        WatchClass(choices.page is WindowPage.CLASS),
        WatchCameras(frozenset(pictures)),
        WatchMicrophones(eyes.microphones(choices)),
        WatchPerson(visible and online(world, "sim")),
    )


def view(memory: Memory, world: World) -> RoomView | None:
    """Return person and eye; None: they are hidden."""
    if not shown(memory.choices, world):
        return None
    person, texts = world.person, memory.choices.texts
    speaks = person is not None and person.speaks
    speak = button(texts, "room.silence" if speaks else "room.speak", LetSpeak(not speaks))
    side = _side(world)
    found = kept(world, side)
    yaw = None if found is None else float(round(found.head.yaw))
    return RoomView(person, yaw, speak, eyes.eye_view(memory, world, side, EYE, on=True))


def _side(world: World) -> str:
    """Return the robot whose eye is shown: that of the program, otherwise one that sees."""
    found = (side for side in SIDES if sees(world.side(side)))
    return world.face.sides[0] if world.face.sides else next(found, SIDES[0])
