"""Sessions of clients that a node has heard of: since when, and which have ended. No I/O; callers pass the time."""

from __future__ import annotations

from beatrix_zenoh.node.lease import Caller

ENDED_SESSIONS = 256
"""Number of ended sessions to remember, because their last requests may still arrive; and of those without a token."""


class KnownSessions:
    """Sessions, known by their tokens or, because these may arrive later or never, by their requests."""

    def __init__(self) -> None:
        self._began: dict[Caller, float] = {}
        """Times at which sessions with a token were first heard; kept as long as the session or its end."""
        self._heard: dict[Caller, float] = {}
        """Times of the first requests of the newest sessions without a token."""
        self._ended: dict[Caller, None] = {}

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
        self._began.setdefault(caller, self._heard.pop(caller, now_s))

    def ended(self, caller: Caller) -> None:
        """Record that the token of a session has disappeared."""
        self._ended[caller] = None
        if len(self._ended) > ENDED_SESSIONS:
            oldest = next(iter(self._ended))
            del self._ended[oldest]
            self._began.pop(oldest, None)

    def has_ended(self, caller: Caller) -> bool:
        """Return whether the session has ended."""
        return caller in self._ended
