"""Buttons that are held on the control page."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Final

from web_client import WebSocket

SPEED_DEG_S: Final = 20.0


def hold_button(
    page: WebSocket,
    part: str,
    holds: Callable[[dict[str, Any]], bool],
    what: str,
) -> dict[str, Any]:
    """Hold a button until a view fulfils `holds`, with a heartbeat for each message; return the view."""

    def held(view: dict[str, Any]) -> bool:
        if holds(view):
            return True
        if _says_why(view):
            page.send("ReleaseArm")  # the next heartbeat begins a new press
        page.send("HoldArm", arm=part, sign=1)
        return False

    page.send("Choose", name="speed", value=SPEED_DEG_S)
    found = page.state(held, what)
    page.send("ReleaseArm")
    return found


def _says_why(view: dict[str, Any]) -> bool:
    """Return whether the user reads why a press has ended, for example because no heartbeat arrived in time."""
    rows = view["history"][:1]
    stopped = any(
        row["good"] is False and "allowed" not in row["result"] for row in rows
    )  # a limit is beside the button
    return bool(view["you"]["notice"] or view["head"]["refusal"] or stopped)


def jog(page: WebSocket, part: str, moved: float) -> None:
    """Hold the + button of an axis until its absolute angle is above `moved` (deg)."""
    hold_button(page, part, lambda view: abs(view["head"]["hw"][part]) > moved, "moved")
