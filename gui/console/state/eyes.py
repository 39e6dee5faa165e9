"""The pictures: subscriptions, titles, and the reason for a missing picture."""

from __future__ import annotations

from typing import Final

from beatrix_zenoh.contract._generated.messages import CameraStatus
from beatrix_zenoh.contract.names import EYES, SIDES
from gui.console.state.actions import Action, WatchCameras
from gui.console.state.intents import Choose, Tab, WindowPage
from gui.console.state.memory import Memory
from gui.console.state.saved import Choices
from gui.console.state.views import EyeView
from gui.console.state.world import LinkPhase, World, online, silent
from gui.console.texts import DEFAULT_LANGUAGE, Texts

SHOWN: Final = tuple((side, eye) for side in SIDES for eye in EYES)
"""Twin and eye of each picture of the window."""
TITLES: Final = {"left": "eye.title_left", "right": "eye.title_right"}


def wanted(choices: Choices) -> frozenset[tuple[str, str]]:
    """Return the visible pictures: none unless Eye cameras is checked."""
    shown = choices.page is not WindowPage.CLASS and choices.tab is Tab.EYES and choices.cameras
    return frozenset(SHOWN) if shown else frozenset()


def watch(choices: Choices, intent: Choose) -> list[Action]:
    """Return the change of subscriptions that follows from an intent."""
    return [WatchCameras(wanted(choices))] if intent.name in ("cameras", "tab") else []


def view(memory: Memory, world: World) -> tuple[EyeView, ...]:
    """Return both eyes of both robots."""
    texts, places = memory.choices.texts, wanted(memory.choices)
    return tuple(
        EyeView(
            side=side,
            eye=eye,
            title=texts(TITLES[eye], side=texts(f"side.{side}")),
            watched=(side, eye) in places and online(world, side),
            text=_reason(memory, world, side, eye),
        )
        for side, eye in SHOWN
    )


def _reason(memory: Memory, world: World, side: str, eye: str) -> str:
    """Return why there is no picture; empty if there is one."""
    texts, status = memory.choices.texts, world.side(side).status
    if not online(world, side):
        if status is not None and world.phase is LinkPhase.ONLINE:
            return texts("eye.lost", side=texts(f"side.{side}"))
        return texts("eye.absent_sim") if side == "sim" else texts("eye.absent_hw")
    if silent(world.side(side)):
        return texts("eye.silent", side=texts(f"side.{side}"))
    if not memory.choices.cameras:
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
