"""Gestures that one press plays, and the program that follows a face."""

from __future__ import annotations

from beatrix_zenoh.client import RobotState
from beatrix_zenoh.client.choreography import GESTURES
from gui.console.state import refusals
from gui.console.state.actions import POSES, Action, CopyProgram, EndFollowing, FollowFace, Play
from gui.console.state.intents import OpenProgram, PlayGesture, ToggleFollowing
from gui.console.state.memory import Memory
from gui.console.state.motions import begin, lead_of
from gui.console.state.presence import unreachable
from gui.console.state.views import ButtonView, GesturesView
from gui.console.state.world import World
from gui.console.texts import Texts

CONTROL = "gestures"
EYE = "left"
"""The eye with which the shipped program sees."""
TEST_PICTURE = "pattern"
"""The source of an eye of a virtual board, which never sees a person."""


def view(memory: Memory, world: World) -> GesturesView:
    """Return the buttons, and the refusal of one of them."""
    texts, face = memory.choices.texts, world.face
    off = "" if memory.choices.sides else texts("off.unchecked")
    if face.running:
        note = texts("gesture.following_own" if face.own else "gesture.following", file=str(face.file))
    else:
        note = texts("gesture.own", file=str(face.file)) if face.own else ""
    return GesturesView(
        gestures=tuple((name, _gesture(name, off, texts)) for name in GESTURES),
        follow=_follow(off, texts, running=face.running),
        following=face.running,
        open=ButtonView(
            texts("gesture.open"), texts("gesture.open_tip", file=str(face.own_file)), OpenProgram()
        ),
        note=note,
        details=texts("gesture.line", line=face.line) if face.line else "",
        refusal=refusals.at(memory, (CONTROL,)),
    )


def _gesture(name: str, off: str, texts: Texts) -> ButtonView:
    """Return the button of a gesture; `off` is the reason why it is disabled."""
    tooltip = off or texts(f"gesture.{name}_tip")
    return ButtonView(texts(f"gesture.{name}"), tooltip, PlayGesture(name), enabled=not off)


def _follow(off: str, texts: Texts, *, running: bool) -> ButtonView:
    """Return the button that starts or ends the program; it always ends a running one."""
    if running:
        return ButtonView(texts("gesture.end"), texts("gesture.end_tip"), ToggleFollowing())
    tooltip = off or texts("gesture.follow_tip")
    return ButtonView(texts("gesture.follow"), tooltip, ToggleFollowing(), enabled=not off)


def title(playing: str, texts: Texts) -> str:
    """Return the title of a play in the language of the texts."""
    if playing == POSES:
        return texts("label.poses")
    return texts(f"gesture.{playing}") if playing in GESTURES else playing


def handle(memory: Memory, world: World, intent: PlayGesture | ToggleFollowing | OpenProgram) -> list[Action]:
    """Return the actions of an intent about gestures."""
    match intent:
        case PlayGesture(name=name):
            return _play(memory, world, name)
        case ToggleFollowing():
            return [EndFollowing()] if world.face.running else _begin_following(memory, world)
        case OpenProgram():
            return begin(memory, world, CopyProgram(memory.next_row(), world.face.own_file), CONTROL)


def _play(memory: Memory, world: World, name: str) -> list[Action]:
    sides = memory.choices.sides
    if unreachable(memory, world, sides, CONTROL):
        return []
    request = Play(memory.next_row(), sides, lead_s=lead_of(memory, sides), gesture=name)
    return begin(memory, world, request, CONTROL)


def _begin_following(memory: Memory, world: World) -> list[Action]:
    """Return the action that starts the program; the hardware's eye sees if both robots move and both can see."""
    sides = memory.choices.sides
    if unreachable(memory, world, sides, CONTROL):
        return []
    seeing = [side for side in ("hw", "sim") if side in sides and sees(world.side(side))]
    if not seeing:
        return memory.refuse(CONTROL, "cannot.no_eye" if len(sides) == 1 else "cannot.no_eyes")
    others = tuple(side for side in sides if side != seeing[0])
    return begin(memory, world, FollowFace(memory.next_row(), (seeing[0], *others)), CONTROL)


def sees(robot: RobotState) -> bool:
    """Return whether the left eye of a robot has a camera that works, and shows more than the test picture."""
    cameras = () if robot.status is None else robot.status.cameras
    return any(camera.eye == EYE and camera.connected and camera.source != TEST_PICTURE for camera in cameras)


def watching(memory: Memory, world: World) -> str:
    """Return the side whose eye the running program uses, if this window has started it; else an empty string."""
    started = (row.request for row in reversed(memory.rows) if not row.ended)
    found = next((request for request in started if isinstance(request, FollowFace)), None)
    return found.sides[0] if found is not None and world.face.running else ""
