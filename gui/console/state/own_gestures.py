"""The user's own gestures: sequences under a name and an emoji, each of them a file."""

from __future__ import annotations

from typing import Final

from msgspec import structs

from beatrix_zenoh.client import own_gestures as files
from beatrix_zenoh.client.choreography import GESTURES
from beatrix_zenoh.client.degrees import ArmAngles
from gui.console.state import sequence
from gui.console.state import sequence_timing as timing
from gui.console.state.actions import NEW, Action, FetchGestures, KeepGesture, Play, ShareGesture
from gui.console.state.intents import Intent, SaveGesture
from gui.console.state.memory import Handles, Memory, begin
from gui.console.state.refusals import wrong_file
from gui.console.state.saved import SavedPose
from gui.console.state.views import ButtonView, OwnGestureView, button
from gui.console.state.world import OwnGesture, World
from gui.console.texts import Texts

CONTROL: Final = "gestures"
WRONG: Final = "⚠"
"""The picture of a gesture whose file cannot be played; a press says why."""
EMOJI: Final = tuple("😀😂😍😎😜😇😏😋😢😭😡😱😴😳😵🙃🐱🐭🐵🐮❤⚡☀☃")
"""Those that are offered: Windows and macOS have them in colour, and DejaVu Sans, which Linux has, in black and white."""
TAKEN: Final = {"demo", *GESTURES}
"""Names of shipped choreographies, which `beatrix play` finds first."""


class DeleteGesture(Intent, frozen=True):
    """Move a gesture to the deleted ones."""

    name: str


class OpenGesture(Intent, frozen=True):
    """Replace the sequence by a gesture."""

    name: str


def view(world: World, off: str, texts: Texts) -> tuple[OwnGestureView, ...]:
    """Return the buttons of all own gestures; `off` is the reason why none can be played, if that is a key."""
    return tuple(_view(gesture, off, world, texts) for gesture in world.gestures)


def fetch(world: World, texts: Texts) -> ButtonView | None:
    """Return the button that gets the gestures of the class; None: there is no class."""
    key = "gesture.collect" if world.is_teacher else "gesture.fetch"
    return None if world.account is None else button(texts, key, FetchGestures())


def _view(gesture: OwnGesture, off: str, world: World, texts: Texts) -> OwnGestureView:
    name, emoji, file = gesture.name, gesture.emoji, f"{gesture.name}.csv"
    share = () if world.account is None else (button(texts, "gesture.share", ShareGesture(name)),)
    menu = (
        *share,
        button(texts, "gesture.edit", OpenGesture(name)),
        button(texts, "gesture.rename", SaveGesture(name, emoji, old=name)),
        button(texts, "gesture.delete", DeleteGesture(name)),
    )
    key, slots = ("gesture.own_tip", {"file": file})
    if gesture.wrong is not None:
        emoji, (key, slots) = WRONG, wrong_file(gesture.wrong, file)
    tooltip = texts(off or key, **slots)
    play = ButtonView(name, tooltip, Play(NEW, (), gesture=name), enabled=not off)
    return OwnGestureView(name, emoji, play, () if gesture.common else menu)


def _wrong_name(memory: Memory, world: World, name: str, old: OwnGesture | None) -> bool:
    """Return whether the gesture `old` (None: a new one) cannot get this name; if so, show why."""
    key, count = "", sum(not gesture.common for gesture in world.gestures)
    if not files.possible(name):
        key = "cannot.gesture_name"
    elif name.casefold() in TAKEN:
        key = "cannot.gesture_taken"
    elif old is None and count >= files.MOST:
        key = "cannot.gesture_many"
    if key:
        memory.refuse(CONTROL, key, name=name, most=str(files.MOST), shipped=", ".join(sorted(TAKEN)))
    return bool(key)


def _save(memory: Memory, world: World, intent: SaveGesture) -> list[Action]:
    name, old = intent.name.strip(), _find(world, intent.old or intent.name.strip())
    if _wrong_name(memory, world, name, old):
        return []
    text = (old.text if old else "") if intent.old else _sequence(memory, world)
    if not text:
        return []
    text = files.with_emoji(text, intent.emoji)
    return begin(memory, world, KeepGesture(NEW, name, text, old.name if old else ""), CONTROL)


def _sequence(memory: Memory, world: World) -> str:
    """Return the sequence as a file that ends at home, as each gesture does; empty after a refusal."""
    limits = timing.limits_of(world)
    if not memory.poses:
        memory.refuse(CONTROL, sequence.NONE)
        return ""
    if sequence.refuse_short(memory, timing.HOME, limits, loop=False):
        return ""
    poses, last = memory.poses, ArmAngles(*memory.poses[-1].arms)
    home = SavedPose(memory.choices.texts("gesture.home"), *timing.HOME)
    if timing.way(last, home) >= timing.SAME_DEG:
        home_s = timing.comfortable(last, home, memory.choices.speed, limits)
        poses = (*poses, structs.replace(home, duration_s=home_s))
    return sequence.choreography_of(poses, limits)


def _find(world: World, name: str) -> OwnGesture | None:
    own = (gesture for gesture in world.gestures if not gesture.common)
    return next((gesture for gesture in own if gesture.name.casefold() == name.casefold()), None)


def _open(memory: Memory, world: World, intent: OpenGesture) -> list[Action]:
    gesture = _find(world, intent.name)
    if gesture is None:
        return []
    memory.choices = structs.replace(memory.choices, simple=False)  # the simple window shows no sequence
    if gesture.wrong is not None:
        key, slots = wrong_file(gesture.wrong, f"{gesture.name}.csv")
        return memory.refuse(sequence.CONTROL, key, **slots)
    return sequence.open_file(memory, world, gesture.text)


def _delete(memory: Memory, world: World, intent: DeleteGesture) -> list[Action]:
    gesture = _find(world, intent.name)
    return [] if gesture is None else begin(memory, world, KeepGesture(NEW, "", "", gesture.name), CONTROL)


def _request(memory: Memory, world: World, intent: ShareGesture | FetchGestures) -> list[Action]:
    return begin(memory, world, intent, CONTROL)


HANDLES: Handles = {
    **dict.fromkeys((ShareGesture, FetchGestures), _request),
    DeleteGesture: _delete,
    SaveGesture: _save,
    OpenGesture: _open,
}
