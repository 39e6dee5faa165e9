"""The levels of the microphones, which are on only while the user looks at them."""

from __future__ import annotations

from typing import Final

from beatrix_zenoh.contract.names import SIDES
from gui.console.state.actions import Action, WatchMicrophones
from gui.console.state.intents import Choose, Tab, WindowPage
from gui.console.state.memory import Memory
from gui.console.state.saved import Choices
from gui.console.state.views import LevelView, SoundView
from gui.console.state.world import World, online
from gui.console.texts import DEFAULT_LANGUAGE

QUIETEST_DB: Final = -80.0
"""Level at which a bar is empty; at 0 dB it is full."""


def wanted(choices: Choices) -> frozenset[str]:
    """Return the sides whose levels are visible."""
    looks = choices.page is WindowPage.ROBOT and choices.tab is Tab.EYES
    return frozenset(SIDES if looks and choices.microphones else ())


def watch(choices: Choices, intent: Choose) -> list[Action]:
    """Return the change of subscriptions that follows from an intent."""
    changes = intent.name == "microphones" or (choices.microphones and intent.name == "tab")
    return [WatchMicrophones(wanted(choices))] if changes else []


def view(memory: Memory, world: World) -> SoundView:
    """Return the box, and the levels of both robots."""
    choices = memory.choices
    return SoundView(choices.microphones, tuple(_level(memory, world, side) for side in SIDES))


def _level(memory: Memory, world: World, side: str) -> LevelView:
    texts, level, status = memory.choices.texts, world.levels.get(side), world.side(side).status
    title = texts(f"side.{side}")
    if level is not None and side in wanted(memory.choices):
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
