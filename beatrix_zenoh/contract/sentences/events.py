"""Events in words: a line from which a motion can be repeated, and a plain sentence.

`sentence` is for log files and terminals; `plain_sentence` for people who watch a robot: `ana: look left 26° (1.4 s)`.
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
    Source,
    Vector3,
)

REQUESTS: Final = (EventKind.MOTION, EventKind.COMMAND, EventKind.STOP)
FROM: Final = {
    Source.SDK: "from Python",
    Source.CLI: "from the command line",
    Source.WINDOW: "from the window",
    Source.PAGE: "from the page",
    Source.PLAY: "from a choreography",
    Source.REPLAY: "from a replay",
    Source.OLD_PROGRAM: "from an old program",
    Source.ARM_TOPIC: "from a per-arm topic",
    Source.ZENOH: "over Zenoh",
}
DIRECTIONS: Final = {"yaw": ("left", "right"), "pitch": ("down", "up"), "roll": ("tilt right", "tilt left")}
"""Words for positive and negative angles of the head."""
REPORTS: Final = (
    EventKind.BOARD,
    EventKind.ROUTER,
    EventKind.CAMERA,
    EventKind.MICROPHONES,
    EventKind.WARNING,
    EventKind.LOG,
)
"""Kinds of events that no seat has requested."""


def sentence(event: Event) -> str:
    """Return an event as one line: seat, request, source, outcome and message.

    A motion is written with its angles (deg) and speed (deg/s), as it was requested.
    """
    query = event.motion_query or event.pose_query
    if query is not None:
        words = [event.seat or "-", "asked", request(query)]
    else:
        number = str(event.motion) if event.motion else ""
        seat = event.seat or ("an unknown seat" if event.kind is EventKind.STOP else "")
        words = [seat, *dict.fromkeys((str(event.kind), event.action)), number]
    subject = _joined(*words)
    good = event.reason is Reason.OK
    end = _joined("" if query is not None and good else outcome(event), "" if good else event.reason)
    if event.source is not None:
        subject, end = f"{subject}, {FROM[event.source]}", f", {end}" if end else ""
    elif end:
        end = f" {end}"
    times = f" ({event.count} times)" if event.count > 1 else ""
    return f"{subject}{end}{times}: {event.message}{_goal(event)}"


def _joined(*words: str) -> str:
    return " ".join(word for word in words if word)


def outcome(event: Event) -> str:
    """Return the outcome of a request as a word; empty if it is not a request, or its message gives the outcome."""
    if event.reason is Reason.OK:
        return str(event.phase or "")
    if event.phase is Phase.DONE:
        return "ended"
    return "refused" if event.kind in REQUESTS else ""


def request(query: MotionQuery | PoseQuery) -> str:
    """Return a motion as it was requested: `look yaw 20.0°, pitch 0.0°, roll 0.0° at 40°/s, lead 2 s`."""
    if isinstance(query, PoseQuery):
        verb, angles = "look", {"yaw": query.yaw, "pitch": query.pitch, "roll": query.roll}
    else:
        arms = query.position
        verb, angles = "move", {"short": arms.x, "middle": arms.y, "long": arms.z}
    relative = "" if query.absolute else "relative "
    numbers = ", ".join(f"{name} {angle(value)}" for name, value in angles.items())
    lead = "" if query.lead is None else f", lead {query.lead:.6g} s"
    return f"{verb} {relative}{numbers} {_speed(query.speed)}{lead}"


def angle(value: float) -> str:
    """Return an angle (rad) in degrees with one to three decimals."""
    whole, _, decimals = f"{math.degrees(value):z.3f}".partition(".")
    return f"{whole}.{decimals[0]}{decimals[1:].rstrip('0')}°"


def _speed(speed: Vector3 | float | None) -> str:
    if speed is None:
        return "at the default speed"
    each = (speed.x, speed.y, speed.z) if isinstance(speed, Vector3) else (speed,)
    shown = [f"{round(math.degrees(one), 3):.7g}" for one in each]
    return f"at {', '.join(shown if len(set(shown)) > 1 else shown[:1])}°/s"


def _goal(event: Event) -> str:
    """Return the goal of an accepted motion, with its number; empty for other events."""
    if event.position is None or event.phase is not Phase.ACCEPTED:
        return ""
    arms = event.position
    return f" Motion {event.motion} to arms {', '.join(map(angle, (arms.x, arms.y, arms.z)))}."


# -- for people who watch a robot


def plain_sentence(event: Event) -> str:
    """Return an event as one sentence: seat, request in words, and how long it takes or why it was refused."""
    text = _plain(event)
    return f"{text} ({event.count} times)" if event.count > 1 else text


def _plain(event: Event) -> str:
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
    return f"{verb}{relative} {', '.join(parts)}{lead}{_plain_speeds(query)}"


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


def _plain_speeds(query: MotionQuery | PoseQuery) -> str:
    """Return the speeds of the arms if they differ, because they then tilt the head on the way."""
    speed = query.speed
    if not isinstance(speed, Vector3) or speed.x == speed.y == speed.z:
        return ""
    shown = ", ".join(_degrees(one) for one in (speed.x, speed.y, speed.z))
    return f", at {shown} per second"


def _degrees(angle: float) -> str:
    """Return an angle (rad) in degrees with at most one decimal."""
    return f"{math.degrees(angle):z.1f}".removesuffix(".0") + "°"
