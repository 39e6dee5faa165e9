"""Events in words, for log files, terminals and recordings: a line from which a motion can be repeated."""

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
