"""Refusals: shown beside the control of the request, with a button for the alternative or next step."""

from __future__ import annotations

import math
import re
from dataclasses import replace
from typing import Final

import msgspec

from beatrix_zenoh.client.degrees import arm_angles
from beatrix_zenoh.client.motion_file import COLUMNS, HEAD, SPEED, TIME, WrongLine
from beatrix_zenoh.contract._generated.messages import (
    Alternative,
    Detail,
    MotionQuery,
    PoseQuery,
    Reason,
    Vector3,
)
from beatrix_zenoh.contract.errors import WrongUsage
from gui.console.state.actions import Action, Outcome, Play, Send
from gui.console.state.intents import AimHead, Choose, DismissRefusal, Intent, SetDuration, TakeAlternative
from gui.console.state.memory import Handles, Memory, Refusal, Request, RequestRow, again, begin, head_of
from gui.console.state.memory import sides_of as sides_of_request
from gui.console.state.pills import MAKE_READY, NEXT_STEPS, WAIT, finding, next_step_button
from gui.console.state.views import ButtonView, Condition, RefusalView
from gui.console.state.world import World
from gui.console.texts import Texts

COMMAND: Final = "`beatrix"
"""part of an SDK message that gives a command to type, which the user of a face does not"""
NAMED: Final = re.compile(r"[a-z0-9-]+ \((sim|hw)\): ")
"""beginning of an SDK message that names its robot"""


def at(memory: Memory, controls: tuple[str, ...]) -> RefusalView | None:
    """Return the refusal to show at one of these controls; None if there is none."""
    refusal = memory.refusal
    if refusal is None or refusal.control not in controls:
        return None
    texts, sides = memory.choices.texts, () if refusal.request is None else sides_of_request(refusal.request)
    return RefusalView(told_by(refusal.outcome, sides, texts), _button(refusal, texts))


def told_by(outcome: Outcome, sides: tuple[str, ...], texts: Texts) -> str:
    """Return why a request to these sides failed, with the robots if it was sent to several."""
    text, side = reason_of(outcome, texts), side_of(outcome)
    if outcome.failed:
        return texts("of.robots", robots=", ".join(outcome.failed), text=text)
    return texts("of.side", side=texts(f"side.{side}"), text=text) if side and len(sides) > 1 else text


def reason_of(outcome: Outcome, texts: Texts) -> str:
    """Return why a request failed."""
    if outcome.key:
        return texts(outcome.key, **outcome.slots)
    return sentence(outcome.reason, outcome.detail, outcome.message, texts)


def sentence(reason: Reason, detail: Detail | None, message: str, texts: Texts) -> str:
    """Return the sentence of a refusal in the language of the texts, made from `detail` if there is one.

    Without `detail`, the English sentence is the message; other languages contain the message only for BAD_VALUE.
    """
    if detail is not None:
        return texts.refusal(reason, detail)
    message = NAMED.sub("", message, count=1)
    if texts.code == "en" and message and COMMAND not in message:
        return message
    if reason is Reason.BAD_VALUE and message:
        return texts("result.invalid", message=message)
    return texts.refusal(reason, None)


def wrong_file(error: WrongUsage, file: str) -> tuple[str, dict[str, str]]:
    """Return key and slots of the text about a motion file that cannot be used: the library's sentence is English."""
    slots = {"text": error.message, "file": file}
    if isinstance(error, WrongLine):
        return "result.bad_line", {
            **slots,
            "line": str(error.line),
            "columns": ", ".join(COLUMNS),
            "speed": SPEED,
        }
    return "result.bad_file", {**slots, "columns": ",".join((TIME, *HEAD))}


def record(memory: Memory, row: RequestRow, outcome: Outcome) -> None:
    """Store a refusal, to be shown; the end of an accepted motion is shown in the history only.

    A limit shows that it is no end: the robot has accepted earlier goals of a held button, and close to the limit there
    is no alternative. Neither is a required step: a play is accepted when its file is checked, before the robot gets
    its first pose.
    """
    detail, played = outcome.detail, isinstance(row.request, Play)
    refused = detail is not None and (detail.limit is not None or (played and bool(detail.needs)))
    ended_elsewhere = not refused and (outcome.side in row.accepted or "" in row.accepted)
    wanted = row.dropped and outcome.reason is Reason.STOPPED
    if outcome.accepted or ended_elsewhere or wanted or outcome.reason in (Reason.OK, Reason.REPLACED):
        return
    memory.refusal = Refusal(row.control, outcome, row.request)


def side_of(outcome: Outcome) -> str:
    """Return the robot that refused; for a request to two robots the SDK names the refusing robot in the message."""
    named = NAMED.match(outcome.message)
    return outcome.side or ("" if named is None else named[1])


def hide_answered(memory: Memory, intent: Intent) -> None:
    """Hide the shown refusal if this intent answers it.

    A refusal beside the head pad is hidden when the user aims again; a refusal that the window itself made, when the
    user chooses something.
    """
    refusal = memory.refusal
    if refusal is None:
        return
    # The refusal of Live stays until the release.
    dragged = memory.live_row is not None and memory.live_row < 0
    aimed = isinstance(intent, AimHead) and refusal.control == "head" and not dragged
    if aimed or (isinstance(intent, Choose) and refusal.outcome.key):
        memory.refusal = None


