"""Saved poses as the page lists them, files to play, and undo of motions."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

from beatrix_zenoh.client.degrees import ArmAngles
from beatrix_zenoh.contract._generated.messages import Command
from gui.console.state import gestures, intents, sequence
from gui.console.state.actions import Action, MakeReady, SendCommand
from gui.console.state.memory import Handles, Memory, Request, RequestRow, lead_of, send_arms
from gui.console.state.views import PosesView, button
from gui.console.state.world import World, commanded

CONTROL = "commands"


def view(memory: Memory, world: World) -> PosesView:
    """Return the list and its buttons."""
    checked, count = bool(memory.choices.sides), len(memory.poses)
    texts, playing = memory.choices.texts, gestures.title(world.playing, memory.choices.texts)
    reason = "" if checked else "off.unchecked"
    some = "" if count else "off.no_pose"
    several = "off.playing" if playing else "" if count > 1 else "off.one_pose"
    here = "" if commanded(world, _where(memory)) is not None else "off.no_position"
    return PosesView(
        names=tuple(pose.name for pose in memory.poses),
        go=button(texts, "pose.go", intents.GoToPose(""), reason or some),
        save=button(texts, "pose.save", intents.SavePose(""), here),
        delete=button(texts, "pose.delete", intents.DeletePose(""), some),
        play=button(texts, "pose.play", intents.PlayPoses(), reason or several, title=playing),
        playing=playing,
    )


def _where(memory: Memory) -> tuple[str, ...]:
    """Return the robots whose angles may be saved, the checked ones first."""
    return tuple(dict.fromkeys((*memory.choices.sides, "sim", "hw")))


def save(memory: Memory, world: World, intent: intents.SavePose) -> list[Action]:
    """Save the present arm angles."""
    name, arms = intent.name.strip(), commanded(world, _where(memory))
    if not name or arms is None:
        return memory.refuse(CONTROL, "off.no_position" if name else "cannot.name")
    pose = sequence.new_pose(memory, world, name, arms)
    return sequence.change(memory, (*(kept for kept in memory.poses if kept.name != name), pose))


def delete(memory: Memory, _world: World, intent: intents.DeletePose) -> list[Action]:
    """Delete a pose."""
    return sequence.change(memory, tuple(pose for pose in memory.poses if pose.name != intent.name))


def go(memory: Memory, world: World, intent: intents.GoToPose) -> list[Action]:
    """Return the action that turns the arms to a pose."""
    found = next((pose for pose in memory.poses if pose.name == intent.name), None)
    if found is None:
        return memory.refuse(CONTROL, "cannot.pose", name=intent.name)
    return send_arms(memory, world, found.arms, CONTROL)


def play(memory: Memory, world: World, _intent: intents.PlayPoses) -> list[Action]:
    """Return the action that plays all poses with the checked robots."""
    sides = memory.choices.sides
    return sequence.play(memory, world, sides, lead_of(memory, sides))


class WayBack(NamedTuple):
    """What *Undo* does now."""

    row: RequestRow
    """the motion that it undoes"""
    sides: tuple[str, ...]
    """the checked robots that made that motion"""
    arms: ArmAngles
    """where they go (deg): the arms before that motion"""


def way_back(memory: Memory) -> WayBack | None:
    """Return how the newest motion of a checked robot is undone; None if there is none.

    Robots that did not make the motion stay where they are. If both made it from different places, both go to that of
    the hardware: it gets no pose that only the simulation had, and both go there with preview and lead. Angles are
    counted from home, so nothing is undone that is older than a request that may have changed home.
    """
    for row in reversed(memory.rows):
        if row.accepted and sets_home(row.request):
            return None
        sides = tuple(side for side in memory.choices.sides if side in row.before)
        if row.accepted and not row.undoes and sides:
            return WayBack(row, sides, row.before[sides[-1]])
    return None


def undo(memory: Memory, world: World, _intent: intents.Undo) -> list[Action]:
    """Return the action that turns the arms back to their angles before the last accepted motion."""
    found = way_back(memory)
    if found is None:
        return memory.refuse(CONTROL, "off.no_undo")
    actions = send_arms(memory, world, found.arms, CONTROL, undoes=True, sides=found.sides)
    if actions:  # so that each robot goes further back at the next press
        rest = {side: arms for side, arms in found.row.before.items() if side not in found.sides}
        memory.replace_row(replace(found.row, before=rest))
    return actions


def sets_home(request: Request) -> bool:
    """Return whether a request may change home, the position from which arm angles are counted."""
    commands = (Command.ENABLE, Command.CALIBRATE)
    return isinstance(request, MakeReady) or (
        isinstance(request, SendCommand) and request.command in commands
    )


HANDLES: Handles = {
    intents.SavePose: save,
    intents.DeletePose: delete,
    intents.GoToPose: go,
    intents.PlayPoses: play,
    intents.Undo: undo,
}
