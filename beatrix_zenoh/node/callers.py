"""The callers of a robot: who sends a request."""

from __future__ import annotations

from typing import NamedTuple


class Caller(NamedTuple):
    """The sender of a request: its seat (empty: none given) and its Zenoh session (empty: unknown)."""

    seat: str
    session: str


NO_CALLER = Caller("", "")


def is_same(presser: Caller, mover: Caller) -> bool:
    """Return whether a STOP came from the caller of a motion.

    A client can forge the session of its STOP, but in a class not the seat. So a STOP that names another seat is never
    that of the mover. A STOP without a seat comes, in a class, from the teacher only.
    """
    return bool(presser.session) and presser.session == mover.session and presser.seat in ("", mover.seat)
