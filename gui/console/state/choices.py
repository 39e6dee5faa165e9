"""The choices of the user, and their changes."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from gui.console.state import intents
from gui.console.state.intents import Intent, Tab, Theme, WindowPage
from gui.console.state.saved import Saved
from gui.console.state.views import HeadOrientation
from gui.console.texts import DEFAULT_LANGUAGE, LANGUAGES, Texts


@dataclass(frozen=True)
class Choices:
    """Settings of the user; angles in deg, speed in deg/s, lead in s."""

    theme: Theme = Theme.DARK
    language: str = DEFAULT_LANGUAGE
    relative: bool = True
    increment: float = 5.0
    speed: float = 30.0
    sim: bool = True
    hw: bool = False
    cameras: bool = False
    microphones: bool = False
    """never saved: each window begins without listening"""
    lead_s: float = 2.0
    live: bool = False
    """never saved: each window begins without motions that no press has sent"""
    send_on_release: bool = False
    page: WindowPage = WindowPage.ROBOT
    tab: Tab = Tab.HEADS
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


def choices_from(saved: Saved) -> Choices:
    """Return choices with saved values; defaults for the others."""
    return Choices(
        theme=saved.theme,
        language=saved.language if saved.language in LANGUAGES else DEFAULT_LANGUAGE,
        increment=saved.increment,
        speed=saved.speed,
        lead_s=saved.lead_s,
        send_on_release=saved.send_on_release,
    )


def changed(choices: Choices, intent: Intent) -> Choices | None:
    """Return the choices after an intent; None if the intent changes no choice."""
    new: Choices | None
    match intent:
        case intents.SetRelative(relative=relative):
            new = replace(choices, relative=relative)
        case intents.SetIncrement(degrees=degrees) if degrees > 0 and math.isfinite(degrees):
            new = replace(choices, increment=degrees)
        case intents.SetSpeed(degrees_per_s=speed) if speed > 0 and math.isfinite(speed):
            new = replace(choices, speed=speed)
        case intents.SetLead(seconds=seconds) if seconds >= 0 and math.isfinite(seconds):
            new = replace(choices, lead_s=seconds)
        case intents.SetDestination(side=side, checked=checked):
            new = replace(choices, sim=checked) if side == "sim" else replace(choices, hw=checked)
        case intents.ShowTab(name=name):
            new = replace(choices, tab=name)
        case intents.SetTheme(theme=theme):
            new = replace(choices, theme=theme)
        case intents.SetLanguage(code=code) if code in LANGUAGES:
            new = replace(choices, language=code)
        case intents.AimHead(yaw=yaw, pitch=pitch, roll=roll) if math.isfinite(yaw + pitch + roll):
            new = replace(choices, target=HeadOrientation(yaw, pitch, roll))
        case (
            intents.SetIncrement()
            | intents.SetSpeed()
            | intents.SetLead()
            | intents.SetLanguage()
            | intents.AimHead()
        ):
            new = choices  # no widget reports such a value, so it is ignored
        case _:
            new = _switched(choices, intent)
    return new


def _switched(choices: Choices, intent: Intent) -> Choices | None:
    """Return the choices after an intent that switches one on or off; None if it is another intent."""
    match intent:
        case intents.SetCameras(on=on):
            return replace(choices, cameras=on)
        case intents.SetMicrophones(on=on):
            return replace(choices, microphones=on)
        case intents.SetLive(on=on):
            return replace(choices, live=on)
        case intents.SetSendOnRelease(on=on):
            return replace(choices, send_on_release=on)
    return None
