"""Eyes, ears and the room: what the window receives, pictures, levels, and the simulated person."""

from __future__ import annotations

import itertools
from typing import Final

from beatrix_zenoh.contract._generated.messages import CameraStatus
from beatrix_zenoh.contract.names import EYES, SIDES
from gui.console.state import pills
from gui.console.state.actions import (
    FOLLOW,
    TURN,
    LetSpeak,
    Watch,
)
from gui.console.state.gestures import EYE, sees
from gui.console.state.intents import Tab, WindowPage
from gui.console.state.memory import Memory
from gui.console.state.saved import Choices
from gui.console.state.views import Condition, EyeView, LevelView, RoomView, SoundView, button
from gui.console.state.world import World, kept, online
from gui.console.texts import DEFAULT_LANGUAGE, Texts

SHOWN: Final = tuple((side, eye) for side in SIDES for eye in EYES)
"""Twin and eye of each picture of the window."""
QUIETEST_DB: Final = -80.0
"""Level at which a bar is empty; at 0 dB it is full."""


def wanted(choices: Choices) -> frozenset[tuple[str, str]]:
    """Return the visible pictures: none unless Eye cameras is checked."""
    shown = choices.page is not WindowPage.CLASS and choices.tab is Tab.EYES and choices.cameras
    return frozenset(SHOWN) if shown else frozenset()


def view(memory: Memory, world: World) -> tuple[EyeView, ...]:
    """Return both eyes of both robots."""
    on = bool(wanted(memory.choices))
    return tuple(eye_view(memory, world, side, eye, on=on) for side, eye in SHOWN)


def eye_view(memory: Memory, world: World, side: str, eye: str, *, on: bool) -> EyeView:
    """Return one eye; `on`: whether its picture is wanted."""
    texts = memory.choices.texts
    return EyeView(
        side=side,
        eye=eye,
        title=texts(f"eye.title_{eye}", side=texts(f"side.{side}")),
        watched=on and online(world, side),
        text=_reason(memory, world, side, eye, on=on),
    )


def _reason(memory: Memory, world: World, side: str, eye: str, *, on: bool) -> str:
    """Return why there is no picture; empty if there is one."""
    texts, status = memory.choices.texts, world.side(side).status
    found = pills.finding(world, side, texts)
    if found.condition in (Condition.ABSENT, Condition.SILENT):
        return found.reason or found.text
    if not (on or memory.choices.cameras):
        return texts("eye.cameras_off")
    if status is None:
        return texts("eye.waiting")
    return _trouble(next((camera for camera in status.cameras if camera.eye == eye), None), texts)


def _trouble(camera: CameraStatus | None, texts: Texts) -> str:
    """Return why a camera delivers no pictures; empty if it delivers them."""
    if camera is None:
        return texts("eye.none")
    if camera.trouble and not camera.connected:  # first, as `streaming` may still be true for two seconds
        return camera.trouble if texts.code == DEFAULT_LANGUAGE else texts("eye.trouble")
    if camera.streaming:
        return ""
    return texts("eye.waiting" if camera.connected else "eye.disconnected")


def microphones(choices: Choices) -> frozenset[str]:
    """Return the sides whose levels are visible."""
    looks = choices.page is WindowPage.ROBOT and choices.tab is Tab.EYES
    return frozenset(SIDES if looks and choices.microphones else ())


def sound(memory: Memory, world: World) -> SoundView:
    """Return the box, and the levels of both robots."""
    choices = memory.choices
    return SoundView(choices.microphones, tuple(_level(memory, world, side) for side in SIDES))


def _level(memory: Memory, world: World, side: str) -> LevelView:
    texts, level, status = memory.choices.texts, world.levels.get(side), world.side(side).status
    title = texts(f"side.{side}")
    if level is not None and side in microphones(memory.choices):
        text = texts("sound.level", left=round(level[0]), right=round(level[1]))
        return LevelView(side, title, share(level[0]), share(level[1]), text)
    if not memory.choices.microphones:
        text = texts("sound.off")
    elif not online(world, side) or status is None:
        text = texts("sound.absent")
    elif status.microphones is None:
        text = texts("sound.none")
    elif status.microphones.trouble and texts.code != DEFAULT_LANGUAGE:
        text = texts("sound.trouble")
    else:
        text = status.microphones.trouble or texts("sound.waiting")
    return LevelView(side, title, 0.0, 0.0, text)


def share(level_db: float) -> float:
    """Return the length of a bar, 0 to 1."""
    return min(1.0, max(0.0, 1.0 - level_db / QUIETEST_DB))


# -- the room beside the head --------------------------------------------------------------------------


def shows_room(choices: Choices, world: World) -> bool:
    """Return whether the room is visible: beside the head, if its box is checked or a program runs."""
    heads = choices.page is WindowPage.ROBOT and choices.tab is Tab.HEADS
    return heads and (choices.room or any(map(world.program.runs, (FOLLOW, TURN))))


def watched(choices: Choices, world: World) -> Watch:
    """Return what the window receives: exactly what it shows."""
    visible = shows_room(choices, world)
    pictures = wanted(choices) | ({(_side(world), EYE)} if visible else set())
    return Watch(
        choices.page is WindowPage.CLASS,
        frozenset(pictures),
        microphones(choices),
        person=visible and online(world, "sim"),
    )


def room(memory: Memory, world: World) -> RoomView | None:
    """Return person and eye; None: they are hidden."""
    if not shows_room(memory.choices, world):
        return None
    person, texts = world.person, memory.choices.texts
    speaks = person is not None and person.speaks
    speak = button(texts, "room.silence" if speaks else "room.speak", LetSpeak(not speaks))
    side = _side(world)
    found = kept(world, side)
    yaw = None if found is None else float(round(found.head.yaw))
    return RoomView(person, yaw, speak, eye_view(memory, world, side, EYE, on=True))


def _side(world: World) -> str:
    """Return the robot whose eye is shown: that of the program, otherwise one that sees."""
    found = (side for side in SIDES if sees(world.side(side)))
    program = world.program
    first = program.sides[:1] if program.running and program.file in (FOLLOW, TURN) else ()
    return next(itertools.chain(first, found), SIDES[0])
