"""Requests of motions in the events of a robot, and which of them went to simulation and hardware."""

from __future__ import annotations

import bisect
import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Final, NamedTuple

import msgspec

from beatrix_zenoh.contract._generated.messages import (
    Event,
    EventKind,
    MotionQuery,
    Phase,
    PoseQuery,
    Reason,
    Source,
)

FAR_S: Final = 5.0
"""The hardware may receive a request this much (s) before the simulation, or after the lead: clocks may differ."""
STREAM_S: Final = 1.5
"""A node counts the requests of a stream for a second; requests this close (s) to counted ones belong to the stream."""
HOME: Final = "HOME"
MOVED: Final = "moved"
"""Begin of the content of a movement whose request was not recorded."""
SETS_HOME: Final = ("CALIBRATE", "@CALNOW")
"""The command, and the line of an old program, after which angles count from another home."""

Content = MotionQuery | PoseQuery | str
"""What was requested, without lease, lead and source; HOME for the command of this name."""


@dataclass(frozen=True)
class MotionRequest:
    """One request of a motion to one robot, and what came of it."""

    t: float
    """time (s) at which the robot accepted or refused it, by the clock of the recording"""
    content: Content
    seat: str
    lead_s: float | None = None
    """the lead (s) that was requested; None: the request went to one robot alone"""
    motion: int = 0
    """number of the motion; 0: unknown"""
    refused: str = ""
    """sentence of the refusal; empty: the motion was accepted"""
    end: Reason | None = None
    """OK: at the goal; the reason if it ended before; None: not recorded"""
    end_s: float | None = None
    """time (s) of the end"""
    count: int = 1
    """number of requests of a stream of targets that this one represents"""

    @property
    def unrecorded(self) -> bool:
        """Whether only the movement was recorded, not its request."""
        return isinstance(self.content, str) and self.content.startswith(MOVED)

    @property
    def absolute(self) -> bool:
        """Whether the goal does not depend on the present position."""
        return isinstance(self.content, str) or self.content.absolute


def requests(events: Iterable[tuple[float, Event]]) -> tuple[MotionRequest, ...]:
    """Return the requests of motions in the events of one robot, each event with its time (s), in order of time."""
    found: list[MotionRequest] = []
    for t, event in events:
        if event.kind is EventKind.COMMAND and event.action == HOME and event.reason is Reason.OK:
            found.append(MotionRequest(t - event.duration, HOME, event.seat, end=Reason.OK, end_s=t))
        elif event.kind is EventKind.MOTION and event.phase is Phase.DONE:
            found = ended(found, t, event)
        elif event.kind is EventKind.MOTION and (query := event.motion_query or event.pose_query) is not None:
            found.append(
                MotionRequest(
                    t,
                    msgspec.structs.replace(query, lease=0, lead=None, source=Source.ZENOH),
                    event.seat,
                    query.lead,
                    event.motion,
                    "" if event.reason is Reason.OK else event.message or event.reason,
                    count=event.count,
                )
            )
    return tuple(sorted(found, key=lambda request: request.t))


def homes_set(events: Iterable[tuple[float, Event]]) -> tuple[float, ...]:
    """Return the times (s) at which the present position was declared home, by events of one robot with their times."""
    return tuple(
        t
        for t, event in events
        if event.kind is EventKind.COMMAND and event.action in SETS_HOME and event.reason is Reason.OK
    )


def ended(found: list[MotionRequest], t: float, event: Event) -> list[MotionRequest]:
    """Return the requests with the end of the newest one that has the number of this event."""
    for i in range(len(found) - 1, -1, -1):
        if found[i].motion == event.motion and not found[i].refused:
            return [*found[:i], replace(found[i], end=event.reason, end_s=t), *found[i + 1 :]]
    return found


class Pair(NamedTuple):
    """A request that both robots received; None: this robot never received it."""

    sim: MotionRequest | None
    hw: MotionRequest | None


def pairs(
    sim: Sequence[MotionRequest],
    hw: Sequence[MotionRequest],
    begin_s: float = -math.inf,
    end_s: float = math.inf,
) -> list[Pair]:
    """Match the requests of both robots by content, seat and order; unmatched ones are pairs with None.

    A request to the hardware belongs to the request to the simulation whose lead explains its time best. If the same
    motions are repeated and the hardware is late, the lead alone matches each with a later one, and leaves some without a
    partner; so the least lateness that leaves the fewest of those is assumed.

    Args:
        sim: requests to the simulation in order of time.
        hw: requests to the hardware in order of time.
        begin_s: begin of the recording (s); a request whose partner would be outside may have none.
        end_s: its end (s).
    """

    def left(late: float) -> int:
        """Return the number of requests without a partner that should have been recorded."""
        alone = [pair for pair in matched(sim, hw, late) if None in pair]
        times = [one.t + (one.lead_s or 0.0) + late for one, _ in alone if one is not None]
        times += [other.t - (other.lead_s or 0.0) - late for _, other in alone if other is not None]
        return sum(begin_s <= t <= end_s for t in times)

    lates = {late_s(one, other) for other in (*hw[:1], *hw[-1:]) for one in sim if fits(one, other)}
    best = min((0.0, *sorted(lates, key=abs)), key=left) if left(0.0) else 0.0
    return sorted(matched(sim, hw, best), key=first_s)


