"""The head pad: its target, drags of the head, the preview, and the lead of the simulation."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable
from functools import cache

from msgspec import structs

from beatrix_zenoh.client.degrees import Reading, pose_query
from beatrix_zenoh.contract._generated.messages import PoseQuery, Reason
from beatrix_zenoh.contract._generated.robot import LimitsData
from beatrix_zenoh.contract.names import SIDES
from beatrix_zenoh.motion.limits import region
from gui.console.state import gestures, intents, refusals
from gui.console.state.actions import FOLLOW, NEW, TURN, Abort, Action, Outcome, Send, SendNow
from gui.console.state.intents import AimHead, Change, Choose, HeadOrientation, LiveHead, SendHead
from gui.console.state.memory import Handles, Memory, begin, head_of, send_head, unreachable
from gui.console.state.sequence_timing import limits_of
from gui.console.state.views import DragView, HeadView, SendingView, button
from gui.console.state.world import PlanPhase, PlanProgress, World, kept, reading, silent
from gui.console.texts import Texts

PAD = "head"
UPRIGHT = HeadOrientation(0.0, 0.0, 0.0)
WITHIN_DEG = 0.1
"""How far inside the border the simulation stays that follows a target beyond it."""
EARLY_S = 0.2
"""How long before its end the lead was beaten."""
SAME_DEG = 0.5
"""How far a head may be from its target (deg) and be there."""
STOPPED = 0
"""`Memory.live_row` after a STOP: nothing is sent before the next drag."""
REFUSED = -1
"""`Memory.live_row` after a refusal that further targets would meet again: Live sends nothing before the next drag."""
REASONS = {
    Reason.OUT_OF_REACH: "refused.tilt",
    Reason.ARM_GAP: "refused.gap",
    Reason.YAW_LIMIT: "refused.yaw",
}


def head(memory: Memory, world: World) -> HeadView:
    """Return the pad; limits are those of the robot, or the defaults while they are unknown."""
    limits = limits_of(world)
    path = world.plan.path if world.plan is not None else None
    solid, aim = _solid(memory, world), target(memory, world)
    heads = [_head(world, side, kept) for side in memory.choices.sides]
    off, status = "" if memory.choices.sides else "off.unchecked", world.side(solid).status
    # In the simple window no ghost of a robot that nothing is sent to hides the face.
    seen = (*memory.choices.sides, solid) if memory.choices.simple else SIDES
    return HeadView(
        target=aim,
        sim=_head(world, "sim") if "sim" in seen else None,
        hw=_head(world, "hw") if "hw" in seen else None,
        solid=solid,
        shown=_head(world, solid, kept),
        silent=silent(world.side(solid)),
        asleep=status is not None and not status.enabled,
        tilt_max=limits.tilt_max,
        yaw_max=limits.yaw_max,
        path=() if path is None else tuple(HeadOrientation(*head) for head in path.head),
        facing=memory.choices.facing,
        drag=_drag(memory, limits),
        send=button(
            memory.choices.texts, "head.send", SendHead(), off, yaw=aim.yaw, pitch=aim.pitch, roll=aim.roll
        ),
        unsent=any(seen is not None and aim.away(seen) > SAME_DEG for seen in heads),
        refusal=refusals.at(memory, (PAD,)),
    )


def _head(
    world: World, side: str, read: Callable[[World, str], Reading | None] = reading
) -> HeadOrientation | None:
    found = read(world, side)
    return None if found is None else HeadOrientation(*found.head)


def _solid(memory: Memory, world: World) -> str:
    """Return the side that is drawn solid: the checked one, of both the hardware; the other one if it is alone."""
    order = ("sim", "hw") if memory.choices.sides == ("sim",) else ("hw", "sim")
    return next((side for side in order if kept(world, side) is not None), order[0])


def target(memory: Memory, world: World) -> HeadOrientation:
    """Return the target of the user, else the head's orientation, so that Send moves nothing, else upright."""
    if memory.choices.target is not None:
        return memory.choices.target
    here = _head(world, (memory.choices.sides or ("sim",))[0], kept) or UPRIGHT
    return HeadOrientation(*(round(angle, 1) + 0.0 for angle in (here.yaw, here.pitch, here.roll)))


