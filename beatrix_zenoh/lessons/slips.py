"""Slips of any lesson, recognised in one place: radians for degrees, the other sign, and a robot that was not moved."""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np
import numpy.typing as npt

from beatrix_zenoh.contract._generated.messages import Event, Phase, Reason
from beatrix_zenoh.lessons.phrases import Unmet
from beatrix_zenoh.lessons.stage import Seen

LARGE = 0.25
"""Only numbers of at least this share of the largest one count: small ones fit to any slip."""
MOST = 0.75
"""Share of those numbers that shows a slip; the others may have a second fault."""
ROUGH = 0.2
"""Part by which an angle in radians may be off: a tangent instead of the angle counts, too."""
TINY_DEG = 2.0
"""A program whose largest angle (deg) is smaller has perhaps sent radians: a right angle is 1.6 then."""


def numbers(name: str, said: npt.ArrayLike, true: npt.ArrayLike, near: float) -> None:
    """Raise Unmet, `radians` or `sign`, if that is what is wrong with the numbers of a function.

    Args:
        name: what the numbers are, for example the function.
        said: numbers of the pupil's function.
        true: the right ones, angles in degrees.
        near: how far a right number may be off.
    """
    found, right = (np.asarray(values, dtype=float).ravel() for values in (said, true))
    size = np.abs(right)
    large = (size >= LARGE * size.max()) & (size > near)
    if not large.any() or (np.abs(found - right) <= near)[large].any():
        return
    in_radians = np.abs(np.abs(np.degrees(found)) - size) <= near + ROUGH * size
    for figure, fits in (("radians", in_radians), ("sign", np.abs(found + right) <= near)):
        if fits[large].mean() >= MOST:
            at = int((size * (fits & large)).argmax())
            raise Unmet(figure, name=name, said=found[at], true=right[at])


def motions(robots: Iterable[Seen]) -> None:
    """Raise Unmet, `nothing`, `all_refused` or `tiny`, if that is why a program moved none of these robots."""
    asked = [event for seen in robots for _, event in seen.motions if event.phase is Phase.ACCEPTED]
    if not asked:
        raise Unmet("nothing")
    if all(event.reason is not Reason.OK for event in asked):
        raise Unmet("all_refused", count=sum(event.count for event in asked))
    largest = max(abs(angle) for event in asked for angle in _angles(event))
    if 0 < largest < TINY_DEG:
        raise Unmet("tiny", largest=largest)


def _angles(event: Event) -> tuple[float, ...]:
    """Return the angles (deg) that a motion has asked for; none if the event has no query."""
    pose, query = event.pose_query, event.motion_query
    if pose is not None:
        angles = (pose.yaw, pose.pitch, pose.roll)
    else:
        angles = (0.0, 0.0, 0.0) if query is None else (query.position.x, query.position.y, query.position.z)
    return tuple(map(math.degrees, angles))