def dismiss(memory: Memory, _world: World, _intent: DismissRefusal) -> list[Action]:
    """Hide the refusal."""
    memory.refusal = None
    return []


def take_alternative(memory: Memory, world: World, _intent: TakeAlternative) -> list[Action]:
    """Return the action that sends the alternative of the shown refusal; none if it has none."""
    refusal = memory.refusal
    request = None if refusal is None else _alternative_request(refusal)
    if refusal is None or request is None:
        return []
    actions = begin(memory, world, again(memory, request), refusal.control)
    if actions and isinstance(request.query, PoseQuery):
        memory.choices = msgspec.structs.replace(memory.choices, target=head_of(request.query))
    return actions


def _button(refusal: Refusal, texts: Texts) -> ButtonView | None:
    if refusal.outcome.key == "cannot.too_short":
        slots = refusal.outcome.slots
        longer = SetDuration(str(slots["name"]), float(slots["shortest"]))
        return ButtonView(texts("alternative.duration", **slots), texts("tip.duration"), longer)
    request = _alternative_request(refusal)
    if request is not None and refusal.request is not None:
        text = _alternative_text(request, refusal.request, texts)
        return ButtonView(text, texts("alternative.tip"), TakeAlternative())
    step, sides = next_step_of(refusal), sides_of(refusal)
    if not step or not sides:
        return None
    checked = len(sides) > 1 and step != WAIT
    return next_step_button(step, "" if checked else sides[0], texts)


def next_step_of(refusal: Refusal) -> str:
    """Return the first required step, a key of `pills.NEXT_STEPS`; empty if no button can do it."""
    detail = refusal.outcome.detail
    if refusal.outcome.reason is Reason.NOT_HOLDER and detail is not None and detail.value is None:
        return WAIT  # another seat holds the robot; with a `value`, a lease of this seat has ended
    needs = [] if detail is None else detail.needs
    if needs[:2] == ["ENABLE", "CALIBRATE"] and sides_of(refusal) == ("sim",):
        return MAKE_READY  # of the hardware only ENABLE: before CALIBRATE the user sets its head upright
    return needs[0] if needs and needs[0] in NEXT_STEPS else ""


def sides_of(refusal: Refusal) -> tuple[str, ...]:
    """Return the robots that refused."""
    side = side_of(refusal.outcome)
    if side or refusal.request is None:
        return (side,) if side else ()
    return sides_of_request(refusal.request)


def _alternative_request(refusal: Refusal) -> Send | None:
    """Return the refused motion with the alternative that would be accepted; None if there is none."""
    detail = refusal.outcome.detail
    other = None if detail is None else detail.alternative
    if other is None or not isinstance(refusal.request, Send):
        return None
    query = alternative_query(refusal.request.query, other)
    return None if query is None else msgspec.structs.replace(refusal.request, query=query)


def alternative_query(query: MotionQuery | PoseQuery, other: Alternative) -> MotionQuery | PoseQuery | None:
    """Return a query changed by an alternative; None if the alternative does not fit the query."""
    if isinstance(query, PoseQuery):
        speed = query.speed if other.speed is None else min(other.speed.x, other.speed.y, other.speed.z)
        if other.head is not None:
            head = other.head
            return PoseQuery(yaw=head.yaw, pitch=head.pitch, roll=head.roll, speed=speed)
        if other.arms is not None:
            each = None if speed is None else Vector3(speed, speed, speed)
            return MotionQuery(position=other.arms, speed=each)
        return None if other.speed is None else msgspec.structs.replace(query, speed=speed)
    if other.arms is not None:
        return MotionQuery(position=other.arms, speed=other.speed or query.speed)
    return None if other.speed is None else msgspec.structs.replace(query, speed=other.speed)


def _alternative_text(request: Send, refused: Request, texts: Texts) -> str:
    """Return the alternative in a few words."""
    query = request.query
    if isinstance(refused, Send) and msgspec.structs.replace(refused.query, speed=query.speed) == query:
        speed = query.speed
        slowest = min(speed.x, speed.y, speed.z) if isinstance(speed, Vector3) else speed
        return texts("alternative.speed", speed=math.degrees(slowest or 0.0))
    if isinstance(query, PoseQuery):
        head = head_of(query)
        return texts("alternative.head", yaw=head.yaw, pitch=head.pitch, roll=head.roll)
    return texts("alternative.arms", **arm_angles(query.position)._asdict())


HANDLES: Handles = {TakeAlternative: take_alternative, DismissRefusal: dismiss}


def follow(memory: Memory, world: World) -> None:
    """Hide the shown refusal once its robots are ready again, after one of them was not."""
    refusal = memory.refusal
    if refusal is None:
        return
    sides, texts = sides_of(refusal) or memory.choices.sides, memory.choices.texts
    found = {finding(world, side, texts).condition for side in sides}
    if not found <= {Condition.READY, Condition.MOVING}:
        memory.refusal = replace(refusal, seen=True)
    elif refusal.seen:
        memory.refusal = None