def view(memory: Memory, world: World) -> SendingView:
    """Return boxes, lead, and the present motion of both robots."""
    choices, plan = memory.choices, world.plan
    texts = choices.texts
    waiting = plan is not None and plan.phase is PlanPhase.LEADING
    title, text = _without_plan(memory, world) if plan is None else _under_way(plan, texts)
    countdown, progress = "", None
    if plan is not None and waiting:
        left_s = max(0.0, plan.countdown_s)
        countdown = texts("countdown", seconds=left_s)
        progress = min(1.0, max(0.0, 1 - left_s / plan.lead_s)) if plan.lead_s > 0 else 1.0

    return SendingView(
        lead_matters=choices.sim and choices.hw,
        title=title,
        text=text,
        countdown=countdown,
        progress=progress,
        send_now=button(texts, "plan.send_now", SendNow(), "" if waiting else "off.no_plan"),
        change=button(texts, "plan.change", Change(), "" if _can_change(plan) else "off.no_plan"),
        abort=button(texts, "plan.abort", Abort(), "off.no_plan" if plan is None else ""),
    )


def _can_change(plan: PlanProgress | None) -> bool:
    """Return whether there is a motion that was not sent to the hardware yet."""
    return plan is not None and plan.phase is not PlanPhase.SENT


def _without_plan(memory: Memory, world: World) -> tuple[str, str]:
    texts = memory.choices.texts
    if world.playing:
        title = gestures.title(world.playing, texts)
        return texts("sending.playing", title=title), texts("sending.playing_text")
    if world.program.running:
        key = {FOLLOW: "following", TURN: "listening"}.get(world.program.file, "program")
        return texts(f"sending.{key}", file=world.program.file.name), texts(f"sending.{key}_text")
    held = memory.row(memory.held_row or 0)
    if held is not None and len(held.sides) > 1 and not (held.ended or held.dropped):
        return texts("sending.held"), texts("sending.held_text")
    return _idle(memory)


def _idle(memory: Memory) -> tuple[str, str]:
    texts, lead_s, sides = memory.choices.texts, memory.choices.lead_s, memory.choices.sides
    key = "both" if len(sides) > 1 else sides[0] if sides else "none"
    text = "together" if key == "both" and not lead_s else key
    return texts(f"sending.{key}"), texts(f"sending.{text}_text", seconds=float(lead_s))


def _under_way(plan: PlanProgress, texts: Texts) -> tuple[str, str]:
    duration_s = float(plan.duration_s)
    if plan.phase is PlanPhase.TRYING:
        return texts("sending.trying"), texts("sending.trying_text")
    warning = "" if plan.alike else texts("sending.unlike")
    if plan.apart_deg:
        warning = texts("sending.apart", degrees=float(plan.apart_deg))
    if plan.phase is PlanPhase.LEADING:
        text = warning or texts("sending.leading_text")
        return texts("sending.possible", seconds=duration_s), text
    return texts("sending.sent", seconds=duration_s), warning or texts("sending.sent_text")


def aim(memory: Memory, _world: World, intent: AimHead) -> list[Action]:
    """Move the target; angles that no widget reports are ignored."""
    if math.isfinite(intent.yaw + intent.pitch + intent.roll):
        at = HeadOrientation(intent.yaw, intent.pitch, intent.roll)
        memory.choices = structs.replace(memory.choices, target=at)
    refusals.hide_answered(memory, intent)
    return []


def send(memory: Memory, world: World, _intent: SendHead) -> list[Action]:
    """Return the action that sends the target of the pad."""
    return send_head(memory, world, target(memory, world), PAD)


def end_lead(memory: Memory, world: World, intent: SendNow | Change | Abort) -> list[Action]:
    """Return the action of an intent about the present motion; none if there is no motion.

    Abort also ends a motion that was just sent to the hardware.
    """
    if world.plan is None or not (_can_change(world.plan) or isinstance(intent, Abort)):
        return []
    memory.lead_beaten |= world.plan.phase is PlanPhase.LEADING and world.plan.countdown_s >= EARLY_S
    if isinstance(intent, SendNow):
        return [intent]
    path = world.plan.path
    if isinstance(intent, Change) and path is not None and path.head:
        memory.choices = structs.replace(memory.choices, target=HeadOrientation(*path.head[-1]))
    memory.mark_dropped("aborted")
    return [Abort()]


