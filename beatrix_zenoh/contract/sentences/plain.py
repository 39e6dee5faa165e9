"""Events in words for people who watch a robot: `ana: look left 26°, up 8° (1.4 s)`.

`sentences.events` writes the same events for log files, with everything that is needed to repeat a motion.
"""

from __future__ import annotations

import math
from typing import Final

from beatrix_zenoh.contract._generated.messages import (
    Event,
    EventKind,
    MotionQuery,
    Phase,
    PoseQuery,
    Reason,
    Vector3,
)

DIRECTIONS: Final = {"yaw": ("left", "right"), "pitch": ("down", "up"), "roll": ("tilt right", "tilt left")}
"""Words for positive and negative angles of the head."""
REPORTS: Final = (EventKind.BOARD, EventKind.ROUTER, EventKind.CAMERA, EventKind.WARNING, EventKind.LOG)
"""Kinds of events that no seat has requested."""


def plain_sentence(event: Event) -> str:
    """Return an event as one sentence: seat, request in words, and how long it takes or why it was refused."""
    text = _sentence(event)
    return f"{text} ({event.count} times)" if event.count > 1 else text


def _sentence(event: Event) -> str:
    request = plain_request(event)
    good = event.reason is Reason.OK
    if event.kind in REPORTS or (event.kind is EventKind.LEASE and good):
        return event.message
    seat = event.seat or "unknown seat"
    if event.kind is EventKind.STOP:
        return f"{seat}: {request}: {event.message}"
    if event.phase is Phase.DONE or (good and event.kind is EventKind.COMMAND):
        return f"{seat}: {event.message}"
    if good and event.kind is EventKind.MOTION:
        return f"{seat}: {request} ({event.duration:.1f} s)"
    return f"{seat}: {request}{'' if good else ' refused'}: {event.message}"


def plain_request(event: Event) -> str:
    """Return what was requested: `look left 26°, up 8°, lead 1.5 s`, `short arm 20°`, `enable`, `STOP`."""
    query = event.motion_query or event.pose_query
    if query is None:
        stop = event.kind is EventKind.STOP
        return event.action.replace("_", " ") if stop else event.action.replace("_", " ").lower()
    verb, parts = ("look", _head(query)) if isinstance(query, PoseQuery) else ("arms", _arms(query.position))
    relative = "" if query.absolute else " further by" if verb == "arms" else " further"
    lead = f", lead {query.lead:.3g} s" if query.lead else ""
    return f"{verb}{relative} {', '.join(parts)}{lead}{_speeds(query)}"


def _head(query: PoseQuery) -> list[str]:
    parts = []
    for name, (positive, negative) in DIRECTIONS.items():
        degrees = _degrees(getattr(query, name))
        if degrees != "0°":
            word = negative if degrees.startswith("-") else positive
            parts.append(f"{word} {degrees.removeprefix('-')}")
    return parts or ["straight ahead" if query.absolute else "0°"]


def _arms(arms: Vector3) -> list[str]:
    return [
        f"{name} {_degrees(angle)}"
        for name, angle in (("short", arms.x), ("middle", arms.y), ("long", arms.z))
    ]


def _speeds(query: MotionQuery | PoseQuery) -> str:
    """Return the speeds of the arms if they differ, because they then tilt the head on the way."""
    speed = query.speed
    if not isinstance(speed, Vector3) or speed.x == speed.y == speed.z:
        return ""
    shown = ", ".join(_degrees(one) for one in (speed.x, speed.y, speed.z))
    return f", at {shown} per second"


def _degrees(angle: float) -> str:
    """Return an angle (rad) in degrees with at most one decimal."""
    return f"{math.degrees(angle):z.1f}".removesuffix(".0") + "°"
