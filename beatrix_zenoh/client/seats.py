"""The seats that are connected to a router, from their liveliness tokens."""

from __future__ import annotations

from beatrix_zenoh.client.session import Client
from beatrix_zenoh.contract._generated import keys

SESSIONS = 1000
"""Largest number of sessions that are recorded; further ones, for example of a faulty program, are ignored."""


class Seats:
    """The connected seats, live until the client is closed; any thread may read them."""

    def __init__(self, client: Client) -> None:
        self._sessions: dict[str, str] = {}
        client.bus.watch_tokens(keys.seat("*", "*"), self._on_token)

    def _on_token(self, key: str, alive: bool) -> None:  # noqa: FBT001
        """Record on Zenoh's thread that a session of a seat has begun or ended."""
        parts = keys.parse(key)
        if parts is not None and alive:
            if len(self._sessions) < SESSIONS:
                self._sessions[parts.session] = parts.who
        elif parts is not None:
            self._sessions.pop(parts.session, None)

    def names(self) -> list[str]:
        """Return each seat once, sorted."""
        return sorted({*self._sessions.copy().values()})