def matched(sim: Sequence[MotionRequest], hw: Sequence[MotionRequest], late: float) -> list[Pair]:
    """Match requests as `pairs` does, if the hardware is late by `late` (s)."""
    partner: dict[int, int] = {}
    first = 0
    for j, later in enumerate(hw):
        fitting = [i for i in range(first, len(sim)) if fits(sim[i], later)]
        if not fitting:
            continue
        best = min(fitting, key=lambda i: (abs(late_s(sim[i], later) - late), i))
        next_one = next((other for other in hw[j + 1 :] if fits(sim[best], other)), later)
        if abs(late_s(sim[best], next_one) - late) >= abs(late_s(sim[best], later) - late):
            partner[j], first = best, best + 1
    found = set(partner.values())
    both = [Pair(sim[partner[j]] if j in partner else None, later) for j, later in enumerate(hw)]
    return [*both, *(Pair(one, None) for i, one in enumerate(sim) if i not in found)]


def first_s(pair: Pair) -> float:
    """Return the time (s) at which the first of both robots received the request."""
    return min(request.t for request in pair if request is not None)


def late_s(sim: MotionRequest, hw: MotionRequest) -> float:
    """Return how much later (s) than its lead the hardware received a request."""
    return hw.t - sim.t - (sim.lead_s or 0.0)


def fits(sim: MotionRequest, hw: MotionRequest) -> bool:
    """Return whether a request to the hardware may be the same as one to the simulation.

    A lead can be ended at any time, so the hardware may begin before its end.
    """
    same = (sim.content, sim.seat, sim.lead_s is None) == (hw.content, hw.seat, hw.lead_s is None)
    return same and hw.t - sim.t >= -FAR_S and late_s(sim, hw) <= FAR_S


class Shared(NamedTuple):
    """A motion that both robots made."""

    sim: MotionRequest
    hw: MotionRequest
    lead_s: float | None
    """the lead (s) after the first request"""
    first: MotionRequest
    """the request that began the movement of the simulation; it is not `sim` if the lead was changed"""
    replaced: tuple[MotionRequest, ...]
    """earlier requests to the simulation, which `sim` repeated with another lead"""


def shared(matched: Sequence[Pair]) -> list[Shared]:
    """Return the motions that both robots accepted.

    If the lead of a motion was changed, the simulation received it twice: its movement begins at the first request.
    """
    found: list[Shared] = []
    for i, (sim, hw) in enumerate(matched):
        if sim is None or hw is None or sim.refused or hw.refused:
            continue
        lead_s, first = sim.lead_s, sim
        replaced: tuple[MotionRequest, ...] = ()
        for before in reversed([pair.sim for pair in matched[:i]]):
            if before is None or before.refused or not changes(before, first):
                break
            lead_s, first, replaced = (lead_s or 0.0) + first.t - before.t, before, (*replaced, before)
        found.append(Shared(sim, hw, lead_s, first, replaced))
    return found


def changes(before: MotionRequest, after: MotionRequest) -> bool:
    """Return whether a request only changes the lead of the one before."""
    waits = before.lead_s is not None and after.t < before.t + before.lead_s
    return (
        waits
        and before.absolute
        and (before.content, before.seat) == (after.content, after.seat)
        and before.end in (None, Reason.OK, Reason.REPLACED)
    )


class Alone(NamedTuple):
    """A motion that only one robot carried out."""

    t: float
    """time (s) of its request"""
    hardware: bool
    """whether the hardware carried it out"""


def alone(matched: Sequence[Pair], end_s: float) -> Iterator[Alone]:
    """Yield the motions that only one robot was asked for, or accepted, up to the end (s) of the recording."""
    made = {id(request) for motion in shared(matched) for request in motion.replaced}
    streams = sorted(
        request.t for pair in matched for request in pair if request is not None and request.count > 1
    )
    for pair in matched:
        if first_s(pair) > end_s or any(request is not None and near(request.t, streams) for request in pair):
            continue
        accepted = [request is not None and not request.refused for request in pair]
        if accepted[0] != accepted[1]:
            request = pair[accepted[1]]
            if request is not None and not request.unrecorded and id(request) not in made:
                yield Alone(request.t, hardware=accepted[1])


def near(t: float, streams: Sequence[float]) -> bool:
    """Return whether a request is one of a stream of targets, whose times (s) are given.

    A node counts the requests of a fast stream instead of sending each, so some requests of one robot have no partner.
    """
    i = bisect.bisect_left(streams, t)
    return any(abs(other - t) < STREAM_S for other in streams[max(0, i - 1) : i + 1])
