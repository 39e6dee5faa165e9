"""The pictures: subscriptions, titles, and the reason for a missing picture."""

from __future__ import annotations

from typing import Final

from beatrix_zenoh.contract._generated.messages import CameraStatus, Status
from beatrix_zenoh.contract.names import EYES, OUTSIDE, SIDES
from gui.console.state.actions import Action, WatchCameras
from gui.console.state.choices import Choices
from gui.console.state.intents import Intent, SetCameras, ShowTab, Tab, WindowPage
from gui.console.state.memory import Memory
from gui.console.state.presence import online
from gui.console.state.views import EyeView
from gui.console.state.world import World
from gui.console.texts import Texts

SHOWN: Final = (("sim", OUTSIDE), *((side, eye) for side in SIDES for eye in EYES))
"""Twin and eye of each picture of the window."""
TITLES: Final = {"left": "eye.title_left", "right": "eye.title_right", OUTSIDE: "eye.title_outside"}


def wanted(choices: Choices) -> frozenset[tuple[str, str]]:
    """Return the visible pictures; those of the eyes only while Eye cameras is checked."""
    if choices.page is WindowPage.CLASS:
        return frozenset()
    if choices.tab is Tab.HEADS:
        return frozenset({("sim", OUTSIDE)})  # drawn by the simulation, not a camera of the robot
    eyes = frozenset(place for place in SHOWN if place[1] != OUTSIDE)
    return eyes if choices.tab is Tab.EYES and choices.cameras else frozenset()


def watch(choices: Choices, intent: Intent) -> list[Action]:
    """Return the change of subscriptions that follows from an intent."""
    return [WatchCameras(wanted(choices))] if isinstance(intent, SetCameras | ShowTab) else []


def view(memory: Memory, world: World) -> tuple[EyeView, ...]:
    """Return the outside view and both eyes of both robots."""
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
        return texts("eye.absent_sim") if side == "sim" else texts("eye.absent_hw")
    if eye != OUTSIDE and not memory.choices.cameras:
        return texts("eye.cameras_off")
    if status is None:
        return texts("eye.waiting")
    if eye == OUTSIDE:
        return _outside(status, texts)
    return _trouble(next((camera for camera in status.cameras if camera.eye == eye), None), texts)


def _outside(status: Status, texts: Texts) -> str:
    """Return why there is no outside view; empty if there is one.

    The status lists only the eyes, but a simulation that draws them also draws the outside view.
    """
    if not status.cameras:
        return texts("eye.not_drawn")
    return next((camera.trouble for camera in status.cameras if not camera.connected), "")


def _trouble(camera: CameraStatus | None, texts: Texts) -> str:
    """Return why a camera delivers no pictures; empty if it delivers them."""
    if camera is None:
        return texts("eye.none")
    if camera.trouble and not camera.connected:  # first, as `streaming` may still be true for two seconds
        return camera.trouble
    if camera.streaming:
        return ""
    return texts("eye.waiting" if camera.connected else "eye.disconnected")