def spare_hardware(memory: Memory, world: World, intent: Choose) -> list[Action]:
    """Return the action that aborts a motion which waits for the hardware when its box is cleared; else none."""
    cleared = intent == Choose("hw", value=False)
    return end_lead(memory, world, Abort()) if cleared and _can_change(world.plan) else []


@cache
def border_deg(tilt_max: float, gap_min: float) -> tuple[float, ...]:
    """Return `limits.region.border` in deg, for limits in deg."""
    return tuple(map(math.degrees, region.border(math.radians(tilt_max), math.radians(gap_min))))


def _drag(memory: Memory, limits: LimitsData) -> DragView:
    """Return choices, border and the refused target."""
    choices, refusal = memory.choices, memory.refusal
    refused, reason = None, ""
    request = None if refusal is None or refusal.control != PAD else refusal.request
    if refusal is not None and isinstance(request, Send) and isinstance(request.query, PoseQuery):
        query = request.query
        refused = head_of(query)
        reason = choices.texts(REASONS.get(refusal.outcome.reason, "refused.other"))
    return DragView(choices.follows, border_deg(limits.tilt_max, limits.gap_min), refused, reason)


def grab(memory: Memory, _world: World, _intent: intents.GrabHead) -> list[Action]:
    """Begin a drag."""
    memory.live_row = None
    return []


def live(memory: Memory, world: World, _intent: LiveHead) -> list[Action]:
    """Return the action with which the simulation follows a drag, if that was chosen."""
    return (
        _follow(memory, world) if memory.choices.follows and memory.live_row not in (STOPPED, REFUSED) else []
    )


def release(memory: Memory, world: World, _intent: intents.ReleaseHead) -> list[Action]:
    """Return the action that sends the target at the end of a drag, if that was chosen."""
    target, ended = memory.choices.target, memory.live_row in (STOPPED, REFUSED)
    if memory.live_row == REFUSED:
        memory.live_row = None
    if target is None or ended or not memory.choices.sends:
        return []
    followed = memory.live_row is not None and memory.choices.sides == ("sim",)
    if followed and _inside(world, target) == (target.pitch, target.roll):
        return []  # the simulation goes there already
    return send_head(memory, world, target, PAD)


def note_refusal(memory: Memory, outcome: Outcome) -> None:
    """After a refusal that is not about the place of the target, Live ends until the next drag."""
    passing = outcome.accepted or outcome.reason in (Reason.OK, Reason.REPLACED, *REASONS)
    if outcome.row == memory.live_row and not passing:
        memory.live_row = REFUSED


def _follow(memory: Memory, world: World) -> list[Action]:
    """Send the target to the simulation alone; all motions of a drag are one row of the history."""
    sides, target = ("sim",), memory.choices.target
    if target is None:
        return []
    pitch, roll = _inside(world, target)
    query = pose_query(target.yaw, pitch, roll, relative=False, speed=memory.choices.speed)
    row = None if memory.live_row is None else memory.row(memory.live_row)
    if row is None:
        begun = begin(memory, world, Send(NEW, query, sides), PAD)
        memory.live_row = memory.rows[-1].number if begun else REFUSED
        return begun
    if unreachable(memory, world, sides, PAD):
        memory.live_row = REFUSED
        return []
    request = Send(row.number, query, sides)
    memory.replace_row(dataclasses.replace(row, request=request))
    return [request]


def _inside(world: World, target: HeadOrientation) -> tuple[float, float]:
    """Return pitch and roll (deg) of the target, or of the point of the border in its direction."""
    limits = limits_of(world)
    border = border_deg(limits.tilt_max, limits.gap_min)
    furthest = region.reach(border, target.pitch, target.roll) - WITHIN_DEG
    shrink = min(1.0, furthest / max(math.hypot(target.pitch, target.roll), 1e-9))
    return target.pitch * shrink, target.roll * shrink


HANDLES: Handles = {
    AimHead: aim,
    SendHead: send,
    SendNow: end_lead,
    Change: end_lead,
    Abort: end_lead,
    intents.GrabHead: grab,
    LiveHead: live,
    intents.ReleaseHead: release,
}
