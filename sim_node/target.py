"""The place of the person in the scene: on a predefined path, or set by a client.

Places are in m from the neck centre: x forward, y left, z up.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from enum import StrEnum
from typing import Final

from beatrix_zenoh.bus import query_forms
from beatrix_zenoh.bus.query_forms import RawQuery
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import Detail, Reason, TargetQuery, TargetReply
from beatrix_zenoh.contract.errors import BeatrixError, Refused, quoted
from beatrix_zenoh.contract.refusals import bad_field
from beatrix_zenoh.motion.rotation import Vector
from beatrix_zenoh.node import QueryThread

BOUNDS: Final = {"x": (-1.9, 2.3), "y": (-2.0, 2.0), "z": (-0.6, 1.1)}
"""Allowed place of the person's eyes (m): inside the room."""
NEAREST: Final = 0.35
"""Smallest allowed distance (m) of the person's eyes from the neck's axis, so that person and robot do not overlap."""
HOME: Final[Vector] = (1.15, 0.0, 0.16)
"""The middle between the person's eyes at the start: behind the desk, in front of the robot, as in the model."""
PERIOD_S: Final = 12.0
"""Period of a path, unless a client chooses one."""
PERIODS_S: Final = (2.0, 600.0)
"""Shortest and longest period."""
_SWAY: Final = math.radians(40.0)
_CIRCLE: Final = 0.28


class TargetPath(StrEnum):
    """Movement of the person."""

    STILL = "still"
    SWAY = "sway"
    CIRCLE = "circle"


def on_path(path: TargetPath, t_s: float, period_s: float = PERIOD_S) -> Vector:
    """Return the place (m) of the person's eyes `t_s` after the start; every path begins at HOME."""
    x, z = HOME[0], HOME[2]
    turn = math.tau * t_s / period_s
    match path:
        case TargetPath.SWAY:
            yaw = _SWAY * math.sin(turn)
            return x * math.cos(yaw), x * math.sin(yaw), z
        case TargetPath.CIRCLE:
            return x, _CIRCLE * math.sin(turn), z + _CIRCLE * (1 - math.cos(turn)) / 2
        case TargetPath.STILL:
            return HOME


def check_range(field: str, value: float, low: float, high: float | None, unit: str, text: str) -> None:
    """Raise Refused (BAD_VALUE) with a sentence for a value of a query below `low` or above `high`."""
    if not low <= value <= (math.inf if high is None else high):
        raise Refused(Reason.BAD_VALUE, text, Detail(field=field, value=value, low=low, high=high, unit=unit))


def check_room(place: Vector, what: str) -> None:
    """Raise Refused (BAD_VALUE) for a place outside the room; `what` begins the sentence."""
    for (field, (low, high)), value in zip(BOUNDS.items(), place, strict=True):
        text = f"{what} {field} = {value:.2f} m; the room allows {low:.1f} to {high:.1f} m."
        check_range(field, value, low, high, "m", text)


def check(place: Vector) -> None:
    """Raise Refused (BAD_VALUE) for a place of the person outside the room or inside the robot."""
    check_room(place, "The person cannot be at")
    away = math.hypot(place[0], place[1])
    text = f"The person would be {away:.2f} m from the neck's axis; at least {NEAREST:.2f} m is allowed."
    check_range("x", away, NEAREST, None, "m", text)


class PersonTarget:
    """The person's place; any thread may read and set it."""

    def __init__(self, path: TargetPath, start_s: float) -> None:
        self._walk = path, start_s, PERIOD_S
        self._set: Vector | None = None

    def place(self, t_s: float) -> Vector:
        """Return the place (m) of the person's eyes at this time (s, the clock of `start_s`)."""
        chosen, (path, start_s, period_s) = self._set, self._walk
        return on_path(path, t_s - start_s, period_s) if chosen is None else chosen

    def move(self, place: Vector) -> None:
        """Set the place of the person's eyes (m), which ends the path; raises the errors of `check`."""
        check(place)
        self._set = place

    def walk(self, path: str, period_s: float, start_s: float) -> None:
        """Begin a path at this time (s); raises Refused (BAD_VALUE) for an unknown path, or a period outside PERIODS_S."""
        if path not in list(TargetPath):
            text = f"There is no path {quoted(path)} for the person. Choose {', '.join(TargetPath)}."
            raise bad_field("path", text, list(TargetPath))
        low, high = PERIODS_S
        text = f"A period of {period_s:g} s is not possible: give {low:g} to {high:g} s."
        check_range("period_s", period_s, low, high, "s", text)
        self._walk, self._set = (TargetPath(path), start_s, period_s), None


def target_queries(name: str, target: PersonTarget, clock_s: Callable[[], float]) -> QueryThread:
    """Return what answers queries that set or read the place of the person, on its own thread."""
    return QueryThread(
        "beatrix-target", {keys.target(name): lambda incoming: reply(target, incoming.raw, clock_s())}
    )


def change(target: PersonTarget, query: TargetQuery, now_s: float) -> None:
    """Move the person to the place of the query, or let it walk; raises Refused (BAD_VALUE) for neither, or both."""
    x, y, z = query.x, query.y, query.z
    if query.path and (x, y, z) == (None, None, None):
        target.walk(query.path, query.period_s, now_s)
    elif x is None or y is None or z is None or query.path:
        field = "path" if query.path else "x"
        raise bad_field(field, "Give x, y and z (m), or a path and its period.", ["x", "y", "z", "path"])
    else:
        target.move((x, y, z))


def reply(target: PersonTarget, raw: RawQuery, now_s: float) -> TargetReply:
    """Set the place if the query contains one, and return the place at `now_s` (the target's clock)."""
    refusal = refused(raw, lambda: change(target, query_forms.read(raw, TargetQuery), now_s))
    x, y, z = target.place(now_s)
    reason, message, detail = told(refusal)
    return TargetReply(result=refusal is None, reason=reason, message=message, x=x, y=y, z=z, detail=detail)


def refused(raw: RawQuery, carry_out: Callable[[], None]) -> BeatrixError | None:
    """Carry out a query, and return why it was refused, if it was; one without contents only asks."""
    if raw.payload or raw.parameters:
        try:
            carry_out()
        except BeatrixError as error:
            return error
    return None


def told(refusal: BeatrixError | None) -> tuple[Reason, str, Detail | None]:
    """Return what a reply says about a refusal; None: there is none."""
    return (Reason.OK, "", None) if refusal is None else (refusal.reason, refusal.message, refusal.detail)
