"""Music beside the sequence, its beat, and tones of poses."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Final

from msgspec import structs

from gui.console.state import sequence
from gui.console.state import sequence_timing as timing
from gui.console.state.actions import Action, UseSounds
from gui.console.state.intents import Intent
from gui.console.state.memory import Handles, Memory
from gui.console.state.saved import DURATION_MAX_S, NOTES
from gui.console.state.views import MusicView, button
from gui.console.state.world import World, commanded

SILENT: Final = UseSounds(on=True)
"""What the link does at the start."""


class ChooseMusic(Intent, frozen=True):
    """Dance to the music in a file."""

    file: Path | None
    """None: to none"""


class SnapToBeat(Intent, frozen=True):
    """Let each pose last a whole number of beats."""


class SetNote(Intent, frozen=True):
    """Give a pose a tone, which is heard when it begins."""

    name: str
    note: int
    """as of `SavedPose`"""


def view(memory: Memory, world: World) -> MusicView:
    """Return what is known of the music, and what can be done with it."""
    texts, music = memory.choices.texts, world.music
    text, title, off = texts("music.button"), texts("music.none"), "off.no_music"
    name = Path(music.file).name
    if music.beat_s:
        tempo = 60 / music.beat_s
        text, title, off = texts("music.tempo", tempo=tempo), texts("music.beats", tempo=tempo, file=name), ""
    elif music.file:
        title, off = texts("music.steady" if music.ready else "music.reading", file=name), "off.no_beat"
    if (trouble := music.trouble) is not None and not music.ready:
        title = texts(trouble.key, **trouble.slots)
    off = off if memory.poses else sequence.NONE
    none = "" if music.file else "off.no_music"
    return MusicView(
        text=text,
        title=title,
        snap=button(texts, "music.snap", SnapToBeat(), off),
        remove=button(texts, "music.remove", ChooseMusic(None), none),
    )


def watched(memory: Memory) -> UseSounds:
    """Return what the link plays with sequences."""
    return UseSounds(memory.choices.sounds, memory.music)


def _choose(memory: Memory, _world: World, intent: ChooseMusic) -> list[Action]:
    memory.music = "" if intent.file is None else str(intent.file)
    return []


def _snap(memory: Memory, world: World, _intent: SnapToBeat) -> list[Action]:
    """Round durations to beats; to more of them if the limits of the robot need it."""
    beat_s, poses, start = world.music.beat_s, memory.poses, commanded(world, sequence.STARTS["sim"])
    if not beat_s:
        return memory.refuse(sequence.CONTROL, "off.no_beat" if world.music.file else "off.no_music")
    least = timing.shortest_of(poses, start, timing.limits_of(world), loop=memory.choices.loop)

    def snapped(duration_s: float, least_s: float) -> float:
        needed = max(1, round(duration_s / beat_s), math.ceil(least_s / beat_s - 1e-6))
        return min(needed, math.floor(DURATION_MAX_S / beat_s)) * beat_s

    pairs = zip(poses, least, strict=True)
    return sequence.change(
        memory,
        tuple(structs.replace(pose, duration_s=snapped(pose.duration_s, least_s)) for pose, least_s in pairs),
    )


def _set_note(memory: Memory, _world: World, intent: SetNote) -> list[Action]:
    if not 0 <= intent.note <= NOTES:
        return []
    return sequence.change(
        memory,
        tuple(
            structs.replace(pose, note=intent.note) if pose.name == intent.name else pose
            for pose in memory.poses
        ),
    )


HANDLES: Handles = {ChooseMusic: _choose, SnapToBeat: _snap, SetNote: _set_note}
