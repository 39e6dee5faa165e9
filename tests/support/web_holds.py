"""Buttons that are held on the control page."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from typing import Any, Final

from web_client import WebSocket

PRESSES: Final = itertools.count(1)
"""Numbers of presses; a page counts its presses, and a heartbeat names its press."""
SPEED_DEG_S: Final = 20.0


def hold_button(
    page: WebSocket,
    part: str,
    holds: Callable[[dict[str, Any]], bool],
    what: str,
) -> dict[str, Any]:
    """Hold a button until a view fulfils `holds`, with a heartbeat for each message; return the view."""
    press = next(PRESSES)

    def held(view: dict[str, Any]) -> bool:
        nonlocal press
        if holds(view):
            return True
        if view["you"]["over"] >= press and _says_why(view):
            press = next(PRESSES)
        page.send("hold", press=press, part=part, sign=1)
        return False

    page.send("Choose", name="speed", value=SPEED_DEG_S)
    found = page.state(held, what)
    page.send("release", press=press)
    return found


def _says_why(view: dict[str, Any]) -> bool:
    """Return whether the user reads why a press has ended, for example because no heartbeat arrived in time."""
    row = view["history"][0]
    stopped = row["good"] is False and "allowed" not in row["result"]  # a limit is shown beside the button
    return bool(view["you"]["notice"] or view["head"]["refusal"] or stopped)


def jog(page: WebSocket, part: str, moved: float) -> None:
    """Hold the + button of an axis until its absolute angle is above `moved` (deg)."""
    hold_button(page, part, lambda view: abs(view["head"]["hw"][part]) > moved, "moved")
