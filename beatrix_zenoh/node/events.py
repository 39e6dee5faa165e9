"""The events of the robot: the newest ones, for queries and the publisher; warnings, which the status also shows."""

from __future__ import annotations

import logging
import threading
import time
from collections import Counter, deque
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Final

from msgspec.structs import replace

from beatrix_zenoh import threads
from beatrix_zenoh.contract import printable
from beatrix_zenoh.contract._generated.messages import Event, EventKind, Events, Reason, SeatCount
from beatrix_zenoh.contract.sentences.events import sentence

KEPT: Final = 200
"""Number of newest events that the log keeps, for queries and for the publisher."""
BURST: Final = 10
"""Equal events per second that are published one by one; further ones are counted and published as one."""
WINDOW_S: Final = 1.0
STOP_SEATS: Final = 64
"""Largest number of seats whose STOPs are counted."""
_SEQS: Final = 2**32

_PRINTED: Final = (
    EventKind.BOARD,
    EventKind.ROUTER,
    EventKind.CAMERA,
    EventKind.MICROPHONES,
    EventKind.WARNING,
)
"""Kinds that are logged as warnings, which the process prints; the others are only written to the log file."""

log = logging.getLogger("beatrix_zenoh.node.events")

new_event = partial(Event, seq=0, t_mono_ns=0, t_wall_ns=0)
"""Returns an event without number and times, which `NodeEvents.add` gives it."""


@dataclass
class _Window:
    """Events of the last second with equal kind, action, caller, phase and reason."""

    began_s: float
    passed: int = 0
    held: Event | None = None
    """the newest event not yet published, with the number of such events as `count`"""


class NodeEvents:
    """The event log; any thread adds events, the publisher takes them, queries read the newest ones."""

    def __init__(
        self, monotonic_s: Callable[[], float] = time.monotonic, owner: threads.Owner | None = None
    ) -> None:
        """`owner`: the robot of the events, which Python's log names also if a thread of Zenoh adds them."""
        self._monotonic_s, self._owner = monotonic_s, owner
        self._lock = threading.Lock()
        self._seq = 0
        self._windows: dict[tuple[object, ...], _Window] = {}
        self._stops: Counter[str] = Counter()
        self._latest: deque[Event] = deque(maxlen=KEPT)
        self._unpublished: deque[Event] = deque(maxlen=KEPT)

    def add(self, event: Event) -> None:
        """Record an event (see `new_event`) with the present time: emit it, or hold it in a burst of equal ones."""
        event = replace(
            event,
            t_mono_ns=time.monotonic_ns(),
            t_wall_ns=time.time_ns(),
            seat=printable.name(event.seat),
            message=printable.line(event.message),
        )
        same = event.kind, event.action, event.seat, event.session, event.phase, event.reason
        emitted, now_s = [], self._monotonic_s()
        with self._lock:
            counts = event.kind is EventKind.STOP and event.reason is not Reason.MUTED
            if counts and (event.seat in self._stops or len(self._stops) < STOP_SEATS):
                self._stops[event.seat] += 1
            window = self._windows.get(same)
            if window is None:
                window = self._windows[same] = _Window(now_s)
            elif now_s - window.began_s >= WINDOW_S:
                emitted += self._flush(window, now_s)
            if window.passed < BURST:
                window.passed += 1
                emitted.append(self._emit(event))
            else:
                window.held = replace(event, count=1 if window.held is None else window.held.count + 1)
        self._write(emitted)  # after releasing the lock, because a log handler may wait

    def take(self) -> list[Event]:
        """Remove and return the events to publish now, oldest first."""
        now_s, emitted = self._monotonic_s(), []
        with self._lock:
            for key, window in list(self._windows.items()):
                if now_s - window.began_s >= WINDOW_S:
                    emitted += self._flush(window, now_s)
                    if not window.passed:
                        del self._windows[key]
            events = list(self._unpublished)
            self._unpublished.clear()
        self._write(emitted)
        return events

    def latest(self) -> Events:
        """Return the newest events."""
        with self._lock:
            return Events(events=list(self._latest))

    def stops(self) -> list[SeatCount]:
        """Return how often each seat has sent STOP, without those of a muted seat that were refused."""
        with self._lock:
            return [SeatCount(seat=seat, count=count) for seat, count in self._stops.items()]

    def _flush(self, window: _Window, now_s: float) -> list[Event]:
        held, window.held = window.held, None
        window.began_s, window.passed = now_s, int(held is not None)
        return [] if held is None else [self._emit(held)]

    def _emit(self, event: Event) -> Event:
        """Number an event, and store it for the publisher and for queries."""
        self._seq = (self._seq + 1) % _SEQS
        event = replace(event, seq=self._seq)
        self._latest.append(event)
        self._unpublished.append(event)
        return event

    def _write(self, events: list[Event]) -> None:
        """Write events to Python's log, except those that came from it."""
        if not events:
            return  # as in most turns of the publisher
        with threads.owned_by(self._owner):
            for event in events:
                if event.kind in _PRINTED:
                    log.warning("%s", event.message)
                elif event.kind is not EventKind.LOG and log.isEnabledFor(logging.INFO):
                    log.info("%s", sentence(event))


SHOWN_S = 10.0
LENGTH = 5
RESTARTED = "The board was restarted, and home is not known. Set the head upright, enable, calibrate."


class Diagnostics:
    """The newest warnings; written on one thread, read on any."""

    def __init__(self, events: NodeEvents, monotonic_s: Callable[[], float] = time.monotonic) -> None:
        self._events, self._monotonic_s = events, monotonic_s
        self._warnings: deque[tuple[float, str]] = deque(maxlen=LENGTH)
        self._boot = 0
        self._restarted = False

    def warn(self, text: str, reason: Reason = Reason.OK) -> None:
        """Record a sentence as an event and show it for SHOWN_S; a repetition replaces the earlier warning."""
        others = [warning for warning in self._warnings if warning[1] != text]
        self._warnings = deque([*others, (self._monotonic_s(), text)], maxlen=LENGTH)
        self._events.add(new_event(kind=EventKind.WARNING, reason=reason, message=text))

    def follow_boot(self, boot: int, *, calibrated: bool) -> None:
        """Compare the boot number with the last one; after a restart record an event and warn until calibration."""
        restarted = bool(self._boot and boot != self._boot) and not calibrated
        if restarted:
            self._events.add(new_event(kind=EventKind.BOARD, message=RESTARTED))
        self._restarted = not calibrated and (self._restarted or restarted)
        self._boot = boot

    def warnings(self) -> list[str]:
        """Return the warnings to show now."""
        now_s = self._monotonic_s()
        recent = [text for at_s, text in list(self._warnings) if now_s - at_s < SHOWN_S]
        return [RESTARTED, *recent] if self._restarted else recent
