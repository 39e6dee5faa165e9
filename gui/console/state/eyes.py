"""The pictures and the levels of the microphones: subscriptions, titles, and why one is missing."""

from __future__ import annotations

from typing import Final

from beatrix_zenoh.contract._generated.messages import CameraStatus
from beatrix_zenoh.contract.names import EYES, SIDES
from gui.console.state import pills
from gui.console.state.intents import Tab, WindowPage
from gui.console.state.memory import Memory
from gui.console.state.saved import Choices
from gui.console.state.views import Condition, EyeView, LevelView, SoundView
from gui.console.state.world import World, online
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
