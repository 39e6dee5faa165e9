"""Gestures that one press plays, and the program that follows a face."""

from __future__ import annotations

from msgspec import structs

from beatrix_zenoh.client import RobotState
from beatrix_zenoh.client.choreography import GESTURES
from gui.console.state import own_gestures, refusals
from gui.console.state.actions import NEW, POSES, Action, EndFollowing, FollowFace, Play, WriteFile
from gui.console.state.memory import Handles, Memory, begin, lead_of, unreachable
from gui.console.state.views import ButtonView, GesturesView, button
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
    off = "" if memory.choices.sides else "off.unchecked"
    follow = button(texts, "gesture.follow", FollowFace(NEW, ()), off)
    if face.running:  # it can always be ended
        follow = button(texts, "gesture.end", EndFollowing())
    if face.running:
        note = texts("gesture.following_own" if face.own else "gesture.following", file=str(face.file))
    else:
        note = texts("gesture.own", file=str(face.file)) if face.own else ""
    return GesturesView(
        gestures=tuple((name, _gesture(name, off, texts)) for name in GESTURES),
        own=own_gestures.view(world, off, texts),
        fetch=own_gestures.fetch(world, texts),
        follow=follow,
        following=face.running,
        open=button(texts, "gesture.open", WriteFile(NEW, face.own_file, face.file), file=str(face.own_file)),
        note=note,
        details=texts("gesture.line", line=face.line) if face.line else "",
        refusal=refusals.at(memory, (CONTROL,)),
    )


def _gesture(name: str, off: str, texts: Texts) -> ButtonView:
    return button(texts, f"gesture.{name}", Play(NEW, (), gesture=name), off)


def title(playing: str, texts: Texts) -> str:
    """Return the title of a play in the language of the texts."""
    if playing == POSES:
        return texts("label.poses")
    return texts(f"gesture.{playing}") if playing in GESTURES else playing


def play(memory: Memory, world: World, intent: Play) -> list[Action]:
    """Return the action that plays a gesture with the checked robots."""
    sides = memory.choices.sides
    request = structs.replace(intent, sides=sides, lead_s=lead_of(memory, sides))
    return begin(memory, world, request, CONTROL)


def follow_face(memory: Memory, world: World, _intent: FollowFace) -> list[Action]:
    """Return the action that starts the program; the hardware's eye sees if both robots move and both can see."""
    sides = memory.choices.sides
    if unreachable(memory, world, sides, CONTROL):
        return []
    seeing = [side for side in ("hw", "sim") if side in sides and sees(world.side(side))]
    if not seeing:
        return memory.refuse(CONTROL, "cannot.no_eye" if len(sides) == 1 else "cannot.no_eyes")
    others = tuple(side for side in sides if side != seeing[0])
    return begin(memory, world, FollowFace(NEW, (seeing[0], *others)), CONTROL)


def sees(robot: RobotState) -> bool:
    """Return whether the left eye of a robot has a camera that works, and shows more than the test picture."""
    cameras = () if robot.status is None else robot.status.cameras
    return any(camera.eye == EYE and camera.connected and camera.source != TEST_PICTURE for camera in cameras)


HANDLES: Handles = {Play: play, FollowFace: follow_face}
