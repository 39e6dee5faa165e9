"""The key of a query and the seat in it. A query with wildcards may match several robots, so it moves none of them."""

from __future__ import annotations

from functools import lru_cache

from beatrix_zenoh.contract import refusals

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
