"""The sequence editor: poses with durations, in an order; played on the simulation first, then on the hardware."""

from __future__ import annotations

import math
from typing import Final

from msgspec import structs

from beatrix_zenoh.client import motion_file
from beatrix_zenoh.client.choreography import Pose, Step, choreography
from beatrix_zenoh.client.degrees import ArmAngles, HeadAngles
from beatrix_zenoh.client.motion_file import ARMS, FIGURE, SPEED, TIME
from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract._generated.robot import LimitsData
from beatrix_zenoh.contract.errors import BeatrixError, Refused
from gui.console.state import intents
from gui.console.state import sequence_timing as timing
from gui.console.state.actions import NEW, Action, Outcome, Play
from gui.console.state.intents import (
    DuplicatePose,
    HeadOrientation,
    Intent,
    MovePose,
    RenamePose,
    SaveGesture,
    SetDuration,
)
from gui.console.state.memory import Handles, Memory, RequestRow, begin, unreachable
from gui.console.state.saved import DURATION_MAX_S, SavedPose
from gui.console.state.views import CardView, SequenceView, button
from gui.console.state.world import World, commanded, online
from gui.console.texts import Texts

CONTROL: Final = "sequence"
NONE: Final = "off.no_sequence"
POSES_MAX: Final = 100
"""Largest number of poses."""
UNDO_KEPT: Final = 50
DURATION_MIN_S: Final = 0.1
STARTS: Final = {"sim": ("sim", "hw"), "hw": ("hw",)}
"""Robots whose arms are the start of a play on one robot, the first that is known."""


# -- the view ---------------------------------------------------------------------------------------


def view(memory: Memory, world: World) -> SequenceView:
    """Return the strip and its buttons."""
    texts, poses, loop = memory.choices.texts, memory.poses, memory.choices.loop
    start = None if world.playing else commanded(world, STARTS["sim"])
    limits = timing.limits_of(world)
    short = timing.too_short(poses, start, limits, loop=loop)

    def card(number: int, pose: SavedPose) -> CardView:
        head = timing.head_of(pose.arms)
        duration, problem = texts("sequence.seconds", seconds=pose.duration_s), ""
        if (refusal := timing.beyond(pose.arms, limits)) is not None:
            duration, problem = _beyond(refusal, texts)
        elif number in short:
            duration = texts("sequence.least", seconds=short[number])
            problem = texts("sequence.too_short", seconds=short[number])
        place = None if head is None else HeadOrientation(*head)
        beats = pose.duration_s / world.music.beat_s if world.music.beat_s else 0.0
        return CardView(pose.name, place, pose.duration_s, duration, problem, beats, pose.note)

    whole_s = float(sum(pose.duration_s for pose in poses))
    play = "" if online(world, "sim") else "off.sequence_sim"
    hardware = _hardware_off(memory, world)
    full = "off.sequence_full" if len(poses) >= POSES_MAX else ""
    undo = "" if memory.sequence_undo else "off.no_sequence_undo"

    return SequenceView(
        cards=tuple(card(number, pose) for number, pose in enumerate(poses)),
        add=button(texts, "sequence.add", intents.AddPose(), full, count=str(POSES_MAX)),
        undo=button(texts, "sequence.undo", intents.UndoSequence(), undo),
        play=button(
            texts, "sequence.play", intents.PlaySequence("sim"), play if poses else NONE, seconds=whole_s
        ),
        hardware=button(texts, "sequence.hardware", intents.PlaySequence("hw"), hardware if poses else NONE),
        gesture=button(texts, "sequence.gesture", SaveGesture("", ""), "" if poses else NONE),
        played=world.playing_pose,
        facing=memory.choices.facing,
    )


def _beyond(refusal: Refused, texts: Texts) -> tuple[str, str]:
    """Return a word and a sentence about a pose that the limits do not allow."""
    detail = refusal.detail and structs.replace(refusal.detail, alternative=None, leaves_s=None)
    word = "sequence.too_close" if refusal.reason is Reason.ARM_GAP else "refused.tilt"
    return texts(word), texts("sequence.beyond", text=texts.refusal(refusal.reason, detail))


def _hardware_off(memory: Memory, world: World) -> str:
    if not online(world, "hw"):
        return "off.sequence_hw"
    return "" if memory.rehearsed == _rehearsal(memory, world) else "off.not_rehearsed"


def _rehearsal(memory: Memory, world: World) -> tuple[object, ...]:
    """Return what a play on the simulation must have played before it may be played on the hardware."""
    return (world.robot, memory.choices.loop, *((*pose.arms, pose.duration_s) for pose in memory.poses))


