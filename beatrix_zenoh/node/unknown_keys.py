"""The error reply to a query for a key that the robot does not have, so that a mistyped key does not meet silence."""

from __future__ import annotations

import difflib
from functools import lru_cache

from beatrix_zenoh import bus as zbus
from beatrix_zenoh.contract import refusals
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import Detail, ErrorReply
from beatrix_zenoh.contract.errors import quoted

SIMILAR = 3
"""Largest number of similar keys that a sentence names."""
CACHED_KEYS = 256


class UnknownKeys:
    """Decides which keys below `beatrix/<robot>/<twin>/` the robot does not have; any thread may call its methods."""

    def __init__(self, robot: str, twin: str) -> None:
        self.base = f"beatrix/{robot}/{twin}/"
        fields = dict.fromkeys(("who", "arm", "eye", "session"), "*")
        rows = [row for row in keys.KEYS.values() if twin in row.twins]
        found = {row.key.format_map({**fields, "robot": robot, "twin": twin}): row.kind for row in rows}
        self._known = {key: kind for key, kind in found.items() if key.startswith(self.base)}
        self.has = lru_cache(CACHED_KEYS)(self._has)
        """Returns whether a key is one of the robot's, or has a wildcard; only other keys get the error reply."""

    def _has(self, key: str) -> bool:
        return "*" in key or any(zbus.intersects(known, key) for known in self._known)

    def error(self, key: str) -> ErrorReply:
        """Return the error reply to a query for a key that the robot does not have."""
        queries = [known for known, kind in self._known.items() if "query" in kind]
        candidates = [self._filled(known, key) for known in queries]
        similar = difflib.get_close_matches(key.removeprefix(self.base), candidates, SIMILAR)
        names = " or ".join(f"{self.base}{name}" for name in similar)
        refusal = refusals.bad_field(
            key,
            f"This robot has no key {quoted(key)}. {f'Similar: {names}. ' if names else ''}{self.base}info lists all.",
            [known.replace("*", "<who>") for known in queries],
        )
        detail = refusal.detail or Detail()
        return ErrorReply(result=False, reason=refusal.reason, message=refusal.message, detail=detail)

    def _filled(self, known: str, key: str) -> str:
        """Return a known key without its beginning, with the chunks of `key` in place of its wildcards."""
        given = key.split("/")
        chunks = [
            chunk if chunk != "*" else given[place] if place < len(given) else "me"
            for place, chunk in enumerate(known.split("/"))
        ]
        return "/".join(chunks).removeprefix(self.base)
