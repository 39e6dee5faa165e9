"""The handle of one request: its key, its caller, and the functions that reply to it.

A query with wildcards may match several robots, so it moves none of them.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import lru_cache

import msgspec

from beatrix_zenoh.bus import Incoming
from beatrix_zenoh.contract import refusals
from beatrix_zenoh.contract._generated.messages import (
    CommandReply,
    EventKind,
    LeaseReply,
    MotionQuery,
    MotionReply,
    Phase,
    PoseQuery,
    PreviewReply,
    Reason,
    Source,
)
from beatrix_zenoh.node.events import EventLog
from beatrix_zenoh.node.lease import Caller

ANONYMOUS = "anonymous"
"""Seat in the key of a reply if the query had none."""
CACHED_KEYS = 256


@lru_cache(maxsize=CACHED_KEYS)
def seat_of(key: str, served: str) -> str:
    """Return the seat in a key: the chunk at the place of `*` in the served key; empty for a wildcard.

    The key may have wildcards before and after the seat: `beatrix/**/stop/ana`, `beatrix/*/hw/cmd/ana/*`.
    """
    chunks, pattern = key.split("/"), served.split("/")
    if "*" not in pattern:
        return ""
    place = pattern.index("*") - len(pattern)
    named = len(chunks) > -place and chunks[place - 1] == pattern[place - 1]
    return chunks[place] if named and "*" not in chunks[place] else ""


@lru_cache(maxsize=CACHED_KEYS)
def own_key(served: str, seat: str) -> str:
    """Return the served key with the seat in place of `*`; ANONYMOUS for an empty seat."""
    return served.replace("*", seat or ANONYMOUS)


def check_own_key(key: str, served: str) -> None:
    """Raise Refused (BAD_VALUE) unless `key` is the served key with a concrete seat."""
    own = own_key(served, seat_of(key, served) or "me")
    if key != own:
        raise refusals.wildcard_key(key, own)


Reply = MotionReply | CommandReply | LeaseReply | PreviewReply


@dataclass(frozen=True)
class RequestHandle:
    """A request of one caller.

    `reply` may be called several times; `end` sends the last reply. Replies are recorded as events, except those to
    previews.
    """

    caller: Caller
    action: str
    """`motion`, `pose`, `preview`, `<arm> target`, or the name of a command or of a lease action"""
    events: EventLog | None
    """None: do not record replies"""
    send: Callable[[msgspec.Struct], None] = field(default=lambda _: None)
    finish: Callable[[], None] = field(default=lambda: None)
    kind: EventKind = EventKind.MOTION
    source: Source | None = None
    """None: not known"""
    query: MotionQuery | PoseQuery | None = None
    """the motion as it was requested; None: no motion, or the request was not decoded"""

    def reply(self, message: Reply) -> None:
        """Send a reply and record it."""
        self.send(message)
        if self.events is None or isinstance(message, PreviewReply):
            return
        motion = message if isinstance(message, MotionReply) else None
        done = motion is not None and motion.phase is Phase.DONE
        arrives = motion is not None and (done or motion.reason is Reason.OK)
        self.events.add(
            self.kind,
            action=self.action,
            caller=self.caller,
            phase=None if motion is None else motion.phase,
            reason=message.reason,
            message=message.message,
            motion=0 if motion is None else motion.motion,
            duration_s=0.0 if motion is None else motion.duration,
            detail=message.detail,
            source=None if done else self.source,
            query=None if done else self.query,
            position=message.position if arrives and isinstance(message, MotionReply) else None,
        )

    def end(self, message: Reply) -> None:
        """Send the last reply."""
        self.reply(message)
        self.finish()


def request_handle(
    incoming: Incoming, key: str, action: str, events: EventLog, kind: EventKind = EventKind.MOTION
) -> RequestHandle:
    """Return the handle of a query; the key of its replies is the served `key` with the seat in place of `*`."""
    seat = seat_of(incoming.key, key)
    reply_key = own_key(key, seat)
    raw = incoming.raw

    def send(message: msgspec.Struct) -> None:
        incoming.reply(reply_key, *raw.answer(message))

    return RequestHandle(Caller(seat, incoming.session), action, events, send, incoming.finish, kind)