# -- changes ----------------------------------------------------------------------------------------


def undo(memory: Memory, _world: World, _intent: intents.UndoSequence) -> list[Action]:
    """Restore the poses before the last change."""
    *earlier, memory.poses = memory.sequence_undo or (memory.poses,)
    memory.sequence_undo = tuple(earlier)
    return []


def edit(memory: Memory, _world: World, intent: Intent) -> list[Action]:
    """Change one pose."""
    return change(memory, changed(memory.poses, intent))


def change(memory: Memory, poses: tuple[SavedPose, ...]) -> list[Action]:
    """Replace the poses, so that Undo of the strip restores the present ones; return no actions."""
    if poses != memory.poses:
        memory.sequence_undo = (*memory.sequence_undo, memory.poses)[-UNDO_KEPT:]
        memory.poses, memory.refusal = poses, None
    return []


def changed(poses: tuple[SavedPose, ...], intent: Intent) -> tuple[SavedPose, ...]:
    """Return the poses after a change of one pose; an intent that no widget reports changes nothing."""
    at = next((number for number, pose in enumerate(poses) if pose.name == getattr(intent, "name", "")), None)
    if at is None:
        return poses
    pose = poses[at]
    new: tuple[SavedPose, ...] = (pose,)
    match intent:
        case MovePose(to=to):
            others = (*poses[:at], *poses[at + 1 :])
            to = max(0, min(to, len(others)))
            return (*others[:to], pose, *others[to:])
        case intents.DeletePose():
            new = ()
        case DuplicatePose() if len(poses) < POSES_MAX:
            copy = structs.replace(pose, name=_free(poses, pose.name), duration_s=max(1.0, pose.duration_s))
            new = (pose, copy)
        case SetDuration(seconds=seconds) if math.isfinite(seconds):
            chosen_s = round(min(DURATION_MAX_S, max(DURATION_MIN_S, seconds)), 1)
            new = (structs.replace(pose, duration_s=chosen_s),)
        case RenamePose(new=name) if name.strip() not in ("", pose.name):
            new = (structs.replace(pose, name=_free(poses, name.strip())),)
    return (*poses[:at], *new, *poses[at + 1 :])


def _free(poses: tuple[SavedPose, ...], name: str) -> str:
    """Return the name, with a number if there is a pose of this name."""
    names, stem = {pose.name for pose in poses}, name
    if name not in names:
        return name
    head, dash, number = name.rpartition("-")
    if dash and number.isdecimal():
        stem = head
    return next(new for count in range(2, len(poses) + 3) if (new := f"{stem}-{count}") not in names)


def _posed(name: str, arms: ArmAngles) -> SavedPose:
    short, middle, long = (round(angle, 3) + 0.0 for angle in arms)
    return SavedPose(name, short, middle, long)


def _add(memory: Memory, world: World, intent: intents.AddPose) -> list[Action]:
    """Add the target of the pad, if the user has set one, else the present pose.

    Its duration is that of a motion at the chosen speed.
    """
    target = memory.choices.target
    if len(memory.poses) >= POSES_MAX:
        return memory.refuse(CONTROL, "off.sequence_full", count=str(POSES_MAX))
    try:
        aim = None if target is None else HeadAngles(target.yaw, target.pitch, target.roll)
        arms = commanded(world, memory.choices.sides + STARTS["sim"]) if aim is None else timing.arms_of(aim)
    except BeatrixError as error:
        return memory.refuse_error(CONTROL, error)
    if arms is None:
        return memory.refuse(CONTROL, "off.no_position")
    name = intent.name.strip() or f"{memory.choices.texts('sequence.auto_name')}-1"
    before = ArmAngles(*memory.poses[-1].arms) if memory.poses else timing.HOME
    pose = _posed(_free(memory.poses, name), arms)
    duration_s = timing.comfortable(before, pose, memory.choices.speed, timing.limits_of(world))
    return change(memory, (*memory.poses, structs.replace(pose, duration_s=duration_s)))


# -- playing ----------------------------------------------------------------------------------------


