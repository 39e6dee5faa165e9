"""Requests of other seats, grouped from the events of both robots."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

from beatrix_zenoh.contract._generated.messages import Event, EventKind, MotionQuery, Phase, PoseQuery, Reason
from gui.console.state.world import World

KINDS: Final = (EventKind.MOTION, EventKind.COMMAND, EventKind.STOP, EventKind.LEASE)
COMMANDS: Final = ("enable", "disable", "calibrate", "home", "stop", "emergency_stop", "reset")
LEASES: Final = ("take", "wait", "give_back", "freeze", "unfreeze", "limit", "turn", "mute", "unmute")
WHATS: Final = {
    "motion": "what.other_move",
    "pose": "what.other_look",
    **{word.upper(): f"what.{word}" for word in COMMANDS},
    **{word: f"what.{word}" for word in LEASES},
}
"""Text key of each action in events."""
FINE: Final = {Reason.OK, Reason.REPLACED}
STREAM_S: Final = 3.0
"""Requests of one seat for the same action, each within this time after the previous one, form one row."""


@dataclass
class Group:
    """The events of one row."""

    began: Event
    side: str
    """the robot of the first event"""
    newest: Event
    """the newest request, or its end; of several robots the one that has failed"""
    requested_s: float
    """time of the newest request (wall clock, s)"""
    count: int
    """number of requests to the first robot"""
    reasons: dict[str, Reason]
    """of the newest event of each robot"""

    @property
    def began_s(self) -> float:
        """Time of the first event (wall clock, s)."""
        return self.began.t_wall_ns / 1e9

    @property
    def ended(self) -> bool:
        """Whether the newest event is the end of a motion."""
        return self.newest.phase is Phase.DONE

    @property
    def under_way(self) -> bool:
        """Whether a motion was accepted that has not ended."""
        newest = self.newest
        return newest.kind is EventKind.MOTION and newest.reason is Reason.OK and not self.ended

    @property
    def query(self) -> MotionQuery | PoseQuery | None:
        """The motion as it was requested, unless several were."""
        return (self.began.motion_query or self.began.pose_query) if self.count == 1 else None

    def takes(self, event: Event, side: str) -> bool:
        """Return whether an event of the same seat and action belongs to this row."""
        late_s = event.t_wall_ns / 1e9 - self.requested_s
        alike = self.reasons.get(side, event.reason) in (event.reason, Reason.REPLACED)
        return event.phase is Phase.DONE or (alike and late_s <= STREAM_S)

    def add(self, event: Event, side: str) -> None:
        """Add an event; the end of a motion that a newer one of the same row has replaced changes nothing."""
        self.reasons[side] = event.reason
        if event.phase is not Phase.DONE:
            self.requested_s = event.t_wall_ns / 1e9
            self.count += event.count * (side == self.side)
        elif self.newest.reason is not Reason.OK or (self.count > 1 and event.reason is Reason.REPLACED):
            return
        others = {reason for other, reason in self.reasons.items() if other != side}
        if event.reason not in FINE or others <= FINE:
            self.newest = event


def groups(world: World) -> tuple[Group, ...]:
    """Return a group for each request or stream of equal requests of another seat, oldest first."""
    found: list[Group] = []
    last: dict[tuple[str, str], Group] = {}
    for event, side in sorted(_foreign(world), key=lambda entry: entry[0].t_wall_ns):
        group = last.get((event.seat, event.action))
        if group is not None and group.takes(event, side):
            group.add(event, side)
        else:
            group = Group(event, side, event, event.t_wall_ns / 1e9, event.count, {side: event.reason})
            last[event.seat, event.action] = group
            found.append(group)
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
