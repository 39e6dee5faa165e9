"""The choices of the user, and their changes."""

from __future__ import annotations

from typing import Final

import msgspec
from msgspec.structs import fields, replace

from gui.console.state.intents import HeadOrientation, Tab, WindowPage
from gui.console.state.saved import Remembered, Saved
from gui.console.texts import DEFAULT_LANGUAGE, LANGUAGES, Texts


class Choices(Remembered, frozen=True):
    """Settings of the user."""

    relative: bool = True
    """whether + and - turn an arm by the increment, or to it"""
    sim: bool = True
    hw: bool = False
    """whether the box of the simulation, or of the hardware, is checked"""
    cameras: bool = False
    microphones: bool = False
    """never saved: each window begins without listening"""
    live: bool = False
    """whether the simulation follows a drag; never saved: each window begins without motions that no press has sent"""
    loop: bool = False
    """whether a play of the sequence repeats until STOP or a newer request"""
    tab: Tab = Tab.HEADS
    page: WindowPage = WindowPage.ROBOT
    target: HeadOrientation | None = None
    """target of the head pad; None: the target follows the head"""

    @property
    def sides(self) -> tuple[str, ...]:
        """The robots whose boxes are checked."""
        return ("sim",) * self.sim + ("hw",) * self.hw

    @property
    def texts(self) -> Texts:
        """The texts of the chosen language."""
        return Texts(self.language)


KINDS: Final = {row.name: row.type for row in fields(Choices) if row.name not in ("page", "target")}
"""What a choice of a widget may be, by its name."""


def choices_from(saved: Saved) -> Choices:
    """Return choices with saved values; defaults for the others."""
    kept = {name: getattr(saved, name) for name in Remembered.__struct_fields__}
    return Choices(**kept | {"language": saved.language if saved.language in LANGUAGES else DEFAULT_LANGUAGE})


def changed(choices: Choices, name: str, value: object) -> Choices | None:
    """Return choices with another value; None if no widget offers it."""
    if name not in KINDS or (name == "language" and value not in LANGUAGES):
        return None
    try:
        return replace(choices, **{name: msgspec.convert(value, KINDS[name])})
    except msgspec.ValidationError:
        return None