def play(memory: Memory, world: World, intent: intents.PlaySequence) -> list[Action]:
    """Return the action that plays the sequence; none if a pose cannot be reached in its duration."""
    side, loop = intent.side, memory.choices.loop
    if not memory.poses:
        return memory.refuse(CONTROL, NONE)
    if unreachable(memory, world, (side,), CONTROL):
        return []
    if side == "hw" and memory.rehearsed != _rehearsal(memory, world):
        return memory.refuse(CONTROL, "off.not_rehearsed")
    limits, start = timing.limits_of(world), commanded(world, STARTS[side]) or timing.HOME
    if refuse_short(memory, start, limits, loop=loop):
        return []
    begun = begin(memory, world, _play(memory.poses, side, start, limits, loop=loop), CONTROL)
    memory.begun = (memory.numbers, _rehearsal(memory, world)) if side == "sim" else (0, ())
    return begun


def _play(
    poses: tuple[SavedPose, ...], side: str, start: ArmAngles, limits: LimitsData, *, loop: bool
) -> Play:
    """Return the play of poses whose first one begins at `start`."""
    steps = tuple(timing.timed(poses, start, limits))
    notes = tuple(pose.note for pose in poses)
    if not loop:
        return Play(NEW, (side,), steps, notes=notes)
    last = ArmAngles(*poses[-1].arms)
    holds = len(poses) > 1 and timing.way(ArmAngles(*poses[-2].arms), poses[-1]) < timing.SAME_DEG
    again = timing.timed(poses, last, limits, poses[-1].duration_s if holds else 0.0)
    return Play(NEW, (side,), steps, tuple(again), notes=notes)


def refuse_short(memory: Memory, start: ArmAngles, limits: LimitsData, *, loop: bool) -> bool:
    """Return whether a pose cannot be reached in its duration; if so, show the first one."""
    short = timing.too_short(memory.poses, start, limits, loop=loop)
    if not short:
        return False
    number, least_s = min(short.items())
    memory.refuse(CONTROL, "cannot.too_short", name=memory.poses[number].name, shortest=float(least_s))
    return True


def note(memory: Memory, row: RequestRow, outcome: Outcome) -> None:
    """Remember a play on the simulation that went well: to its end, or for one round of a loop."""
    number, what = memory.begun
    whole = outcome.rounds > 0 if isinstance(row.request, Play) and row.request.again else outcome.done
    if row.number == number and outcome.accepted and whole:
        memory.rehearsed = what


# -- files ------------------------------------------------------------------------------------------


def choreography_of(poses: tuple[SavedPose, ...], limits: LimitsData) -> str:
    """Return poses as a choreography (CSV) that begins at home."""
    lines = [",".join((TIME, *ARMS, SPEED, FIGURE))]
    for pose, step in zip(poses, timing.timed(poses, timing.HOME, limits), strict=True):
        name = pose.name.replace('"', '""')
        numbers = (step.at, step.short, step.middle, step.long, step.speed)
        lines.append(",".join(f"{number:z.3f}" for number in numbers) + f',"{name}"')
    return "\n".join(lines) + "\n"


def open_file(memory: Memory, world: World, text: str) -> list[Action]:
    """Replace the poses by those of a choreography that can be played: each is reached when the next one begins."""
    found = choreography(motion_file.parse(text, ""))
    if len(found.steps) > POSES_MAX + 1:  # the last one may be the head at home, which is no pose of the user
        slots = {"count": str(len(found.steps)), "allowed": str(POSES_MAX)}
        return memory.refuse(CONTROL, "cannot.too_many", **slots)
    try:
        poses = _read(found.steps, timing.limits_of(world))
    except BeatrixError as error:
        return memory.refuse_error(CONTROL, error)
    return change(memory, poses)


def _read(steps: list[tuple[str, Step]], limits: LimitsData) -> tuple[SavedPose, ...]:
    poses: tuple[SavedPose, ...] = ()
    here = timing.HOME
    for (title, step), (_, following) in zip(steps, [*steps[1:], steps[-1]], strict=True):
        if isinstance(step, Pose):
            arms = timing.arms_of(HeadAngles(step.yaw, step.pitch, step.roll))
        else:
            arms = ArmAngles(step.short, step.middle, step.long)
        pose = _posed(_free(poses, title), arms)
        own_s = timing.shortest(here, pose, timing.at_speed(limits, step.speed))
        duration_s = following.at - step.at if following is not step else own_s
        duration_s = round(min(DURATION_MAX_S, max(DURATION_MIN_S, duration_s)), 1)
        poses, here = (*poses, structs.replace(pose, duration_s=duration_s)), ArmAngles(*pose.arms)
    return poses


HANDLES: Handles = {
    intents.AddPose: _add,
    **dict.fromkeys((MovePose, DuplicatePose, SetDuration, RenamePose, intents.DeletePose), edit),
    intents.UndoSequence: undo,
    intents.PlaySequence: play,
}
