"""Requests in a node: the queue of the controller's thread, and for each request a handle with the functions that reply.

The queue keeps commands in order and only the newest motion of each seat; STOP and board changes come first. A query
with wildcards may match several robots, so it moves none of them.
"""

from __future__ import annotations

import contextlib
import math
import queue
import sched
import threading
import time
from collections import deque
from collections.abc import Callable, Hashable
from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import msgspec
from msgspec.structs import replace

from beatrix_zenoh.bus import Incoming
from beatrix_zenoh.contract import refusals
from beatrix_zenoh.contract._generated.messages import (
    CommandReply,
    Detail,
    EventKind,
    LeaseReply,
    MotionQuery,
    MotionReply,
    Phase,
    PoseQuery,
    Reason,
    Source,
)
from beatrix_zenoh.contract.errors import BeatrixError, Refused
from beatrix_zenoh.motion.gear import Arms
from beatrix_zenoh.node.callers import Caller
from beatrix_zenoh.node.events import NodeEvents, new_event
from beatrix_zenoh.node.planner import vector

CAPACITY = 64
"""Largest number of waiting entries. Beginning a motion takes about 1 ms, and a command that waits for telemetry 10 ms;
so the last entry waits for some tenths of a second, and STOP for one entry."""


Run = Callable[[], None]
"""Work for the reader's thread."""
Decline = Callable[[BeatrixError], None]
"""Called on the posting thread if the queue rejects or replaces the work."""


class _Entry(NamedTuple):
    run: Run
    decline: Decline


class ControllerQueue:
    """A bounded queue of work with one reader, in which `post_latest` replaces an entry with the same key."""

    def __init__(self) -> None:
        self._urgent: deque[_Entry] = deque()
        self._entries: dict[Hashable, _Entry] = {}
        self._lock = threading.Lock()
        self._arrived: queue.SimpleQueue[None] = queue.SimpleQueue()
        """One item for each entry and for `close`; a SimpleQueue wakes the reader in half the time of a Condition."""
        self._count = 0
        self._later = sched.scheduler(time.monotonic)
        """Appends the entries of `post_later` when they are due."""
        self._closed = False

    def post(self, run: Run, decline: Decline) -> None:
        """Append an entry; decline it as BUSY if the queue is full, as SHUTDOWN once closed."""
        self._queue(_Entry(run, decline), most=CAPACITY)

    def post_event(self, run: Run) -> None:
        """Append an entry even if the queue is full; drop it once closed."""
        self._queue(_Entry(run, lambda _: None), most=math.inf)

    def post_urgent(self, run: Run, decline: Decline = lambda _: None) -> None:
        """Put an entry before all entries that are not urgent; decline it once closed.

        This is for STOP and changes of the board.
        """
        self._queue(_Entry(run, decline), most=math.inf, urgent=True)

    def post_later(self, due_s: float, run: Run) -> None:
        """Append an entry at `due_s` (monotonic clock), after all that wait then; only the reader may call this."""
        self._later.enterabs(due_s, 0, self.post_event, (run,))

    def post_latest(self, key: Hashable, run: Run, decline: Decline = lambda _: None) -> None:
        """Append an entry as `post` does; remove a waiting entry with the same key and decline it as REPLACED."""
        entry = _Entry(run, decline)
        with self._lock:
            refusal = self._refusal(full=key not in self._entries and len(self._entries) >= CAPACITY)
            replaced = None if refusal is not None else self._entries.pop(key, None)
            if replaced is not None:
                self._entries[key] = entry
            elif refusal is None:
                self._put(key, entry)
        if refusal is not None:
            decline(refusal)
        if replaced is not None:
            replaced.decline(Refused(Reason.REPLACED))

    def _queue(self, entry: _Entry, *, most: float, urgent: bool = False) -> None:
        with self._lock:
            refusal = self._refusal(full=len(self._entries) >= most)
            if refusal is None and urgent:
                self._urgent.append(entry)
                self._arrived.put(None)
            elif refusal is None:
                self._count += 1
                self._put(self._count, entry)
        if refusal is not None:
            entry.decline(refusal)

    def _put(self, key: Hashable, entry: _Entry) -> None:
        self._entries[key] = entry
        self._arrived.put(None)

    def take(self) -> Run | None:
        """Wait for the next work and return it; return None once the queue is closed and empty."""
        while True:
            wait_s = self._later.run(blocking=False)
            with contextlib.suppress(queue.Empty):
                self._arrived.get(timeout=wait_s)
                break
        with self._lock:
            if self._urgent:
                return self._urgent.popleft().run
            return self._entries.pop(next(iter(self._entries))).run if self._entries else None

    def close(self) -> None:
        """Accept no more entries; the reader finishes the waiting ones."""
        with self._lock:
            self._closed = True
            self._arrived.put(None)

    def _refusal(self, *, full: bool) -> Refused | None:
        if self._closed:
            return Refused(Reason.SHUTDOWN)
        return refusals.queue_full(CAPACITY) if full else None


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
        raise Refused(Reason.BAD_VALUE, detail=Detail(field=key, known=[own]))


