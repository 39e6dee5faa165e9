"""The choices of the user, their changes, and those that a file keeps for the next window."""

from __future__ import annotations

import os
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Final

import msgspec
from msgspec import Meta
from msgspec.structs import fields, replace

from beatrix_zenoh import files
from beatrix_zenoh.contract.errors import WrongUsage
from gui.console.state.intents import HeadOrientation, Tab, Theme, WindowPage
from gui.console.texts import DEFAULT_LANGUAGE, LANGUAGES, Texts

FILE: Final = "window.json"
LONGEST: Final = 1 << 20
"""Largest size of this file (bytes)."""
SPEED_MAX: Final = 1000.0
"""Largest speed that is kept (deg/s)."""
LEAD_MAX_S: Final = 3600.0
"""Longest lead that is kept (s)."""

DURATION_MAX_S: Final = 60.0
"""Longest duration of a pose (s)."""
NOTES: Final = 8
"""Number of tones."""


class SavedPose(msgspec.Struct, frozen=True):
    """Arm angles (deg) under a name, and the time (s) in which a sequence reaches them from its previous pose."""

    name: str
    short: float
    middle: float
    long: float
    duration_s: Annotated[float, Meta(ge=0, le=DURATION_MAX_S)] = 1.0
    note: Annotated[int, Meta(ge=0, le=NOTES)] = 0
    """tone at its beginning, 1 to NOTES: c' to c''; 0: none"""

    @property
    def arms(self) -> tuple[float, float, float]:
        """Short, middle and long arm (deg)."""
        return self.short, self.middle, self.long


class Remembered(msgspec.Struct, frozen=True):
    """The choices that the next window begins with: a row each, with the values that are possible.

    A widget of `gui.window.widgets.choices` shows a row, with the texts `label.NAME` and `tip.NAME`.
    """

    theme: Theme = Theme.DARK
    language: Annotated[str, Meta(pattern=f"^({'|'.join(LANGUAGES)})$")] = DEFAULT_LANGUAGE
    increment: Annotated[float, Meta(gt=0, le=360)] = 5.0
    """how far + and - turn an arm (deg)"""
    speed: Annotated[float, Meta(gt=0, le=SPEED_MAX)] = 30.0
    """speed of the fastest arm (deg/s)"""
    lead_s: Annotated[float, Meta(ge=0, le=LEAD_MAX_S)] = 2.0
    """by how much the simulation leads the hardware (s); 0: they move at the same time"""
    send_on_release: bool = False
    """whether the target is sent when the user releases the head"""
    facing: bool = True
    """whether the user sees the head from the front; then the pad, the cards and the arrow keys are mirrored"""
    simple: bool = False
    """whether the window shows only what a beginner needs; a new user begins so"""
    sounds: bool = True
    """whether music and tones are heard while a sequence plays"""


class Saved(Remembered, frozen=True):
    """All that is kept for the next window."""

    poses: tuple[SavedPose, ...] = ()
    music: str = ""
    """path of the music beside the poses; empty: none"""
    guided: Annotated[int, Meta(ge=0, le=99)] = 0
    """how many of `missions.TASKS` are done, and `missions.CLOSED` more while the strip is closed"""


def path(platform: str = sys.platform, environment: Mapping[str, str] = os.environ) -> Path:
    """Return the path of the file in the user's folder on this platform."""
    return files.user_folder(platform, environment) / FILE


def merged(before: Saved, mine: Saved, theirs: Saved) -> Saved:
    """Return the choices of another window (`theirs`), with the changes of this one since `before`."""
    fields = {*Saved.__struct_fields__} - {"poses"}
    changed = {name: getattr(mine, name) for name in fields if getattr(mine, name) != getattr(before, name)}
    added = [pose for pose in mine.poses if pose not in before.poses]
    if theirs.poses == before.poses:  # so that a changed order is kept
        return replace(theirs, **changed, poses=mine.poses)
    gone = {pose.name for pose in before.poses if pose not in mine.poses} | {pose.name for pose in added}
    poses = (*(pose for pose in theirs.poses if pose.name not in gone), *added)
    return replace(theirs, **changed, poses=poses)


def load(file: Path) -> Saved:
    """Return the saved choices; those of a new user if there are none, or they cannot be read."""
    try:
        return msgspec.json.decode(files.text(file, LONGEST, "JSON"), type=Saved)
    except (OSError, WrongUsage, msgspec.DecodeError):
        return Saved(simple=True)


def save(file: Path, saved: Saved) -> None:
    """Write the choices, replacing the file; raises OSError."""
    file.parent.mkdir(parents=True, exist_ok=True)
    new = file.with_name(file.name + ".new")
    new.write_bytes(msgspec.json.format(msgspec.json.encode(saved)))
    new.replace(file)  # atomic: a window that is killed leaves the old file intact


class Choices(Remembered, frozen=True):
    """Settings of the user."""

    relative: bool = True
    """whether + and - turn an arm by the increment, or to it"""
    sim: bool = True
    hw: bool = False
    """whether the box of the simulation, or of the hardware, is checked"""
    room: bool = False
    """whether the simulated person and the left eye's picture are shown beside the head, also while no program runs"""
    cameras: bool = False
    microphones: bool = False
    """never saved: each window begins without listening"""
    live: bool = False
    """whether the simulation follows a drag; never saved: each window begins without motions that no press has sent"""
    loop: bool = False
    """whether a play of the sequence repeats until STOP or a newer request"""
    tab: Tab = Tab.HEADS
    drawer: bool = False
    """whether the code is open beside the head, in the simple window"""
    page: WindowPage = WindowPage.ROBOT
    target: HeadOrientation | None = None
    """target of the head pad; None: the target follows the head"""

    @property
    def sides(self) -> tuple[str, ...]:
        """The robots whose boxes are checked."""
        return ("sim",) * self.sim + ("hw",) * self.hw

    @property
    def follows(self) -> bool:
        """Whether the simulation follows a drag; in the simple window it always does."""
        return self.live or (self.simple and self.sim)

    @property
    def sends(self) -> bool:
        """Whether the end of a drag sends the target."""
        return self.send_on_release or self.simple

    @property
    def texts(self) -> Texts:
        """The texts of the chosen language."""
        return Texts(self.language)


KINDS: Final = {row.name: row.type for row in fields(Choices) if row.name not in ("page", "target")}
"""What a choice of a widget may be, by its name."""


def remembered(choices: Remembered) -> dict[str, Any]:
    """Return the choices that a file keeps, by name."""
    return {name: getattr(choices, name) for name in Remembered.__struct_fields__}


def changed(choices: Choices, name: str, value: object) -> Choices | None:
    """Return choices with another value; None if no widget offers it."""
    if name not in KINDS:
        return None
    try:
        return replace(choices, **{name: msgspec.convert(value, KINDS[name])})
    except msgspec.ValidationError:
        return None
