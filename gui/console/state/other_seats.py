"""Requests of other seats, grouped from the events of both robots."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Final

from beatrix_zenoh.contract._generated.messages import (
    Detail,
    Event,
    EventKind,
    MotionQuery,
    Phase,
    PoseQuery,
    Reason,
)
from gui.console.state.world import World

KINDS: Final = (EventKind.MOTION, EventKind.COMMAND, EventKind.STOP, EventKind.LEASE)
WHATS: Final = {
    "motion": "what.other_move",
    "pose": "what.other_look",
    **{
        word.upper(): f"what.{word}"
        for word in ("enable", "disable", "calibrate", "home", "stop", "emergency_stop", "reset")
    },
    **{
        word: f"what.{word}"
        for word in ("take", "wait", "give_back", "freeze", "unfreeze", "limit", "turn", "mute", "unmute")
    },
}
"""Text key of each action in events."""
STREAM_S: Final = 3.0
"""Equal requests to one robot, each within this time after the previous one, form one row."""
UNSEEN_S: Final = 5.0
"""Time after the expected end of a motion, in which its event should have arrived."""
LEAD_S: Final = 3.0
"""Equal requests of a seat to simulation and hardware within this time form one row: the second may follow after a
lead."""


@dataclass(frozen=True)
class Group:
    """The events of one row."""

    seat: str
    action: str
    began_s: float
    """wall clock, since 1970"""
    newest_s: float
    """time of the newest request"""
    motions: Mapping[str, int]
    """number of the newest motion of each robot; 0: the request is no motion"""
    under_way: frozenset[str]
    """robots whose newest motion has not ended"""
    count: int
    """number of requests to the first robot"""
    ended: bool
    """whether the fields below describe the end of a motion, not its beginning"""
    reason: Reason
    message: str
    detail: Detail | None
    duration_s: float
    query: MotionQuery | PoseQuery | None
    """the newest motion as it was requested"""

    @property
    def due_s(self) -> float:
        """Time after which the end of the motion is unseen, for example because the router was lost (wall clock, s)."""
        return self.newest_s + self.duration_s + UNSEEN_S


def groups(world: World) -> tuple[Group, ...]:
    """Return a group for each request or stream of equal requests of another seat, oldest first."""
    found: list[Group] = []
    for event, side in sorted(_foreign(world), key=lambda entry: entry[0].t_wall_ns):
        place = _place(found, event, side)
        if place is None:
            found.append(_group(event, side))
        else:
            found[place] = _joined(found[place], event, side)
    return tuple(found)


def _foreign(world: World) -> Iterator[tuple[Event, str]]:
    for robot in (world.sim, world.hw):
        for event in robot.events:
            # A lease event without an action reports a change of the holder, not a request.
            if event.kind in KINDS and event.action and not _own(event, world):
                yield event, robot.side


def _own(event: Event, world: World) -> bool:
    """Return whether this window sent the event's request; compares seats, and sessions if both are known.

    Other clients can forge the session of a STOP, but in a class not the seat.
    """
    if event.seat not in ("", world.seat):
        return False
    if world.session and event.session:
        return event.session == world.session
    return event.seat == world.seat


def _place(found: list[Group], event: Event, side: str) -> int | None:
    """Return the index of the group that an event belongs to; None if the event begins a new group."""
    for index in range(len(found) - 1, -1, -1):
        group = found[index]
        if group.seat != event.seat or group.action != event.action:
            continue
        if event.phase is Phase.DONE:
            return index
        late_s = event.t_wall_ns / 1e9 - group.newest_s
        if side not in group.motions:
            return index if late_s <= LEAD_S else None
        alike = group.under_way or group.reason in (event.reason, Reason.REPLACED)
        return index if alike and late_s <= STREAM_S else None
    return None


def _group(event: Event, side: str) -> Group:
    moment_s = event.t_wall_ns / 1e9
    moves = event.kind is EventKind.MOTION and event.phase is not Phase.DONE and event.reason is Reason.OK
    return Group(
        seat=event.seat,
        action=event.action,
        began_s=moment_s,
        newest_s=moment_s,
        motions={side: event.motion},
        under_way=frozenset({side} if moves else ()),
        count=event.count,
        ended=event.phase is Phase.DONE,
        reason=event.reason,
        message=event.message,
        detail=event.detail,
        duration_s=event.duration,
        query=event.motion_query or event.pose_query,
    )


def _joined(group: Group, event: Event, side: str) -> Group:
    """Return the group with one more event."""
    new, first = _group(event, side), next(iter(group.motions))
    if event.phase is Phase.DONE:
        if group.motions.get(side) != event.motion:
            return group  # the event is the end of an earlier motion of a stream
        new = replace(new, newest_s=group.newest_s, count=group.count)
    else:
        new = replace(new, count=group.count + event.count * (side == first))
    failed = group.reason is not Reason.OK and not (side in group.motions and event.phase is not Phase.DONE)
    kept = group if failed else new  # the end at one robot must not hide the refusal of another robot
    return replace(
        new,
        began_s=group.began_s,
        motions={**group.motions, **new.motions},
        under_way=group.under_way - {side} | new.under_way,
        ended=kept.ended,
        reason=kept.reason,
        message=kept.message,
        detail=kept.detail,
        query=new.query or group.query,
        duration_s=max(group.duration_s, new.duration_s) if new.reason is Reason.OK else new.duration_s,
    )
