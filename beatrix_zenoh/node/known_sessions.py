"""The sessions of callers: which are there, and which have ended. No I/O; callers pass the time.

All tokens of sessions disappear when the router is lost, and at a node just before it notices that loss. So a session
whose token has disappeared is missing for SETTLE_S, and if the router was lost, until RETURN_S after its return. It
keeps its lease, and if its token does not appear again, `KnownSessions.given_up` returns it.
"""

from __future__ import annotations

import math

from beatrix_zenoh.node.callers import Caller

ENDED_SESSIONS = 256
"""Number of ended sessions to remember, because their last requests may still arrive; and of those without a token."""
SETTLE_S = 0.1
"""Time in which a node notices a lost router after the tokens have disappeared; 0.1 to 11 ms was measured."""
RETURN_S = 3.0
"""Time in which sessions of clients connect to a router again after the node; they try twice a second."""


class KnownSessions:
    """Sessions, known by their tokens or, because these may arrive later or never, by their requests."""

    def __init__(self) -> None:
        self._began: dict[Caller, float] = {}
        """Times at which sessions with a token were first heard; kept as long as the session or its end."""
        self._heard: dict[Caller, float] = {}
        """Times of the first requests of the newest sessions without a token."""
        self._ended: dict[Caller, None] = {}
        self._missing: dict[Caller, float] = {}
        """Sessions whose tokens have disappeared, and the times at which they are given up (s)."""
        self._router = True

    def heard(self, caller: Caller, now_s: float) -> float | None:
        """Record a request; return the time of the first token or request of its session; None if it names none."""
        if not caller.session:
            return None
        began_s = self._began.get(caller)
        if began_s is None:
            began_s = self._heard.setdefault(caller, now_s)
            if len(self._heard) > ENDED_SESSIONS:
                del self._heard[next(iter(self._heard))]
        return began_s

    def began(self, caller: Caller, now_s: float) -> None:
        """Record that the token of a session has appeared, perhaps again."""
        self._ended.pop(caller, None)
        self._missing.pop(caller, None)
        self._began.setdefault(caller, self._heard.pop(caller, now_s))

    def ended(self, caller: Caller, now_s: float) -> None:
        """Record that the token of a session has disappeared."""
        self._missing[caller] = now_s + SETTLE_S if self._router else math.inf
        self._end(caller)

    def router_changed(self, now_s: float, *, connected: bool) -> None:
        """Record that the router was lost or is connected again.

        Requests that arrive after its return come from sessions that have returned, even before their tokens do.
        """
        self._router = connected
        for caller in self._missing:
            self._missing[caller] = now_s + RETURN_S if connected else math.inf
            if connected:
                self._ended.pop(caller, None)

    def given_up(self, now_s: float) -> list[Caller]:
        """Return the sessions that have been missing for too long; they count as ended."""
        over = [caller for caller, due_s in self._missing.items() if due_s <= now_s]
        for caller in over:
            del self._missing[caller]
            self._end(caller)
        return over

    def _end(self, caller: Caller) -> None:
        self._ended[caller] = None
        if len(self._ended) > ENDED_SESSIONS:
            oldest = next(iter(self._ended))
            del self._ended[oldest]
            self._began.pop(oldest, None)

    def has_ended(self, caller: Caller) -> bool:
        """Return whether the session has ended."""
        return caller in self._ended
