"""The key of a query and the seat in it. A query with wildcards may match several robots, so it moves none of them."""

from __future__ import annotations

from functools import lru_cache

from beatrix_zenoh import refusals

ANONYMOUS = "anonymous"
"""Seat in the key of a reply if the query had none."""
CACHED_KEYS = 256


@lru_cache(maxsize=CACHED_KEYS)
def seat_of(key: str, served: str) -> str:
    """Return the seat in a query's key: the chunk at the place of `*` in the served key; empty for a wildcard."""
    chunks, pattern = key.split("/"), served.split("/")
    if len(chunks) != len(pattern) or "*" not in pattern:
        return ""
    seat = chunks[pattern.index("*")]
    return "" if "*" in seat else seat


@lru_cache(maxsize=CACHED_KEYS)
def own_key(served: str, seat: str) -> str:
    """Return the served key with the seat in place of `*`; ANONYMOUS for an empty seat."""
    return served.replace("/*/", f"/{seat or ANONYMOUS}/")


def check_own_key(key: str, served: str) -> None:
    """Raise Refused (BAD_VALUE) unless `key` is the served key with a concrete seat."""
    own = own_key(served, seat_of(key, served) or "me")
    if key != own:
        raise refusals.wildcard_key(key, own)
