"""Buttons that are held on the control page."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from typing import Any, Final

from web_client import WebSocket

PRESSES: Final = itertools.count(1)
"""Numbers of presses; a page counts its presses, and a heartbeat names its press."""


def hold_button(
    page: WebSocket,
    part: str,
    holds: Callable[[dict[str, Any]], bool],
    what: str,
    speed: float = 20.0,
) -> dict[str, Any]:
    """Hold a button until a view fulfils `holds`, with a heartbeat for each message; return the view.

    `speed` in deg/s.
    """
    press = next(PRESSES)

    def held(view: dict[str, Any]) -> bool:
        nonlocal press
        if holds(view):
            return True
        if view["you"]["over"] >= press and "No heartbeat" in view["you"]["notice"]:
            press = next(PRESSES)  # as the page asks; a press that ended otherwise must have said why
        page.send("hold", press=press, part=part, sign=1)
        return False

    page.send("SetSpeed", degrees_per_s=speed)
    found = page.state(held, what)
    page.send("release", press=press)
    return found


def jog(page: WebSocket, part: str, moved: float) -> None:
    """Hold the + button of an axis until its absolute angle is above `moved` (deg)."""
    hold_button(page, part, lambda view: abs(view["head"]["hw"][part]) > moved, "moved")