Reply = MotionReply | CommandReply | LeaseReply


def _nothing(*_: object) -> None:
    """Do nothing: the request has no replies."""


class RequestHandle(msgspec.Struct, frozen=True):
    """A request of one caller.

    `reply` may be called several times; `end` sends the last reply. Replies are recorded as events.
    """

    caller: Caller
    action: str
    """`motion`, `pose`, `<arm> target`, or the name of a command or of a lease action"""
    events: NodeEvents | None
    """None: do not record replies"""
    send: Callable[[msgspec.Struct], None] = _nothing
    finish: Callable[[], None] = _nothing
    kind: EventKind = EventKind.MOTION
    source: Source | None = None
    """None: not known"""
    query: MotionQuery | PoseQuery | None = None
    """the motion as it was requested; None: no motion, or the request was not decoded"""

    def reply(self, message: Reply) -> None:
        """Send a reply and record it."""
        self.send(message)
        if self.events is None:
            return
        motion = message if isinstance(message, MotionReply) else None
        done = motion is not None and motion.phase is Phase.DONE
        query = None if done else self.query
        event = new_event(
            kind=self.kind,
            action=self.action,
            seat=self.caller.seat,
            session=self.caller.session,
            reason=message.reason,
            message=message.message,
            detail=message.detail,
            source=None if done else self.source,
            motion_query=query if isinstance(query, MotionQuery) else None,
            pose_query=query if isinstance(query, PoseQuery) else None,
        )
        if motion is not None:
            position = motion.position if done or motion.reason is Reason.OK else None
            event = replace(
                event, phase=motion.phase, motion=motion.motion, duration=motion.duration, position=position
            )
        self.events.add(event)

    def end(self, message: Reply) -> None:
        """Send the last reply."""
        self.reply(message)
        self.finish()


@dataclass(frozen=True)
class Requests:
    """What the requests to one robot have in common: its name and side, the queue, the events that replies become."""

    name: str
    side: str
    queue: ControllerQueue
    events: NodeEvents

    def handle(
        self, incoming: Incoming, served: str, action: str, kind: EventKind = EventKind.MOTION
    ) -> RequestHandle:
        """Return the handle of a query; the key of its replies is the `served` key with the seat in place of `*`."""
        seat = seat_of(incoming.key, served)
        reply_key, raw = own_key(served, seat), incoming.raw

        def send(message: msgspec.Struct) -> None:
            incoming.reply(reply_key, *raw.answer(message))

        caller = Caller(seat, incoming.session)
        return RequestHandle(caller, action, self.events, send, incoming.finish, kind)


def command_reply(reason: Reason, text: str, position: Arms, detail: Detail | None = None) -> CommandReply:
    """Return a reply to a command; its result follows from the reason; `position`: set points of the arms (rad)."""
    return CommandReply(
        result=reason is Reason.OK, reason=reason, message=text, position=vector(position), detail=detail
    )


def command_refusal(error: BeatrixError, position: Arms) -> CommandReply:
    """Return the reply to a refused command; `position`: set points of the arms (rad)."""
    return command_reply(error.reason, error.message, position, error.detail)
